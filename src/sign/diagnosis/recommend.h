// SPDX-License-Identifier: Apache-2.0
// Which sign method fits a mesh.
#pragma once

#include <cstdint>
#include <string>

#include "sign/diagnosis/cracks.h"
#include "standoff/mesh_report.h"
#include "standoff/sign.h"

namespace standoff {

/// An open mesh has no inside if it is open in two ways: its openness (openness.h), and the share of its area that it
/// takes to close it, are at least this. Both are 0.2 for a cube without a lid and at least 0.36 for a hemisphere, and
/// about 0.9 for terrain. Cracks and T-junctions have no openness, whatever caps they need; walls within a body need
/// small caps, whatever the winding numbers beside them.
inline constexpr double kSheet = 1.0 / 3;
/// The same if |volume| with its holes closed is at most this times area^1.5: a crumpled sheet. A ball has 0.094, a
/// plate as thick as a thousandth of its sides 3.5e-4.
inline constexpr double kSheetVolume = 1e-4;

/// Caps of more than kCrackCaps of the area that are more than kCrackRatio times the openness close no holes: they are
/// triangles or faces once more that share no edges with their neighbours, but lie beside them. For random
/// holes in up to 40 % of a ball, and for a hemisphere or a flat sheet, the ratio is 1 to 2.
inline constexpr double kCrackCaps = 0.1, kCrackRatio = 4;
inline bool is_cracked(const MeshReport& report) {
  return report.cap_share > kCrackCaps && report.cap_share > kCrackRatio * report.openness;
}

/// An open mesh whose openness is less than that may enclose something: terrain is above it, what is half open below.
/// So may one of more patches than that, whose openness depends on how they are turned.
inline constexpr double kFlat = 0.8;
inline constexpr std::int64_t kFewPatches = 3;

/// Components that are there in both orientations and count for nothing are named if they are so much of the area, and
/// make doubtful what the others are if they are so much of it.
inline constexpr double kNamedShare = 0.01, kDoubtfulShare = 0.1;

struct Recommendation {
  SignMethod method = SignMethod::none;
  bool sure = false;
  std::string why;  ///< one sentence without a capital and a full stop
};

/// What the report does not hold.
struct Findings {
  double area_used;  ///< of the triangles in use
  bool even;         ///< whether each edge has an even number of triangles
  Cracks cracks;
};

/// Looks at the figures of the report that diagnose() finds, whose `method` is not set yet.
Recommendation recommend(const MeshReport& report, const Findings& findings);

}  // namespace standoff
