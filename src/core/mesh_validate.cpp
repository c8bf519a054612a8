// SPDX-License-Identifier: Apache-2.0
// Whether a mesh can be computed with.
#include "standoff/mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>
#include <string>

#include "core/guarded.h"
#include "core/mesh_errors.h"

namespace standoff {
namespace {

// Their indices fit in 32 bits.
constexpr std::uint64_t kMaxVertices = 0xffff'ffffu;

// Both go through memory in its own order, which is several times faster than from corner to corner.
using VertexRange = tbb::blocked_range<std::size_t>;
constexpr std::size_t kVertexGrain = 16384;

// Packed arrays in a loop of their own, which the compiler makes wide.
template <class Array, class Look>
void each_in_memory(const Array& array, const VertexRange& positions, Look look) {
  if (const auto packed = array.as_span())
    for (std::size_t n = positions.begin(); n < positions.end(); ++n) look((*packed)[n]);
  else
    for (std::size_t n = positions.begin(); n < positions.end(); ++n) look(array[n]);
}

bool indices_in_range(MeshView mesh) {
  const auto look = [&](const VertexRange& positions, bool good) {
    each_in_memory(mesh.triangles, positions, [&](const Triangle& t) {
      for (const std::uint32_t v : t) good &= v < mesh.vertices.size();
    });
    return good;
  };
  return tbb::parallel_reduce(VertexRange(0, mesh.triangles.size(), kVertexGrain), true, look, std::logical_and<>());
}

bool vertices_finite(MeshView mesh) {
  const auto look = [&](const VertexRange& positions, bool good) {
    each_in_memory(mesh.vertices, positions, [&](const Vec3& v) { good &= is_finite(v); });
    return good;
  };
  return tbb::parallel_reduce(VertexRange(0, mesh.vertices.size(), kVertexGrain), true, look, std::logical_and<>());
}

}  // namespace

void validate(MeshView mesh) try {
  if (mesh.triangles.empty()) throw Error(ErrorCode::input, "mesh: no triangles; give a mesh with at least one");
  const auto vertices = mesh.vertices.size();
  if (!mesh.triangles.data() || (vertices > 0 && !mesh.vertices.data()))
    throw Error(ErrorCode::usage, "mesh: an array is null but said not to be empty; give its address");
  if (mesh.triangles.size() > kMaxTriangles || vertices > kMaxVertices)
    throw Error(ErrorCode::limit, "mesh: " + std::to_string(mesh.triangles.size()) + " triangles over " +
                                      std::to_string(vertices) + " vertices are more than " +
                                      std::to_string(kMaxTriangles) + " over " + std::to_string(kMaxVertices) +
                                      "; split the mesh");
  if (indices_in_range(mesh) && vertices_finite(mesh)) return;
  // Something is wrong, or a vertex that nothing uses is not finite: corner by corner.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] >= vertices) fail_index(mesh, t, k);
      if (!is_finite(mesh.vertices[triangle[k]]))
        fail_triangle(t, "vertex " + std::to_string(triangle[k]) + " is not finite");
    }
  }
} catch (...) {
  throw_as_error("mesh");
}

}  // namespace standoff
