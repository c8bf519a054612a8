// SPDX-License-Identifier: Apache-2.0
// The triangles of a mesh, prepared for queries at points: a BVH, and a frame of each triangle in its order.
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

/// Lengths are in grid units of a lattice of kSide^3 cells around the mesh. A world unit is a power of two of them, and
/// no coordinate of the mesh relative to its middle exceeds kSide: the bounds of rounding in boxes and culling require
/// this (field/tolerances.h).
class TriangleIndex {
 public:
  static constexpr std::int64_t kSide = 1024;
  /// Points this many extents away are searched for in double throughout: distances from frames in float would leave
  /// too many triangles to be compared in double. The value decides time only; it is measured (docs/points_methods.md).
  static constexpr double kFar = 1024;

  /// Holds the triangles in `among`, which ascend; all triangles if it is empty. Requires a valid mesh whose
  /// coordinates are within kMaxCoordinate; both outlive this. Runs on the threads of the calling TBB arena. Calls
  /// `while_built` many times, which may throw to stop the work.
  TriangleIndex(const Mesh& mesh, std::span<const std::uint32_t> among, int threads, Simd simd,
                ProgressCallback while_built = {});
  TriangleIndex(const TriangleIndex&) = delete;
  TriangleIndex& operator=(const TriangleIndex&) = delete;

  MeshView mesh() const { return job_.mesh; }
  double scale() const { return lattice_.scale; }
  /// A point relative to the middle, grid units.
  Vec3 local(Vec3 p) const { return bvh().frame().local(p); }
  /// A power of two: scale(), or less if the square of a length from a far point would overflow.
  double scale_at(Vec3 point) const { return bvh().frame().scale_at(point); }
  /// Whether a point is near enough to share candidates: boxes are grown by the rounding error of its coordinates.
  bool is_near(Vec3 local) const { return max_norm(local) <= 4 * double{bvh().frame().extent}; }
  /// Whether a point is near enough for distances from frames in float.
  bool is_in_float(Vec3 local) const { return max_norm(local) <= kFar * double{bvh().frame().extent}; }

  const cpu::CandidateCulling& culling() const { return culling_; }
  const Bvh& bvh() const { return culling_.bvh(); }
  /// The BVH as the kernels see it.
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
