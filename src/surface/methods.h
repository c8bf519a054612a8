// SPDX-License-Identifier: Apache-2.0
// The two methods that make surfaces from blocks (docs/surface_methods.md): marching cubes makes the triangles of each
// cell, with vertices on the edges of the grid; dual contouring makes vertices in the cells and polygons around the
// crossed edges. Dual contouring takes the crossing of an edge, and the normal there, from the field or from a mesh.
// And a search for the parts of a mesh that its surface does not show, because no sample is inside them.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "core/memory.h"
#include "core/progress.h"
#include "standoff/mesh.h"
#include "standoff/points.h"
#include "standoff/surface.h"
#include "surface/blocks.h"
#include "surface/vertices.h"

namespace standoff {

/// Layers of blocks along z, from `begin` to before `end`. Those below the grid's first sample are layer -1.
struct BlockLayers {
  std::int64_t begin, end;
};
inline constexpr BlockLayers kAllLayers{-1, std::numeric_limits<std::int64_t>::max()};

/// Marching cubes: the cells of some layers of blocks. Adds to the mesh's vertices and triangles, and to the report's
/// clamped and capped edges; triangles of the last layer's cells also have vertices of the next layer, which are those
/// that a call for that layer will add. It must know the samples of the next layer and the first ones behind it.
/// Returns the number of ambiguous faces, each of which both of its cells count. Numbers the vertices of the blocks.
/// Counts scratch memory in `memory`, and the mesh in its budget. Runs on the threads of the calling TBB arena. Throws
/// Error{limit}, Error{interrupted}.
std::int64_t march_cubes(Blocks& blocks, const BlockLayers& layers, const EdgePoints& points, MemoryShare& memory,
                         Mesh& mesh, SurfaceReport& report, ProgressMeter& progress);

/// The point and the normal of the surface on a crossed edge of the grid.
struct HermitePoint {
  float t = 0.5f;             ///< from the lower end, in spacings of the edge's axis
  float x = 0, y = 0, z = 0;  ///< the unit normal, outwards

  Vec3 normal() const { return {x, y, z}; }
  void set_normal(Vec3 n) {
    x = static_cast<float>(n.x);
    y = static_cast<float>(n.y);
    z = static_cast<float>(n.z);
  }
};

/// Makes points from the field alone: by interpolation, with normals by central differences. `data` has an entry for
/// each crossed edge, by Block::vertex(). Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void hermite_of_field(const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                      ProgressMeter& progress);

/// The closest points of a mesh, without a sign.
using ClosestFunction = std::function<std::vector<ClosestPoint>(std::span<const Vec3>)>;

/// Makes points from a mesh: the exact crossing with a triangle, and its normal. If an edge crosses no triangle, as in
/// a hole that the sign closes, the point of the field stays.
void hermite_of_mesh(const Blocks& blocks, const EdgePoints& points, MeshView mesh, const ClosestFunction& closest,
                     std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress);

/// A surface at a distance from a mesh.
struct MeshOffset {
  ClosestFunction closest;
  double distance = 0;  ///< positive
  bool inside = false;  ///< the surface is on the side of negative values
};
/// Makes points from an offset: at the exact distance, with the direction to or from the closest point as normal. If no
/// such point is found on an edge, the point of the field stays.
void hermite_of_offset(const Blocks& blocks, const EdgePoints& points, const MeshOffset& offset,
                       std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress);

/// The source of positions and normals, and their accuracy.
struct HermiteSource {
  std::function<void(const Blocks&, const EdgePoints&, std::span<HermitePoint>, MemoryBudget&, ProgressMeter&)> fill;
  double tolerance;  ///< PlaneFit::minimum
};

/// Dual contouring. Adds to the mesh and to the report, as march_cubes() does.
void contour_dually(Blocks& blocks, const EdgePoints& points, const HermiteSource& source, MemoryShare& memory,
                    Mesh& mesh, SurfaceReport& report, ProgressMeter& progress);

/// Finds the parts of a mesh that its surface does not show, and sets the report's figures and its sentence about them.
///
/// A point of the mesh is lost if no sample of its cell and of the 26 cells around is less than the level: then the
/// surface is farther than a spacing away, and the point is outside. (A point with all samples inside, of a part within
/// another one, is not lost.) Points beyond the grid do not count.
///
/// The share of the area is estimated by up to 2^14 points, evenly spread over it. A part consists of triangles that
/// share positions directly or through others. It is lost if all its tested points are lost: the points above, or a
/// corner, and all corners and centres of up to 2^16 triangles in all. Takes time linear in the mesh; the result does
/// not depend on the number of threads. Runs on the threads of the calling TBB arena.
void find_lost_parts(MeshView mesh, const DistanceField& field, double level, MemoryBudget& budget,
                     SurfaceReport& report, ProgressMeter& progress);

}  // namespace standoff
