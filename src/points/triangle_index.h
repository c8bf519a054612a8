// SPDX-License-Identifier: Apache-2.0
// The triangles of a mesh, prepared for questions at points: a hierarchy of boxes, and their corners in its order.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/progress.h"
#include "field/backend.h"
#include "field/cpu/candidate_culling.h"
#include "field/cpu/kernels.h"
#include "points/cpu/point_group.h"
#include "standoff/mesh.h"

namespace standoff {

/// Lengths are in grid units of a lattice of kSide^3 cells around the mesh: a power of two of them make a world unit,
/// and no coordinate of the mesh relative to its middle is beyond kSide of them. That is what the rounding of boxes and
/// culling is made for (field/tolerances.h).
class TriangleIndex {
 public:
  static constexpr std::int64_t kSide = 1024;

  /// Of the triangles in `among`, ascending; of all if that is empty. Requires a valid mesh, whose coordinates are
  /// within kMaxCoordinate; both outlive this. Runs on the threads of the calling TBB arena. `while_built` is called
  /// many times before it is done, and may throw to end that.
  TriangleIndex(const Mesh& mesh, std::span<const std::uint32_t> among, int threads, Simd simd,
                ProgressCallback while_built = {});
  TriangleIndex(const TriangleIndex&) = delete;
  TriangleIndex& operator=(const TriangleIndex&) = delete;

  MeshView mesh() const { return job_.mesh; }
  double scale() const { return lattice_.scale; }
  /// A point relative to the middle, grid units.
  Vec3 local(Vec3 p) const { return bvh().frame().local(p); }
  /// A power of two: scale(), or less where the square of a length from a far point would overflow.
  double scale_at(Vec3 point) const { return bvh().frame().scale_at(point); }
  /// Whether boxes in float may be asked about a point: they are grown by what it may be off by there.
  bool is_near(Vec3 local) const { return max_norm(local) <= 4 * double{bvh().frame().extent}; }

  const cpu::CandidateCulling& culling() const { return culling_; }
  const Bvh& bvh() const { return culling_.bvh(); }
  /// The hierarchy as the kernels see it. Places in its order are entries of the BVH.
  const cpu::BvhView& tree() const { return tree_; }
  std::int64_t triangle_count() const { return job_.triangle_count(); }
  std::int64_t memory_bytes() const;

 private:
  ProgressCallback while_built_;  // empty afterwards
  ProgressMeter progress_{while_built_};
  Job job_;
  cpu::BlockLattice lattice_;
  cpu::CandidateCulling culling_;
  std::unique_ptr<cpu::NodeFrames[]> frames_;
  cpu::BvhView tree_{};
};

}  // namespace standoff
