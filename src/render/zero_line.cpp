// SPDX-License-Identifier: Apache-2.0
#include "render/zero_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace standoff {
namespace {

// Between which samples the centre of a pixel lies. A sample is in the middle of its square, so half of the outermost
// squares lies beyond all samples: there the outermost sample counts.
struct Between {
  std::int64_t first, second;
  float share;  // of the second
};
Between between(double place, std::int64_t count) {
  const double at = std::clamp(place * static_cast<double>(count) - 0.5, 0.0, static_cast<double>(count - 1));
  const auto first = static_cast<std::int64_t>(at);
  return {first, std::min(first + 1, count - 1), static_cast<float>(at - static_cast<double>(first))};
}

// Exact where both are equal, as clamped values are, and never beyond them.
float mix(float a, float b, float share) { return share == 0 || a == b ? a : a * (1 - share) + b * share; }

std::vector<float> interpolated(const Plane& plane, int width, int height) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const Between up = between((height - y - 0.5) / height, plane.height);
    for (int x = 0; x < width; ++x) {
      const Between right = between((x + 0.5) / width, plane.width);
      const auto row = [&](std::int64_t u) {
        return mix(plane.value(right.first, u), plane.value(right.second, u), right.share);
      };
      values.push_back(mix(row(up.first), row(up.second), up.share));
    }
  }
  return values;
}

// How far from this pixel's centre to a neighbour's the line is, in pixels; 2 if it does not pass between them.
float crossing(float value, float neighbour) {
  if (!std::isfinite(value) || !std::isfinite(neighbour) || (value < 0) == (neighbour < 0)) return 2;
  return std::abs(value) / (std::abs(value) + std::abs(neighbour));
}

}  // namespace

std::vector<float> zero_line(const Plane& plane, int width, int height) {
  const std::vector<float> values = interpolated(plane, width, height);
  std::vector<float> covered(values.size());
  const auto at = [&](int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float value = at(x, y);
      float along_x = 2, along_y = 2;
      if (x > 0) along_x = crossing(value, at(x - 1, y));
      if (x + 1 < width) along_x = std::min(along_x, crossing(value, at(x + 1, y)));
      if (y > 0) along_y = crossing(value, at(x, y - 1));
      if (y + 1 < height) along_y = std::min(along_y, crossing(value, at(x, y + 1)));
      // The line through both crossings has this distance; through one alone it is nearly upright, or nearly level.
      float distance = std::min(along_x, along_y);
      if (along_x <= 1 && along_y <= 1 && distance > 0)
        distance =
            along_x * along_y / static_cast<float>(std::sqrt(double(along_x) * along_x + double(along_y) * along_y));
      // Pixels on both sides share the width of 1: what one lacks, its neighbour across has. Of an oblique line up to
      // 9 % is missing: pixels that it comes near to without passing between their centre and a neighbour's.
      covered[static_cast<std::size_t>(y) * width + x] = std::max(0.0f, 1 - distance);
    }
  return covered;
}

}  // namespace standoff
