// SPDX-License-Identifier: Apache-2.0
// The thesis's smallest grid for collision (docs/thesis.md).
#include <algorithm>
#include <cmath>
#include <string>

#include "core/guarded.h"
#include "standoff/error.h"
#include "standoff/thesis.h"

namespace standoff {

Grid minimum_grid(const Box& box, double thickness, double e, double speed) try {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "grid: " + what); };
  if (!(thickness > 0) || !std::isfinite(thickness))
    fail("the minimum grid needs a positive, finite thickness; give the half-width of the band");
  if (!(e >= 1) || !std::isfinite(e))
    fail("the minimum grid's factor e must be at least 1, and finite; the thesis uses 2 to 4");
  if (!(speed >= 0) || !std::isfinite(speed))
    fail("the speed must be zero or more, and finite; give world units a step");
  constexpr Padding kNoPadding{.least_samples = 0};
  fit_size(box, {2, 2, 2}, kNoPadding);  // throws if the box is not valid
  const Box grown = box.grown(thickness);
  const Vec3 extent = grown.extent();
  const double per_unit = e * (1 + speed / thickness) / thickness;
  const auto samples = [&](double side) {
    const double n = std::ceil(side * per_unit * (1 - 1e-12));
    if (!(n < 0x1p40)) throw Error(ErrorCode::limit, "grid: more than 2^40 samples on a side; take a larger thickness");
    return std::max<std::int64_t>(2, static_cast<std::int64_t>(n));
  };
  return fit_size(grown, {samples(extent.x), samples(extent.y), samples(extent.z)}, kNoPadding);
} catch (...) {
  throw_as_error("grid");
}

}  // namespace standoff
