// SPDX-License-Identifier: Apache-2.0
// Which sign method fits a mesh.
#pragma once

#include <string>

#include "standoff/mesh_report.h"
#include "standoff/sign.h"

namespace standoff {

/// An open mesh has no inside if its openness (openness.h) is at least this: 0 for cracks and T-junctions, 0.2 for a
/// cube without a lid, 0.29 for a ball cut off at 0.6 of its height, 0.36 for a hemisphere, 0.9 for terrain.
inline constexpr double kSheetOpenness = 1.0 / 3;
/// The same if |volume| with its holes closed is at most this times area^1.5: a crumpled sheet. A ball has 0.094, a
/// plate as thick as a thousandth of its sides 3.5e-4.
inline constexpr double kSheetVolume = 1e-4;

/// Caps of more than kCrackCaps of the area that are more than kCrackRatio times the openness close no holes: they are
/// triangles or faces once more that share no edges with their neighbours, but lie beside them. For holes in a ball the
/// ratio is at most 4.
inline constexpr double kCrackCaps = 0.1, kCrackRatio = 4;
inline bool is_cracked(const MeshReport& report) {
  return report.cap_share > kCrackCaps && report.cap_share > kCrackRatio * report.openness;
}

struct Recommendation {
  SignMethod method = SignMethod::none;
  bool sure = false;
  std::string why;  ///< one sentence without a capital and a full stop
};

/// Looks at the figures of the report that diagnose() finds, whose `method` is not set yet. `area_used` is that of the
/// triangles in use, and `even` says whether each edge has an even number of triangles.
Recommendation recommend(const MeshReport& report, double area_used, bool even);

}  // namespace standoff
