// SPDX-License-Identifier: Apache-2.0
// Which samples of which pixels a triangle covers: exact in integers. Of triangles that share an edge, exactly one
// covers a sample on it, so neighbours leave no gap and cover nothing twice.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>

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

/// Pixels from left to right and from top to bottom, both ends included.
struct PixelRange {
  std::int32_t left = 0, top = 0, right = -1, bottom = -1;

  bool empty() const { return left > right || top > bottom; }
  PixelRange within(const PixelRange& other) const {
    return {std::max(left, other.left), std::max(top, other.top), std::min(right, other.right),
            std::min(bottom, other.bottom)};
  }
};

/// The pixels that have a sample in the box of a triangle. `places` surround the pixel's centre.
inline PixelRange pixels_of(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c,
                            const PixelRange& first_and_last_place) {
  constexpr int kShift = std::countr_zero(static_cast<std::uint32_t>(kSubpixels));
  const PixelRange& p = first_and_last_place;
  // Shifts round down, towards the left and the top.
  return {(std::min({a.x, b.x, c.x}) - p.right + kSubpixels - 1) >> kShift,
          (std::min({a.y, b.y, c.y}) - p.bottom + kSubpixels - 1) >> kShift,
          (std::max({a.x, b.x, c.x}) - p.left) >> kShift, (std::max({a.y, b.y, c.y}) - p.top) >> kShift};
}

/// The box of the samples' places in a pixel, for pixels_of().
inline PixelRange box_of(std::span<const SamplePlace> places) {
  PixelRange box{kSubpixels, kSubpixels, 0, 0};
  for (const SamplePlace& p : places)
    box = {std::min(box.left, p.x), std::min(box.top, p.y), std::max(box.right, p.x), std::max(box.bottom, p.y)};
  return box;
}

/// Twice the area, positive if a, b, c turn clockwise on the picture.
inline std::int64_t twice_area(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

/// A triangle's depth over the picture.
class DepthPlane {
 public:
  DepthPlane(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, std::int64_t area)
      : x_(static_cast<float>(a.x)), y_(static_cast<float>(a.y)), depth_(a.depth) {
    const double share = 1 / static_cast<double>(area);
    const double to_b = static_cast<double>(b.depth) - a.depth, to_c = static_cast<double>(c.depth) - a.depth;
    const double bx = double(b.x) - a.x, by = double(b.y) - a.y, cx = double(c.x) - a.x, cy = double(c.y) - a.y;
    per_x_ = static_cast<float>((to_b * cy - to_c * by) * share);
    per_y_ = static_cast<float>((to_c * bx - to_b * cx) * share);
    least_ = std::min({a.depth, b.depth, c.depth});
    most_ = std::max({a.depth, b.depth, c.depth});
  }

  /// At a sample, subpixels. Slivers have steep planes, so rounding must not carry it past the corners'.
  float at(std::int32_t x, std::int32_t y) const {
    const float d = depth_ + per_x_ * (static_cast<float>(x) - x_) + per_y_ * (static_cast<float>(y) - y_);
    return std::clamp(d, least_, most_);
  }
  float most() const { return most_; }

 private:
  float x_, y_, depth_, per_x_, per_y_, least_, most_;
};

/// Calls covered(x, y, mask) for each pixel of a range of which the triangle covers samples; bit s of the mask is
/// sample s. Corners must lie within kMostSubpixels. `Integer` must hold the products of the triangle's sides.
template <class Integer, std::size_t Samples, class Covered>
void for_covered(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, const PixelRange& pixels,
                 std::span<const SamplePlace, Samples> places, const Covered& covered) {
  // An edge's value is twice the signed area of the edge and a point; not negative inside.
  std::array<Integer, 3> row, per_x, per_y, most{};
  std::array<std::array<Integer, Samples>, 3> step;
  const std::array<const ScreenPoint*, 4> corner{&a, &b, &c, &a};
  for (std::size_t e = 0; e < 3; ++e) {
    const ScreenPoint &from = *corner[e], &to = *corner[e + 1];
    const Integer dx = static_cast<Integer>(to.x) - from.x, dy = static_cast<Integer>(to.y) - from.y;
    const bool owns_edge = dy > 0 || (dy == 0 && dx > 0);  // its other triangle has both signs reversed
    row[e] = dx * (static_cast<Integer>(pixels.top) * kSubpixels - from.y) -
             dy * (static_cast<Integer>(pixels.left) * kSubpixels - from.x) - (owns_edge ? 0 : 1);
    per_x[e] = -dy * kSubpixels;
    per_y[e] = dx * kSubpixels;
    for (std::size_t s = 0; s < Samples; ++s) step[e][s] = dx * places[s].y - dy * places[s].x;
    most[e] = std::ranges::max(step[e]);
  }
  for (std::int32_t y = pixels.top; y <= pixels.bottom; ++y) {
    std::array<Integer, 3> at = row;
    for (std::int32_t x = pixels.left; x <= pixels.right; ++x) {
      // One sign bit tells whether any of the three is negative.
      if (((at[0] + most[0]) | (at[1] + most[1]) | (at[2] + most[2])) >= 0) {
        std::array<Integer, Samples> inside;
        for (std::size_t s = 0; s < Samples; ++s)
          inside[s] = (at[0] + step[0][s]) | (at[1] + step[1][s]) | (at[2] + step[2][s]);
        std::uint32_t mask = 0;
        for (std::size_t s = 0; s < Samples; ++s) mask |= static_cast<std::uint32_t>(inside[s] >= 0) << s;
        if (mask != 0) covered(x, y, mask);
      }
      for (std::size_t e = 0; e < 3; ++e) at[e] += per_x[e];
    }
    for (std::size_t e = 0; e < 3; ++e) row[e] += per_y[e];
  }
}

/// The same with the narrowest integers that suffice; a, b, c in any order. `area` is twice_area(), not 0.
template <class Covered>
void for_covered_pixels(const ScreenPoint& a, ScreenPoint b, ScreenPoint c, std::int64_t area, const PixelRange& pixels,
                        std::span<const SamplePlace> places, const Covered& covered) {
  if (area < 0) std::swap(b, c);
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
  // Products of sides up to 2^13 and of distances to pixels, up to 2^13 + 2 * 2^8, stay below 2^31, also their
  // differences.
  constexpr std::int64_t kNarrow = 1 << 13;
  const bool narrow = std::int64_t{right} - left <= kNarrow && std::int64_t{bottom} - top <= kNarrow;
  with_known_count(places, [&](auto known) {
    if (narrow)
      for_covered<std::int32_t>(a, b, c, pixels, known, covered);
    else
      for_covered<std::int64_t>(a, b, c, pixels, known, covered);
  });
}

}  // namespace standoff
