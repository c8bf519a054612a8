// SPDX-License-Identifier: Apache-2.0
// Triangle meshes: triangles over shared vertices.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "standoff/export.h"
#include "standoff/mesh_view.h"
#include "standoff/vec.h"

namespace standoff {

/// The most triangles a mesh may have. An index of one fits in 32 bits, with room for a few marks.
inline constexpr std::uint64_t kMaxTriangles = 4'000'000'000;

/// Stands for "no triangle" where an index is told: a sample farther than the thickness, a query without a hit.
inline constexpr std::uint32_t kNoTriangle = std::numeric_limits<std::uint32_t>::max();

/// A mesh that owns its vertices (world units) and triangles.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  operator MeshView() const { return {vertices, triangles}; }
};

/// Throws Error{input} that names the first triangle whose indices are out of range or whose corners are not finite,
/// or says that there are no triangles; Error{usage} for arrays that are null but said not to be empty; and
/// Error{limit} for more than kMaxTriangles triangles or 2^32 - 1 vertices. Vertices that no triangle uses are not
/// looked at.
STANDOFF_API void validate(MeshView mesh);

/// The box of all corners of all triangles; empty for a mesh without triangles. Errors: input (index out of range).
STANDOFF_API Box bounds(MeshView mesh);

/// A 64-bit hash of vertices and triangles, in order: equal meshes have equal hashes on every machine, in every
/// layout.
STANDOFF_API std::uint64_t content_hash(MeshView mesh);

}  // namespace standoff
