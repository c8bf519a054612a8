// SPDX-License-Identifier: Apache-2.0
// Which samples of a grid lie in a box.
#pragma once

#include <algorithm>
#include <cstdint>

#include "geometry/host_device.h"
#include "standoff/grid.h"

namespace standoff {

/// Samples begin <= i < end on each axis.
struct SampleRange {
  Size3 begin, end;

  STANDOFF_HD bool empty() const { return begin.x >= end.x || begin.y >= end.y || begin.z >= end.z; }
  STANDOFF_HD std::int64_t count() const {
    return empty() ? 0 : (end.x - begin.x) * (end.y - begin.y) * (end.z - begin.z);
  }
};

STANDOFF_HD inline SampleRange intersection(const SampleRange& a, const SampleRange& b) {
  return {{std::max(a.begin.x, b.begin.x), std::max(a.begin.y, b.begin.y), std::max(a.begin.z, b.begin.z)},
          {std::min(a.end.x, b.end.x), std::min(a.end.y, b.end.y), std::min(a.end.z, b.end.z)}};
}

/// The samples of the grid in the box, its faces included. The box may be infinite, and empty on some axis.
STANDOFF_HD inline SampleRange samples_in(const Box& box, const Grid& grid) {
  // Not ceil and floor: without SSE4.1 they are calls of the C library, and every triangle of every brick comes here.
  const auto first = [](double low, double origin, double spacing, std::int64_t size) {
    const double sample = std::clamp((low - origin) / spacing, 0.0, static_cast<double>(size));
    const auto below = static_cast<std::int64_t>(sample);
    return below + (static_cast<double>(below) < sample);
  };
  const auto past = [](double high, double origin, double spacing, std::int64_t size) {
    const double sample = (high - origin) / spacing;
    if (!(sample >= 0)) return std::int64_t{0};
    return static_cast<std::int64_t>(std::min(sample, static_cast<double>(size - 1))) + 1;
  };
  const auto& [size, origin, spacing] = grid;
  return {{first(box.min.x, origin.x, spacing.x, size.x), first(box.min.y, origin.y, spacing.y, size.y),
           first(box.min.z, origin.z, spacing.z, size.z)},
          {past(box.max.x, origin.x, spacing.x, size.x), past(box.max.y, origin.y, spacing.y, size.y),
           past(box.max.z, origin.z, spacing.z, size.z)}};
}

}  // namespace standoff
