// SPDX-License-Identifier: Apache-2.0
// Closed, oriented bodies, and winding numbers by solid angles.
#pragma once

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "tests/collision/bodies.h"

namespace standoff::testing {

/// Oriented outwards, unlike ball_mesh().
inline Mesh solid_ball(double radius, int cuts, Vec3 center = {}) {
  Mesh mesh = ball_mesh(radius, cuts, center);
  for (Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    if (dot(cross(b - a, c - a), a - center) < 0) std::swap(t[1], t[2]);
  }
  return mesh;
}

/// Around the z axis: a tube of radius `tube` whose centre line has radius `ring`.
inline Mesh solid_torus(double ring, double tube, int around, int across) {
  Mesh mesh;
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(i % around * across + j % across); };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = ring + tube * std::cos(v);
      mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), tube * std::sin(v)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return mesh;
}

inline Mesh solid_box(Vec3 half, Vec3 center = {}) {
  Mesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.vertices.push_back(center +
                            Vec3{n & 1 ? half.x : -half.x, n & 2 ? half.y : -half.y, n & 4 ? half.z : -half.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline Mesh turned_inside_out(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

inline Mesh joined(std::initializer_list<Mesh> parts) {
  Mesh all;
  for (const Mesh& part : parts) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const Triangle& t : part.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

/// The winding number of a surface about a point, in double: solid angles by the formula of Van Oosterom and Strackee.
inline double winding_by_angles(MeshView mesh, const Pose& pose, Vec3 point) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners c = corners_at(mesh, t, pose);
    const Vec3 a = c[0] - point, b = c[1] - point, d = c[2] - point;
    const double la = length(a), lb = length(b), ld = length(d);
    sum += std::atan2(dot(a, cross(b, d)), la * lb * ld + dot(a, b) * ld + dot(b, d) * la + dot(d, a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace standoff::testing
