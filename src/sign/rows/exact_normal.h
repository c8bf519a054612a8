// SPDX-License-Identifier: Apache-2.0
// The normal of a triangle, accurate however thin the triangle is.
#pragma once

#include <array>
#include <cmath>

#include "geometry/predicates.h"
#include "standoff/vec.h"

namespace standoff {

/// The unit normal, within 1e-14; 0 if the triangle has no area, exactly. Requires coordinates that are zero or of
/// magnitude 1e-90 to 1e100.
inline Vec3 exact_unit_normal(const std::array<Vec3, 3>& t) {
  const auto [a, b, c] = t;
  Vec3 n{determinant2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}), determinant2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}),
         determinant2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y})};
  const double most = max_norm(n);
  if (most == 0) return {};
  n = n / Vec3{most, most, most};  // squares neither overflow nor vanish
  return n * (1 / length(n));
}

}  // namespace standoff
