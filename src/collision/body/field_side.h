// SPDX-License-Identifier: Apache-2.0
// The side of a surface on which a point is, from its fields alone.
#pragma once

#include "collision/body/model.h"

namespace standoff::collision {

enum class Side { unknown, outside, inside };

/// A known side is certain: a sample that is nearer to x than to the surface is on the same side, because the segment
/// between the two does not cross the surface. Near the surface the side is unknown. `x` is relative to the body's
/// middle; `slack` bounds what x, the surface and the samples' values are off by, together. Requires a closed body.
Side side_of(const ModelData& body, Vec3 x, double slack);

}  // namespace standoff::collision
