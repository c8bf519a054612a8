// Triangle meshes: triangles over shared vertices.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "standoff/vec.h"

namespace standoff {

/// Three indices into the vertices of a mesh.
using Triangle = std::array<std::uint32_t, 3>;

/// Somebody else's triangles. Open, nonmanifold, self-intersecting and unoriented meshes, degenerate and duplicate
/// triangles are all legal; NaN or infinite vertices and indices out of range are not.
struct MeshView {
  std::span<const Vec3> vertices;
  std::span<const Triangle> triangles;

  /// Requires a triangle of the mesh, and k in 0 to 2.
  Vec3 corner(std::size_t triangle, int k) const { return vertices[triangles[triangle][k]]; }
};

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
/// or says that there are no triangles, and Error{limit} for more than kMaxTriangles triangles or 2^32 - 1 vertices.
/// Vertices that no triangle uses are not looked at.
void validate(MeshView mesh);

/// The box of all corners of all triangles; empty for a mesh without triangles. Errors: input (index out of range).
Box bounds(MeshView mesh);

/// A 64-bit hash of vertices and triangles, in order: equal meshes have equal hashes on every machine.
std::uint64_t content_hash(MeshView mesh);

}  // namespace standoff
