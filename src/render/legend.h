// SPDX-License-Identifier: Apache-2.0
// A bar of colors with numbers beside it.
#pragma once

#include <string>
#include <vector>

#include "render/image.h"
#include "standoff/slice.h"

namespace standoff {

class Legend {
 public:
  /// From the least to the greatest value. Those of magnitude `thickness` stand for themselves and all beyond. Colors
  /// of Colormap::diverging have their middle at 0, and reach equally far to both sides.
  Legend(double least, double greatest, double thickness, Colormap map);

  /// A value's color; grey when it is not finite.
  Color color(double value) const;
  /// Pixels from the bar's left edge to the end of the longest number.
  int width() const;
  /// Draws the bar and its numbers, the bar `height` pixels high, its top left corner at (x, y).
  void draw(Image& image, int x, int y, int height) const;

 private:
  struct Tick {
    double share;  // of the way from the least to the greatest value
    std::string label;
  };

  Color color_at(double share) const { return color(least_ + share * (greatest_ - least_)); }

  double least_, greatest_;
  Colormap map_;
  std::vector<Tick> ticks_;  // the greatest first, the least last
};

/// A number with about `digits` digits, "-0" as "0".
std::string short_text(double number, int digits);

}  // namespace standoff
