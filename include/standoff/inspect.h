// SPDX-License-Identifier: Apache-2.0
// What a mesh or a field holds, in numbers: for reports, and for a look at files before they are used.
#pragma once

#include <cstdint>

#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff {

struct MeshSummary {
  Box bounds;                          ///< of all corners
  double area = 0;                     ///< of all triangles together, in squared units of the mesh
  std::int64_t degenerate = 0;         ///< triangles without area
  std::int64_t duplicate = 0;          ///< triangles with the same three vertices as an earlier one, in any order
  std::int64_t boundary_edges = 0;     ///< edges of one triangle
  std::int64_t nonmanifold_edges = 0;  ///< edges of three triangles or more

  /// Every edge has two triangles. Whether triangles cross each other, and which side they face, is not looked at.
  bool closed() const { return boundary_edges == 0 && nonmanifold_edges == 0; }
};

/// Counts what a mesh holds. Vertices are told apart by their index: where a file gives every triangle vertices of its
/// own, every edge is a boundary. Triangles that name a vertex twice have no edges. Takes 36 bytes a triangle, and the
/// time to sort three edges of each. Errors: those of validate(mesh); limit.
STANDOFF_API MeshSummary inspect(MeshView mesh);

struct FieldSummary {
  double min = 0, max = 0;  ///< of the values in world units; NaN is left out; infinite where every value is NaN
  std::int64_t band = 0;    ///< samples no farther than the thickness; see inspect
  std::int64_t nan = 0;     ///< samples that are not a number
};

/// Looks at every sample of a field, a slice at a time. A field with nearest triangles counts as its band the samples
/// that have one, as compute() does. Without them it counts the samples nearer than the thickness: one whose value
/// equals the thickness may have been clamped to it. Errors: limit.
STANDOFF_API FieldSummary inspect(const DistanceField& field);

}  // namespace standoff
