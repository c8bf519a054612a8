// SPDX-License-Identifier: Apache-2.0
// How open a mesh is: how far winding numbers beside its surface are from integers, and whether its gaps are cracks
// alone.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sign/diagnosis/boundary.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"
#include "standoff/mesh.h"

namespace standoff {

/// 0 beside a body, 1 beside a sheet. Behind a triangle the winding number is 1 higher than in front of it: W + 1/2 and
/// W - 1/2, where W is the winding number of all other triangles there. Beside a body both are integers, whatever it
/// contains and however often it winds. Beside a sheet that nothing else is near, W is 0, and which side is inside
/// cannot be told. The openness of a point on the mesh is the distance of W + 1/2 from the nearest integer, times 2.
/// The openness of a mesh is the mean over its area.
///
/// It needs no ray and no triangle. Triangles that close the boundary make W + 1/2 an integer, so their winding number
/// is as far from an integer. It does not matter which triangles close the boundary, because two ways differ by a
/// closed mesh: here a cone with one apex does. It does not matter either whether cracks have a width: few points see
/// what closes them.
///
/// The points are centroids of triangles, weighted by their areas. Up to kMostPoints triangles all count, else some,
/// evenly spread over the area in the order of the triangles: at least kLeastPoints, and for long boundaries no more
/// than kMostAngles allow. Returns a number in [0, 1], and 0 without a boundary. Requires the boundary of the mesh.
/// Does not depend on the number of threads. Runs on the threads of the calling TBB arena.
double openness_of(const OrientedMesh& mesh, const Boundary& boundary);

inline constexpr std::size_t kMostPoints = 512, kLeastPoints = 32;
/// Solid angles of boundary edges in all: they take about a tenth of a second. With more than 625,000 edges,
/// kLeastPoints count.
inline constexpr std::size_t kMostAngles = 20'000'000;

/// Positions at open edges count as one if their distance is at most this part of the mesh's longest side. This is
/// wider than the rounding of corners in files of few digits, and a small part of any useful spacing.
inline constexpr double kCrackWidth = 1e-4;

struct Cracks {
  /// The mesh has open edges, and none is left when its cracks are welded. False also if most of its triangles are then
  /// copies of others, as in sheets with a front and a back.
  bool all = false;
  std::int64_t inconsistent_edges = 0;  ///< welded edges of two triangles that run along it in the same direction
};

/// Looks for cracks: gaps between triangles that share their corners but for rounding. An edge is open here if it has
/// an odd number of triangles; orientation does not matter. Nothing is moved: whoever decides a sign by it has to pass
/// over cracks of that width by other means. Takes linear time but for sorting. Requires a valid mesh and its edges.
Cracks find_cracks(MeshView mesh, const MeshEdges& edges);

}  // namespace standoff
