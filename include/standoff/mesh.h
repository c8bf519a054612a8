// SPDX-License-Identifier: Apache-2.0
// Triangle meshes: triangles over shared vertices.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "standoff/axis.h"
#include "standoff/export.h"
#include "standoff/mesh_view.h"
#include "standoff/vec.h"

namespace standoff {

/// The largest number of triangles of a mesh. Indices fit into 32 bits, and a few values remain for special meanings.
inline constexpr std::uint64_t kMaxTriangles = 4'000'000'000;

/// The index that means "no triangle", for a sample farther than the thickness or a query without a hit.
inline constexpr std::uint32_t kNoTriangle = std::numeric_limits<std::uint32_t>::max();

/// A mesh that owns its vertices (world units) and triangles.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  operator MeshView() const { return {vertices, triangles}; }
};

/// Throws Error{input} if an index is out of range or a corner is not finite, and names the first such triangle. Also
/// throws Error{input} if there are no triangles, Error{usage} for null arrays whose size is not 0, and Error{limit}
/// for more than kMaxTriangles triangles or 2^32 - 1 vertices. Vertices that no triangle uses are not checked.
STANDOFF_API void validate(MeshView mesh);

/// The box around all corners of all triangles; empty for a mesh without triangles. Errors: input (index out of range).
STANDOFF_API Box bounds(MeshView mesh);

/// The axis that points up in pictures of a mesh of which nothing says it: that along which it stands on the flattest
/// base, the largest share of its box that triangles cover at the bottom. Where no base, or no single one, is flat: z,
/// else y. Errors: input (index out of range).
STANDOFF_API Axis up_axis(MeshView mesh);

/// A 64-bit hash of the vertices and triangles, in order. Equal meshes have equal hashes on every machine and in every
/// memory layout.
STANDOFF_API std::uint64_t content_hash(MeshView mesh);

}  // namespace standoff
