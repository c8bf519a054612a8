// Whether a mesh can be computed with.
#include "standoff/mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>
#include <string>

#include "core/guarded.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// Their indices fit in 32 bits.
constexpr std::uint64_t kMaxVertices = 0xffff'ffffu;

// Both go through memory in its own order, which is several times faster than from corner to corner.
using Positions = tbb::blocked_range<std::size_t>;
constexpr std::size_t kGrain = 16384;

bool indices_in_range(MeshView mesh) {
  const auto look = [&](const Positions& positions, bool good) {
    for (std::size_t t = positions.begin(); t < positions.end(); ++t)
      for (const auto v : mesh.triangles[t]) good &= v < mesh.vertices.size();
    return good;
  };
  return tbb::parallel_reduce(Positions(0, mesh.triangles.size(), kGrain), true, look, std::logical_and<>());
}

bool vertices_finite(MeshView mesh) {
  const auto look = [&](const Positions& positions, bool good) {
    for (std::size_t v = positions.begin(); v < positions.end(); ++v) good &= is_finite(mesh.vertices[v]);
    return good;
  };
  return tbb::parallel_reduce(Positions(0, mesh.vertices.size(), kGrain), true, look, std::logical_and<>());
}

}  // namespace

void validate(MeshView mesh) try {
  if (mesh.triangles.empty()) throw Error(ErrorCode::input, "mesh: no triangles; give a mesh with at least one");
  const auto vertices = mesh.vertices.size();
  if (mesh.triangles.size() > kMaxTriangles || vertices > kMaxVertices)
    throw Error(ErrorCode::limit, "mesh: " + std::to_string(mesh.triangles.size()) + " triangles over " +
                                      std::to_string(vertices) + " vertices are more than " +
                                      std::to_string(kMaxTriangles) + " over " + std::to_string(kMaxVertices) +
                                      "; split the mesh");
  if (indices_in_range(mesh) && vertices_finite(mesh)) return;
  // Something is wrong, or a vertex that nothing uses is not finite: corner by corner.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const auto v : mesh.triangles[t]) {
      if (v >= vertices)
        throw Error(ErrorCode::input, "mesh: triangle " + std::to_string(t) + ": index " + std::to_string(v) +
                                          " is out of range, there are " + std::to_string(vertices) +
                                          " vertices; repair the mesh");
      if (!is_finite(mesh.vertices[v]))
        throw Error(ErrorCode::input, "mesh: triangle " + std::to_string(t) + ": vertex " + std::to_string(v) +
                                          " is not finite; repair the mesh");
    }
  }
} catch (...) {
  throw_as_error("mesh");
}

}  // namespace standoff
