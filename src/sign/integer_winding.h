// SPDX-License-Identifier: Apache-2.0
// The sides of a closed mesh: its winding number is an integer, the sum of the crossings of a row.
#pragma once

#include "sign/row_crossings.h"
#include "sign/sides.h"
#include "standoff/sign.h"

namespace standoff {

class IntegerWinding final : public Sides {
 public:
  /// Requires a mesh that is closed in the orientation given, or, for WindingRule::odd, an even number of triangles at
  /// each edge. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  IntegerWinding(const OrientedMesh& mesh, const Grid& grid, WindingRule rule, ProgressMeter& progress)
      : crossings_(mesh, grid, progress), rule_(rule) {}

  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override;

 private:
  RowCrossings crossings_;
  WindingRule rule_;
};

/// Whether samples with this winding number are inside.
inline bool is_inside(std::int32_t winding, WindingRule rule) {
  switch (rule) {
    case WindingRule::positive:
      return winding > 0;
    case WindingRule::nonzero:
      return winding != 0;
    case WindingRule::odd:
      return (winding & 1) != 0;
  }
  return false;
}

}  // namespace standoff
