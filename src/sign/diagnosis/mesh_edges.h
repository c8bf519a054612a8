// SPDX-License-Identifier: Apache-2.0
// Which triangles meet at the edges of a mesh. Vertices count by position, so the mesh need not be welded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "standoff/mesh.h"

namespace standoff {

/// One side of a triangle.
struct EdgeUse {
  std::uint32_t low, high;  ///< its ends, numbers of positions, low < high
  std::uint32_t triangle;
  std::uint8_t corner;  ///< the side from this corner of the triangle to the next one
  bool forward;         ///< whether the triangle goes from low to high
};

class MeshEdges {
 public:
  /// Requires a valid mesh. Sides whose ends are one position are no edges. Runs on the threads of the calling TBB
  /// arena.
  explicit MeshEdges(MeshView mesh) {
    ProgressMeter nobody;
    find(mesh, nobody);
  }
  /// The progress can end it.
  MeshEdges(MeshView mesh, ProgressMeter& progress) { find(mesh, progress); }

  /// How many distinct positions there are; their numbers begin with 0.
  std::uint32_t positions() const { return static_cast<std::uint32_t>(first_.size() - 1); }
  /// The number of the position of a triangle's corner.
  std::uint32_t position(std::size_t triangle, int corner) const {
    return corners_[3 * triangle + static_cast<std::size_t>(corner)];
  }
  /// All sides, sorted by low, high, triangle: those of one edge lie together.
  std::span<const EdgeUse> uses() const { return uses_; }

  /// Calls use(span) for each edge, with all sides there.
  template <class Use>
  void for_each(const Use& use) const {
    for (auto next = uses_.begin(); next != uses_.end();) {
      const auto first = next;
      while (next != uses_.end() && next->low == first->low && next->high == first->high) ++next;
      use(std::span<const EdgeUse>(first, next));
    }
  }

 private:
  void find(MeshView mesh, ProgressMeter& progress);

  std::vector<std::uint32_t> corners_;  // numbers of positions, three a triangle
  std::vector<std::size_t> first_;      // of each low end, the first use
  std::vector<EdgeUse> uses_;
};

}  // namespace standoff
