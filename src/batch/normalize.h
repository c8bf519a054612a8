// SPDX-License-Identifier: Apache-2.0
// Meshes of all sizes and places brought to one: what networks are trained with.
#pragma once

#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

enum class Normalization {
  none,
  unit_cube,    ///< the box's longest side becomes 1, its centre the origin: coordinates lie in [-0.5, 0.5]
  unit_sphere,  ///< the box's centre becomes the origin, the farthest corner's distance from it 1
};

/// Takes a point p to (p - center) * scale.
struct Similarity {
  Vec3 center;
  double scale = 1;
};

/// What brings the corners of the mesh's triangles there. Errors: input, for a mesh without any extent, whose scale
/// would be infinite; and what bounds() finds.
Similarity normalization(MeshView mesh, Normalization kind);

/// Moves all vertices, also those that no triangle has.
void apply(const Similarity& similarity, Mesh& mesh);

}  // namespace standoff
