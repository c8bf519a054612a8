// SPDX-License-Identifier: Apache-2.0
// The sides of a closed mesh: its winding number is an integer, the sum of the crossings of a row.
#pragma once

#include <cstdint>
#include <limits>

#include "sign/open_winding/winding_rule.h"
#include "sign/rows/row_crossings.h"
#include "sign/sides.h"
#include "standoff/sign.h"

namespace standoff {

class IntegerWinding final : public Sides {
 public:
  /// Requires a mesh that is closed in the orientation given, or, for WindingRule::odd, an even number of triangles at
  /// each edge. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  /// `bytes`: what crossings may take at a time (row_crossings.h).
  IntegerWinding(const OrientedMesh& mesh, const Grid& grid, WindingRule rule, ProgressMeter& progress,
                 std::int64_t bytes = std::numeric_limits<std::int64_t>::max())
      : crossings_(mesh, grid, progress, bytes), rule_(rule) {}

  std::int64_t load(std::int64_t first) override { return crossings_.load(first); }
  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override;

 private:
  RowCrossings crossings_;
  WindingRule rule_;
};

}  // namespace standoff
