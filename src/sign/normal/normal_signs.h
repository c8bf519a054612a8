// SPDX-License-Identifier: Apache-2.0
// The signs in an oriented mesh, open or closed: in front of its nearest part is outside, behind it is inside.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "bvh/bvh.h"
#include "sign/flood/grid_edges.h"
#include "sign/normal/nearest_triangles.h"
#include "sign/normal/pseudonormals.h"
#include "sign/oriented_mesh.h"
#include "sign/signs.h"
#include "standoff/mesh.h"

namespace standoff {

/// The triangle closest to a point, for the few points that no field has an answer for.
class ClosestTriangle {
 public:
  /// Requires a valid mesh that outlives this. Takes some 50 bytes for each triangle while it is made, 30 afterwards.
  /// Runs on the threads of the calling TBB arena.
  explicit ClosestTriangle(MeshView mesh);

  /// kNoTriangle if there is none. In double: one that is farther by some roundings of its distance may be taken for
  /// the closest. Takes logarithmic time where few triangles are about as close; at the worst it looks at all.
  std::uint32_t to(const Vec3& p) const { return nearest_triangle(bvh_, mesh_, p).triangle; }

 private:
  MeshView mesh_;
  Bvh bvh_;
};

/// The side of its nearest triangle that a point is on.
using SideOfNearest = std::function<Pseudonormals::Place(const Vec3& p, std::uint32_t triangle)>;
/// Exact: by the normal of the nearest face, edge or vertex.
SideOfNearest by_pseudonormals(const OrientedMesh& mesh);
/// By the triangle's plane alone, as Fuhrmann 2003: wrong where the nearest point is on an edge or a vertex, and the
/// planes that meet there disagree. A point in the plane is on the surface, and so is any point of a triangle without
/// area.
SideOfNearest by_planes(const OrientedMesh& mesh);

/// Samples with a nearest triangle have the side that SideOfNearest finds. Other samples take the side of those that
/// they are connected with by grid edges that no triangle crosses, in three steps:
/// 1. Within each tile that has nearest triangles or crossed edges. Where no side comes, one of the connected samples
///    looks for its closest triangle among all. This happens only in bands thinner than a spacing.
/// 2. From tile to tile, by a breadth-first search from all these tiles at once. A tile that has neither nearest
///    triangles nor crossed edges has one side: the side of most samples next to its faces that had a side before the
///    step; outside if inside has no majority.
/// 3. In regions of tiles that no side came to, one tile looks for the closest triangle of its first sample.
/// In a closed mesh that does not intersect itself all samples of a region are on one side, so there all sides are
/// exact. Samples on the surface that no side comes to are outside.
class NormalSigns final : public SampleSigns {
 public:
  /// Requires a valid mesh and grid, and the nearest triangles of a field of this thickness. Runs on the threads of the
  /// calling TBB arena. Throws Error{interrupted}.
  NormalSigns(MeshView mesh, const SideOfNearest& side_of, const Grid& grid, double thickness,
              const NearestTriangles& nearest, ProgressMeter& progress);

  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override;

 private:
  // The samples of a tile that have a side.
  struct Decided {
    TileBits outside{}, inside{};
    void add(Pseudonormals::Place place, std::size_t n);  // gives sample n its side, unless it is on the surface
    friend bool operator==(const Decided&, const Decided&) = default;
  };

  void find_tiles(const NearestTriangles& nearest);
  void decide_band(const SideOfNearest& side_of, const Grid& grid, const NearestTriangles& nearest,
                   ProgressMeter& progress);
  void spread(const Grid& grid, std::vector<std::size_t> changed, ProgressMeter& progress);
  void decide_rest_of_mixed(MeshView mesh, const SideOfNearest& side_of, std::optional<ClosestTriangle>& closest,
                            const Grid& grid, const NearestTriangles& nearest, ProgressMeter& progress);
  void decide_rest(MeshView mesh, const SideOfNearest& side_of, std::optional<ClosestTriangle>& closest,
                   const Grid& grid, ProgressMeter& progress);

  TileBits without_side(const Grid& grid, std::size_t tile) const;
  Decided decided(std::size_t tile) const;
  void set(std::size_t tile, const Decided& decided);
  Decided after_step(std::size_t tile, const TileBits& in_grid) const;
  Decided spread_within(Decided decided, const TileEdges& edges, const TileBits& in_grid) const;

  TileLattice lattice_;
  GridEdges edges_;
  TileSet mixed_;                             // tiles with nearest triangles or crossed edges
  std::vector<Decided> parts_;                // one for each of these
  std::vector<bool> is_decided_, is_inside_;  // for all other tiles
  std::vector<bool> is_next_;                 // for each tile, within a step of spread()
};

}  // namespace standoff
