// SPDX-License-Identifier: Apache-2.0
// The tiles that large caps pass through, where the mesh itself is elsewhere.
#pragma once

#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "sign/open_winding/rims.h"
#include "sign/oriented_mesh.h"
#include "standoff/grid.h"

namespace standoff {

/// Tiles that a large cap may touch and no triangle of the mesh does: the winding number of the open mesh is smooth
/// in them. Caps of few samples pass through no such tiles, and are not looked at.
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

}  // namespace standoff
