// SPDX-License-Identifier: Apache-2.0
// Where in a pixel triangles are seen.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "render/camera.h"

namespace standoff {

inline constexpr int kMostSamples = 16;

/// A place in a pixel, subpixels from its top left corner.
struct SamplePlace {
  std::int32_t x, y;
};

/// The places of 1, 2, 4, 8 or 16 samples: no two in a row or column, so that edges of any slope become smooth.
inline std::span<const SamplePlace> sample_places(int samples) {
  // The usual places of graphics cards (the standard patterns of Direct3D 11), which count in 16ths of a pixel.
  constexpr auto at = [](int x, int y) { return SamplePlace{(8 + x) * kSubpixels / 16, (8 + y) * kSubpixels / 16}; };
  static constexpr std::array kOne{at(0, 0)};
  static constexpr std::array kTwo{at(4, 4), at(-4, -4)};
  static constexpr std::array kFour{at(-2, -6), at(6, -2), at(-6, 2), at(2, 6)};
  static constexpr std::array kEight{at(1, -3), at(-1, 3),  at(5, 1), at(-3, -5),
                                     at(-5, 5), at(-7, -1), at(3, 7), at(7, -7)};
  static constexpr std::array kSixteen{at(1, 1),  at(-1, -3), at(-3, 2), at(4, -1), at(-5, -2), at(2, 5),
                                       at(5, 3),  at(3, -5),  at(-2, 6), at(0, -7), at(-4, -6), at(-6, 4),
                                       at(-8, 0), at(7, -4),  at(6, 7),  at(-7, -8)};
  switch (samples) {
    case 1:
      return kOne;
    case 2:
      return kTwo;
    case 8:
      return kEight;
    case 16:
      return kSixteen;
    default:
      return kFour;
  }
}

/// Calls work with the same places as a span whose length the compiler knows, so that it can compute several at once.
template <class Work>
void with_known_count(std::span<const SamplePlace> places, const Work& work) {
  switch (places.size()) {
    case 1:
      return work(places.first<1>());
    case 2:
      return work(places.first<2>());
    case 4:
      return work(places.first<4>());
    case 8:
      return work(places.first<8>());
    case 16:
      return work(places.first<16>());
  }
}

}  // namespace standoff
