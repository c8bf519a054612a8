// SPDX-License-Identifier: Apache-2.0
// How far the winding number beside a surface is from an integer: 0 beside a body, 1 beside a sheet.
#pragma once

#include "sign/diagnosis/boundary.h"
#include "sign/oriented_mesh.h"

namespace standoff {

/// Behind a triangle the winding number is 1 higher than in front of it: W + 1/2 and W - 1/2, where W is that of all
/// other triangles there. Beside a body both are integers, whatever it contains and however often it winds. Beside a
/// sheet that nothing else is near, W is 0, and which side is inside cannot be told. The openness of a point on the
/// mesh is the distance of W + 1/2 from the nearest integer, times 2; that of a mesh is the mean over its area.
///
/// It needs no ray and no triangle. Triangles that close the boundary make W + 1/2 an integer, so their winding number
/// is as far from one. What closes the boundary does not matter, because two ways differ by a closed mesh: here it is a
/// cone of one apex. Whether cracks have a width does not matter either: what closes them is seen from few points.
///
/// Taken at centroids of triangles: of all, by their areas, if there are up to kMostPoints, else of some, evenly spread
/// over the area in the order of the triangles; of kLeastPoints at least, and for long boundaries of no more than
/// kMostAngles allow. In [0, 1], 0 without a boundary. `boundary` is that of the mesh. Does not depend on the number of
/// threads. Runs on the threads of the calling TBB arena.
double openness_of(const OrientedMesh& mesh, const Boundary& boundary);

inline constexpr std::size_t kMostPoints = 512, kLeastPoints = 32;
/// Solid angles of boundary edges, in all: about a fifth of a second. With more than 625,000 edges kLeastPoints count.
inline constexpr std::size_t kMostAngles = 20'000'000;

}  // namespace standoff
