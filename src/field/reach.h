// SPDX-License-Identifier: Apache-2.0
// How far a triangle reaches, rounding included.
#pragma once

#include "standoff/verify.h"

namespace standoff {

/// No method finds a triangle within the thickness of a sample that is farther from it than this, world units: ten
/// times the error that a distance of the thickness may have. Infinite with the thickness.
inline double reach_beyond_rounding(const Grid& grid, double thickness) {
  return thickness + 10 * allowed_error(grid, thickness);
}

}  // namespace standoff
