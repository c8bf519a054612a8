// SPDX-License-Identifier: Apache-2.0
// The sides of an open mesh: its generalised winding number decides (docs/open_winding.md).
#pragma once

#include <atomic>
#include <cstdint>

#include "core/progress.h"
#include "sign/diagnosis/boundary.h"
#include "sign/open_winding/open_tiles.h"
#include "sign/open_winding/quick_angles.h"
#include "sign/open_winding/rim_tree.h"
#include "sign/open_winding/rims.h"
#include "sign/rows/row_crossings.h"
#include "sign/sides.h"
#include "standoff/sign.h"

namespace standoff {

/// Inside is where the generalised winding number w is above 1/2 (WindingRule::positive), above 1/2 in magnitude
/// (nonzero), or nearest to an odd number (odd). Each sample is decided by an interval that w is certain to be in, or
/// by w itself: within 1e-9 of a threshold, or on the boundary, the side is that of a rounded w.
class OpenWinding final : public Sides {
 public:
  /// `boundary` is that of the mesh; if it is empty, the mesh is closed. The mesh must stay where it is. Runs on the
  /// threads of the calling TBB arena. Throws Error{interrupted}, which fill() does too: the progress must stay.
  OpenWinding(const OrientedMesh& mesh, const Boundary& boundary, const Grid& grid, WindingRule rule,
              ProgressMeter& progress);

  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override;

  /// w at a sample, within 1e-9 unless the sample is on the boundary within rounding. Linear in the size of the
  /// boundary.
  double winding_number(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// The same within `error`; faster. Counts looks at rims: kLooks. Throws Error{interrupted}.
  double winding_number(std::int64_t i, std::int64_t j, std::int64_t k, double error, WorkCheck& check) const;

  /// How many samples of all tiles filled so far have w within 0.05 (kDoubt) of a threshold, by values of w that
  /// are off by at most 0.025 (kDoubtError). The same for any number of threads.
  std::int64_t doubtful() const { return doubtful_.load(std::memory_order_relaxed); }

 private:
  Grid grid_;
  WindingRule rule_;
  ProgressMeter& progress_;
  Rims rims_;
  RimTree tree_;
  QuickAngles quick_;
  OpenTiles open_tiles_;
  RowCrossings mesh_crossings_, cap_crossings_;
  mutable std::atomic<std::int64_t> doubtful_{0};
};

}  // namespace standoff
