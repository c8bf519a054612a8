// SPDX-License-Identifier: Apache-2.0
// Whether a triangle divides another one. Exact.
#pragma once

#include "geometry/predicates.h"

namespace standoff {

/// For each of two triangles whether the other one, unless it lies in the same plane, has points in its interior.
struct Cuts {
  bool first = false, second = false;
};

/// Requires triangles with an area. May call a triangle cut that the other one touches at a point of the border, where
/// both pass through the other's plane; never the other way round.
Cuts cuts_between(const Corners& first, const Corners& second);

}  // namespace standoff
