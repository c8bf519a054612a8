// SPDX-License-Identifier: Apache-2.0
// Statistics of meshes and fields, for reports and for checking files before use.
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
  std::int64_t boundary_edges = 0;     ///< edges with exactly one triangle
  std::int64_t nonmanifold_edges = 0;  ///< edges with three triangles or more

  /// Whether every edge has two triangles. Self-intersections and orientation are not checked.
  bool closed() const { return boundary_edges == 0 && nonmanifold_edges == 0; }
};

/// Computes statistics of a mesh. Vertices are compared by index: if every triangle has its own vertices, every edge is
/// a boundary edge. The edges of a triangle that names a vertex twice are not counted. Takes 36 bytes per triangle, and
/// the time to sort three edges per triangle. Errors: those of validate(mesh); limit.
STANDOFF_API MeshSummary inspect(MeshView mesh);

struct FieldSummary {
  double min = 0, max = 0;  ///< of all values but NaN, world units; infinite if every value is NaN
  std::int64_t band = 0;    ///< samples in the band; see inspect
  std::int64_t nan = 0;     ///< samples that are not a number
};

/// Computes statistics over every sample of a field, in the time to go over its stored tiles: others have one value
/// each. If the field has nearest triangles, its band is the samples that have one, as in compute(). Otherwise it is
/// the samples nearer than the thickness, because a value that equals the thickness may be clamped.
STANDOFF_API FieldSummary inspect(const DistanceField& field);

}  // namespace standoff
