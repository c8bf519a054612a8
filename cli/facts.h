// What `standoff info` finds out about meshes and fields.
#pragma once

#include <cstdint>

#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff::cli {

struct MeshFacts {
  std::int64_t degenerate = 0;   ///< triangles without area
  std::int64_t duplicate = 0;    ///< triangles with the same corners as an earlier one
  std::int64_t boundary = 0;     ///< edges of one triangle
  std::int64_t nonmanifold = 0;  ///< edges of three triangles or more
  double area = 0;

  /// Every edge has two triangles.
  bool closed() const { return boundary == 0 && nonmanifold == 0; }
};
/// Requires a valid mesh. Triangles that name a vertex twice have no edges here.
MeshFacts facts(MeshView mesh);

struct FieldFacts {
  double least = 0;
  double most = 0;
  std::int64_t band = 0;        ///< see facts below
  std::int64_t not_number = 0;  ///< samples that are NaN; least and most leave them out
};
/// The band is counted by the stored nearest triangles: what has one lies no farther than the thickness, as compute
/// counts. Without them it is counted by the values below the thickness, for one that equals it may have been clamped.
FieldFacts facts(const DistanceField& field);

}  // namespace standoff::cli
