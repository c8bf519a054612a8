// SPDX-License-Identifier: Apache-2.0
// The colors of a picture besides those of its subject.
#pragma once

#include "render/image.h"
#include "standoff/colormap.h"

namespace standoff {

struct Theme {
  Color paper;    ///< the background
  Color ink;      ///< words and lines
  Color faint;    ///< words and lines of less weight
  Color outside;  ///< samples beyond the band
  Color inside;   ///< samples beyond the band, inside
  Color nothing;  ///< values that are no numbers
};

/// The colors on white or dark.
constexpr Theme theme_of(Background background) {
  if (background == Background::dark)
    return {{17, 19, 24}, {228, 231, 237}, {146, 153, 166}, {52, 56, 64}, {34, 37, 43}, {128, 60, 96}};
  return {{255, 255, 255}, {40, 44, 52}, {110, 116, 126}, {222, 225, 230}, {186, 191, 199}, {214, 160, 186}};
}

}  // namespace standoff
