// SPDX-License-Identifier: Apache-2.0
#include "render/level_line.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace standoff {
namespace {

// Between which samples the centre of a pixel lies.
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

// The slope through a pixel from its neighbours along one axis, as far as these are finite.
double slope(float before, float value, float after) {
  const double first = std::isfinite(before) ? static_cast<double>(value) - before : 0;
  const double second = std::isfinite(after) ? static_cast<double>(after) - value : 0;
  return std::isfinite(before) && std::isfinite(after) ? (first + second) / 2 : first + second;
}

}  // namespace

std::vector<float> interpolated(const Plane& plane, int width, int height) {
  std::vector<Between> columns;
  for (int x = 0; x < width; ++x) columns.push_back(between((x + 0.5) / width, plane.width));
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const Between up = between((height - y - 0.5) / height, plane.height);
    for (const Between& right : columns) {
      const auto row = [&](std::int64_t u) {
        return mix(plane.value(right.first, u), plane.value(right.second, u), right.share);
      };
      values.push_back(mix(row(up.first), row(up.second), up.share));
    }
  }
  return values;
}

namespace {

// A grid of values with its neighbours.
struct Values {
  const std::vector<float>& all;
  int width, height;

  float at(int x, int y) const {
    const bool outside = x < 0 || y < 0 || x >= width || y >= height;
    return outside ? std::numeric_limits<float>::quiet_NaN() : all[static_cast<std::size_t>(y) * width + x];
  }
  // Pixels from a pixel's centre to the level, above it positive; the slope there is taken for that of the way.
  double distance(int x, int y, double level) const {
    const float value = at(x, y);
    const double slope_x = slope(at(x - 1, y), value, at(x + 1, y)), slope_y = slope(at(x, y - 1), value, at(x, y + 1));
    const double steepness = std::sqrt(slope_x * slope_x + slope_y * slope_y);
    const double above = value - level;
    return steepness > 0 ? above / steepness : above < 0 ? -kFar : kFar;
  }
  // Whether one of the eight pixels around this one is on the other side.
  bool passes(int x, int y, double level) const {
    const bool below = at(x, y) < level;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const float near = at(x + dx, y + dy);
        if (std::isfinite(near) && (near < level) != below) return true;
      }
    return false;
  }
  static constexpr double kFar = 1e9;
};

}  // namespace

std::vector<float> level_line(const std::vector<float>& values, int width, int height, double level,
                              double line_width) {
  const Values grid{values, width, height};
  std::vector<float> covered(values.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // A line at most 2 pixels wide reaches no farther than the neighbours of the pixels that it passes between.
      if (!std::isfinite(grid.at(x, y)) || !grid.passes(x, y, level)) continue;
      const double distance = std::abs(grid.distance(x, y, level));
      covered[static_cast<std::size_t>(y) * width + x] =
          static_cast<float>(std::clamp(line_width / 2 + 0.5 - distance, 0.0, 1.0));
    }
  return covered;
}

std::vector<float> share_above(const std::vector<float>& values, int width, int height, double level) {
  const Values grid{values, width, height};
  std::vector<float> shares(values.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float value = grid.at(x, y);
      const bool edge = std::isfinite(value) && grid.passes(x, y, level);
      const double share = edge ? std::clamp(0.5 + grid.distance(x, y, level), 0.0, 1.0) : value >= level ? 1.0 : 0.0;
      shares[static_cast<std::size_t>(y) * width + x] = static_cast<float>(share);
    }
  return shares;
}

}  // namespace standoff
