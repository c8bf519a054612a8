// SPDX-License-Identifier: Apache-2.0
#include "standoff/inspect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/guarded.h"

namespace standoff {

FieldSummary inspect(const DistanceField& field) try {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto far = static_cast<float>(field.thickness());
  const Size3 size = field.grid().size;
  FieldSummary found{infinity, -infinity};
  std::vector<float> slice(static_cast<std::size_t>(size.x * size.y));
  std::vector<std::uint32_t> nearest(field.has_nearest() ? slice.size() : 0);
  for (std::int64_t k = 0; k < size.z; ++k) {
    field.copy_slices(k, 1, slice);
    for (const float value : slice) {
      if (std::isnan(value)) {
        ++found.nan;
        continue;
      }
      found.min = std::min(found.min, double{value});
      found.max = std::max(found.max, double{value});
      if (!field.has_nearest()) found.band += std::abs(value) < far;
    }
    if (!field.has_nearest()) continue;
    field.copy_nearest_slices(k, 1, nearest);
    found.band += std::ranges::count_if(nearest, [](std::uint32_t triangle) { return triangle != kNoTriangle; });
  }
  return found;
} catch (...) {
  throw_as_error("field");
}

}  // namespace standoff
