// SPDX-License-Identifier: Apache-2.0
// Functions of the 2008 master's thesis alone: Fagerjord and Lochehina, "GPGPU: Fast and easy Distance Field
// computation on GPU" (docs/thesis.md). Use them only for comparison: their answers may be wrong.
//
// Algorithm 1 is Method::thesis, and its skip rule is SkipRule::Kind::neighbour, both in standoff/compute.h: they fill
// the same fields by the same call, so functions of their own would only repeat it.
#pragma once

#include <cstdint>

#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/pose.h"

namespace standoff {

/// The thesis's minimum grid: the box grown by the thickness, (max - min) / thickness * e samples per axis, rounded up,
/// at least 2. `e` is 2 to 4 in the thesis. `speed`, the distance that a body moves in one step, makes the grid finer:
/// the factor is then e * (1 + speed / thickness). Errors: usage if the thickness is not positive and finite, e < 1, or
/// speed < 0.
STANDOFF_API Grid minimum_grid(const Box& box, double thickness, double e = 2, double speed = 0);

/// Algorithm 2 of the 2008 thesis, for comparison. Of the field with fewer samples, it visits those samples that lie in
/// the other field's grid. The bodies collide if, for one of these samples, its value and that of the nearest sample of
/// the other field are both below the thickness of their fields, and the sum of the values is below `threshold`. The
/// algorithm misses collisions and raises false alarms; docs/thesis.md says how often.
struct ThesisCollisionResult {
  bool hit = false;
  std::int64_t samples = 0;  ///< number of samples visited
};
STANDOFF_API ThesisCollisionResult collide_thesis(const DistanceField& a, const Pose& pose_a, const DistanceField& b,
                                                  const Pose& pose_b, double threshold);
/// The least such sum, from which a threshold can be chosen; infinite if there is none.
STANDOFF_API double thesis_sum(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b);

}  // namespace standoff
