// SPDX-License-Identifier: Apache-2.0
// Which sign method fits a mesh.
#pragma once

#include <string>

#include "standoff/mesh_report.h"
#include "standoff/sign.h"

namespace standoff {

/// An open mesh has no inside if it takes at least this part of its area to close its holes: 0.5 for a hemisphere, 0.2
/// for a cube without a lid, 0.38 for a standing animal cut off at a third of its height, about 1 for terrain.
inline constexpr double kSheetCaps = 0.4;
/// The same if |volume| with its holes closed is at most this times area^1.5: a crumpled sheet. A ball has 0.094, a
/// plate as thick as a thousandth of its sides 3.5e-4.
inline constexpr double kSheetVolume = 1e-4;

struct Recommendation {
  SignMethod method = SignMethod::none;
  bool sure = false;
  std::string why;  ///< one sentence without a capital and a full stop
};

/// Looks at the figures of the report that diagnose() finds, whose `method` is not set yet. `area_used` is that of the
/// triangles in use, and `even` says whether each edge has an even number of triangles.
Recommendation recommend(const MeshReport& report, double area_used, bool even);

}  // namespace standoff
