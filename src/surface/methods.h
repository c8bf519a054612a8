// SPDX-License-Identifier: Apache-2.0
// The two methods that make a surface of blocks (docs/iso.md): marching cubes, the triangles of each cell, with
// vertices on the edges of the grid; and dual contouring, with vertices in the cells and polygons around the crossed
// edges. Dual contouring knows where the surface crosses an edge, and its normal there, from the field or from a mesh.
// Then what of a mesh its surface shows nothing of, because no sample is inside there.
#pragma once

#include <functional>
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

/// Adds to the mesh's vertices and triangles, and to the report's ambiguous faces, clamped and capped edges. Numbers
/// the vertices of the blocks. `memory` is for scratch, its budget for the mesh. Runs on the threads of the calling TBB
/// arena. Throws Error{limit}, Error{interrupted}.
void march_cubes(Blocks& blocks, const EdgePoints& points, MemoryShare& memory, Mesh& mesh, IsoReport& report,
                 ProgressMeter& progress);

/// What dual contouring knows of the surface on a crossed edge of the grid.
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

/// From the field alone: interpolated, with the normal of central differences. `data` has an entry for each crossed
/// edge, by Block::vertex(). Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void hermite_of_field(const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                      ProgressMeter& progress);

/// The closest points of a mesh, without a sign.
using ClosestFunction = std::function<std::vector<ClosestPoint>(std::span<const Vec3>)>;

/// Of the surface of a mesh: the crossing with a triangle, exactly, and its normal. Where none is crossed, as in a hole
/// that the sign closes, the field's data stay.
void hermite_of_mesh(const Blocks& blocks, const EdgePoints& points, MeshView mesh, const ClosestFunction& closest,
                     std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress);

/// A surface at a distance from a mesh.
struct MeshOffset {
  ClosestFunction closest;
  double distance = 0;  ///< positive
  bool inside = false;  ///< on the side where values are negative
};
/// Of that surface: where the exact distance is the offset's, and the direction to or from the closest point. Where no
/// such point is found on the edge the field's data stay.
void hermite_of_offset(const Blocks& blocks, const EdgePoints& points, const MeshOffset& offset,
                       std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress);

/// How positions and normals are found, and how far they are to be trusted.
struct HermiteSource {
  std::function<void(const Blocks&, const EdgePoints&, std::span<HermitePoint>, MemoryBudget&, ProgressMeter&)> fill;
  double tolerance;  ///< PlaneFit::minimum
};

/// Adds to the mesh and to the report, as march_cubes() does.
void contour_dually(Blocks& blocks, const EdgePoints& points, const HermiteSource& source, MemoryShare& memory,
                    Mesh& mesh, IsoReport& report, ProgressMeter& progress);

/// A point of the mesh is lost if none of the samples around it, those of its cell and of the 26 cells around that, is
/// less than the level: then the surface is farther than a spacing away, and the point is outside. (A point with all
/// samples inside, of a part within another one, is not lost.) Points beyond the grid do not count.
///
/// Sets the report's figures of lost parts, and their sentence. The share of the area is that of up to 2^14 points,
/// evenly spread over it; a part, triangles that share positions directly or through others, is lost if all points
/// are that were looked at: those, or a corner, and all corners and centres of up to 2^16 triangles in all. Linear in
/// the mesh; its result does not depend on the number of threads. Runs on the threads of the calling TBB arena.
void find_lost_parts(MeshView mesh, const DistanceField& field, double level, MemoryBudget& budget, IsoReport& report,
                     ProgressMeter& progress);

}  // namespace standoff
