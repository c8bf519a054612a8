// SPDX-License-Identifier: Apache-2.0
// The constants that decide what rounding may do to the bounds a body holds: unit, value, and what breaks when they
// change. Those of queries stand in collision/tolerances.h.
#pragma once

#include "geometry/rounding.h"

namespace standoff::collision {

/// A factor that carries the radius of a bounding sphere past its rounding in single precision: differences, squares,
/// sums and a root, 2^-24 (6e-8) each. Smaller: corners stick out of their sphere, and intersecting bodies may count
/// as free. Larger: more spheres are looked up.
inline constexpr float kSphereRoundUp = 1 + 0x1p-21f;
static_assert(kSphereRoundUp - 1 > gamma_float(6));

}  // namespace standoff::collision
