// SPDX-License-Identifier: Apache-2.0
// Boxes around the packs of a hierarchy, turned the way the surface runs in them. A patch of a smooth surface fills a
// flat box, where an axis-aligned one around a tilted patch is a cube: from far away, fewer patches seem to be near.
#pragma once

#include <memory>

#include "core/progress.h"
#include "points/cpu/point_group.h"

namespace standoff {

/// Those of the parts of all packs from level 1 on, in their order. `scale` and `center` are those of the index,
/// `extent` bounds its coordinates. Runs on the threads of the calling TBB arena. The progress can end
/// it.
std::unique_ptr<cpu::TurnedPack[]> make_turned_packs(const cpu::PackTree& tree, double scale, Vec3 center, float extent,
                                                     ProgressMeter& progress);

}  // namespace standoff
