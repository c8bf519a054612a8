// SPDX-License-Identifier: Apache-2.0
// Whether a mesh is a closed, oriented manifold, asked in the plainest way; its volume, area and Euler characteristic.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "standoff/mesh.h"

namespace standoff::testing {

/// Empty, or what is wrong. Vertices count by position: what coincides is one vertex.
inline std::string manifold_fault(const Mesh& mesh) {
  std::map<std::array<double, 3>, std::uint32_t> numbers;
  std::vector<std::uint32_t> number;
  for (const Vec3& v : mesh.vertices) {
    if (!is_finite(v)) return "a vertex is not finite";
    number.push_back(numbers.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(numbers.size())).first->second);
  }
  if (numbers.size() != mesh.vertices.size())
    return std::to_string(mesh.vertices.size() - numbers.size()) + " vertices coincide with others";
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  std::vector<std::map<std::uint32_t, std::uint32_t>> fans(mesh.vertices.size());  // from neighbour to neighbour
  for (const Triangle& t : mesh.triangles)
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = t[n], b = t[(n + 1) % 3], c = t[(n + 2) % 3];
      if (a == b) return "a triangle has a vertex twice";
      if (++uses[{a, b}] > 1) return "two triangles go along an edge in the same direction";
      fans[a][b] = c;
    }
  for (const auto& [edge, count] : uses)
    if (!uses.contains({edge.second, edge.first})) return "an edge has one triangle";
  for (const auto& fan : fans) {
    if (fan.empty()) return "a vertex has no triangle";
    std::size_t steps = 0;
    const std::uint32_t first = fan.begin()->first;
    std::uint32_t at = first;
    do {
      at = fan.at(at);
      ++steps;
    } while (at != first && steps <= fan.size());
    if (steps != fan.size()) return "the triangles at a vertex are more than one fan";
  }
  return "";
}

inline double volume(const Mesh& mesh) {
  double sum = 0;
  const Vec3 o = mesh.vertices.empty() ? Vec3{} : mesh.vertices[0];
  for (const Triangle& t : mesh.triangles)
    sum += dot(mesh.vertices[t[0]] - o, cross(mesh.vertices[t[1]] - o, mesh.vertices[t[2]] - o)) / 6;
  return sum;
}

inline double area(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += length(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]])) / 2;
  return sum;
}

/// Vertices - edges + triangles of a closed mesh: 2 for each sphere, 0 for a torus.
inline std::int64_t euler_characteristic(const Mesh& mesh) {
  return std::ssize(mesh.vertices) - std::ssize(mesh.triangles) / 2;
}

}  // namespace standoff::testing
