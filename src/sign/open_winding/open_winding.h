// SPDX-License-Identifier: Apache-2.0
// The signs in an open mesh: its generalised winding number decides (docs/open_winding.md).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "sign/diagnosis/boundary.h"
#include "sign/open_winding/cap_tree.h"
#include "sign/open_winding/quick_angles.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/row_crossings.h"
#include "sign/signs.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff {

/// Tiles that a large cap may touch and no triangle of the mesh does: the winding number of the open mesh is smooth in
/// them. Small caps pass through no such tiles, and are left out.
class OpenTiles {
 public:
  /// Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  OpenTiles(const OrientedMesh& mesh, const Rims& rims, const Grid& grid, ProgressMeter& progress);

  bool contains(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return !marks_.empty() && marks_[static_cast<std::size_t>(tx + tiles_x_ * (ty + tiles_y_ * tz))] == kCap;
  }

 private:
  static constexpr std::uint8_t kCap = 1, kMesh = 2;

  std::int64_t tiles_x_, tiles_y_;
  std::vector<std::uint8_t> marks_;  // by tile; empty if no cap is large
};

/// The caps of a boundary, prepared once for all grids.
struct Caps {
  /// Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  Caps(const Boundary& boundary, ProgressMeter& progress)
      : rims(boundary, progress), tree(rims, progress), quick(rims, tree, progress), mesh(caps_of(rims)) {}
  Caps(const Caps&) = delete;
  Caps& operator=(const Caps&) = delete;

  Rims rims;
  RimTree tree;
  QuickAngles quick;
  Mesh mesh;
};

/// Inside is where the generalised winding number w is above 1/2 (WindingRule::positive), above 1/2 in magnitude
/// (nonzero), or nearest to an odd number (odd). An interval that certainly contains w decides each sample, or w
/// itself: within 1e-9 of a threshold, or on the boundary, a rounded w decides.
class OpenWinding final : public SampleSigns {
 public:
  static constexpr std::int64_t kAllCrossings = std::numeric_limits<std::int64_t>::max();

  /// Requires the caps of the mesh's boundary, and at least those triangles that rows of the grid may cross. Mesh and
  /// progress must stay where they are. Runs on the threads of the calling TBB arena. Throws Error{interrupted}, and so
  /// does fill().
  /// `bytes` limits the mesh's crossings held at a time (RowCrossings); those of the caps have a limit of their own.
  OpenWinding(const OrientedMesh& mesh, std::shared_ptr<const Caps> caps, const Grid& grid, WindingRule rule,
              ProgressMeter& progress, std::int64_t bytes = kAllCrossings);

  std::int64_t load(std::int64_t first) override {
    return std::min(mesh_crossings_.load(first), cap_crossings_.load(first));
  }
  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override;

  /// w at a sample, within 1e-9 unless the sample is on the boundary within rounding. Takes time linear in the size of
  /// the boundary.
  /// Requires that all crossings are held.
  double winding_number(std::int64_t i, std::int64_t j, std::int64_t k) const;
  /// w at a sample within `error`, which is faster. Counts visits of rims (kLooks). Throws Error{interrupted}.
  double winding_number(std::int64_t i, std::int64_t j, std::int64_t k, double error, WorkCheck& check) const;

  /// The number of samples in all tiles filled so far with w within 0.05 (kDoubt) of a threshold, by values of w that
  /// are off by at most 0.025 (kDoubtError). The same for any number of threads.
  std::int64_t doubtful() const { return doubtful_.load(std::memory_order_relaxed); }

  /// The most memory that is held beside the mesh's crossings, with the caps of so many half-edges of a boundary, in a
  /// grid of that size.
  static std::int64_t bytes(std::int64_t boundary, const Size3& size, int threads);

 private:
  Grid grid_;
  WindingRule rule_;
  ProgressMeter& progress_;
  std::shared_ptr<const Caps> caps_;
  OpenTiles open_tiles_;
  RowCrossings mesh_crossings_, cap_crossings_;
  mutable std::atomic<std::int64_t> doubtful_{0};
};

}  // namespace standoff
