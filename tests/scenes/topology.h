// SPDX-License-Identifier: Apache-2.0
// What the tests of scenes ask of a mesh as a surface.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "standoff/mesh.h"

namespace standoff {

/// Directed edges that no triangle runs through the other way: 0 for a closed and consistently oriented mesh.
inline std::int64_t unmatched_edges(MeshView mesh) {
  std::vector<std::uint64_t> forward, backward;
  for (const Triangle& t : mesh.triangles)
    for (int e = 0; e < 3; ++e) {
      const std::uint64_t a = t[e], b = t[(e + 1) % 3];
      forward.push_back((a << 32) | b);
      backward.push_back((b << 32) | a);
    }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  std::vector<std::uint64_t> unmatched;
  std::set_difference(forward.begin(), forward.end(), backward.begin(), backward.end(), std::back_inserter(unmatched));
  return static_cast<std::int64_t>(unmatched.size());
}

/// For each part (triangles connected by vertices) the volume it encloses, negative where it is inside out.
inline std::vector<double> part_volumes(MeshView mesh) {
  std::vector<std::uint32_t> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles) {
    root[find(t[1])] = find(t[0]);
    root[find(t[2])] = find(t[0]);
  }
  std::unordered_map<std::uint32_t, double> volumes;
  for (const Triangle& t : mesh.triangles) {
    const auto part = find(t[0]);
    const Vec3 base = mesh.vertices[part];  // near the part, so that little cancels
    const Vec3 a = mesh.vertices[t[0]] - base, b = mesh.vertices[t[1]] - base, c = mesh.vertices[t[2]] - base;
    volumes[part] += dot(a, cross(b, c)) / 6;
  }
  std::vector<double> result;
  for (const auto& [part, volume] : volumes) result.push_back(volume);
  return result;
}

/// Triangles with a repeated vertex or without area.
inline std::int64_t flat_triangles(MeshView mesh) {
  return std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    const Vec3 a = mesh.vertices[t[0]];
    const Vec3 normal = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    return !(dot(normal, normal) > 0);
  });
}

}  // namespace standoff
