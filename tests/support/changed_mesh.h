// SPDX-License-Identifier: Apache-2.0
// Meshes made of others.
#pragma once

#include <cstdint>
#include <utility>

#include "standoff/mesh.h"

namespace standoff::testing {

inline Mesh moved(Mesh mesh, Vec3 by, double scale = 1) {
  for (Vec3& v : mesh.vertices) v = v * scale + by;
  return mesh;
}

inline Mesh reversed(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

inline void append(Mesh& to, const Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const Triangle& t : mesh.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

inline Mesh joined(Mesh mesh, const Mesh& other) {
  append(mesh, other);
  return mesh;
}

/// Each triangle gets vertices of its own.
inline Mesh unwelded(const Mesh& mesh) {
  Mesh apart;
  for (const Triangle& t : mesh.triangles)
    append(apart, {{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, {{0, 1, 2}}});
  return apart;
}

/// Without some triangles in a row.
inline Mesh with_hole(Mesh mesh, std::ptrdiff_t first, std::ptrdiff_t end) {
  mesh.triangles.erase(mesh.triangles.begin() + first, mesh.triangles.begin() + end);
  return mesh;
}

}  // namespace standoff::testing
