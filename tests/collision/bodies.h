// SPDX-License-Identifier: Apache-2.0
// Bodies, poses and brute force for the tests of collision queries.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "geometry/triangle_pair.h"
#include "standoff/collision.h"
#include "tests/support/error_code.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {

inline Pose random_pose(Random& random, double half) {
  return make_pose(random.in_cube(1) + Vec3{0, 0, 1e-3}, random.between(0, 2 * std::numbers::pi), random.in_cube(half));
}

inline Pose moved(Vec3 by) {
  Pose pose;
  pose.translation = by;
  return pose;
}

inline Corners corners_at(MeshView mesh, std::size_t t, const Pose& pose) {
  return {apply(pose, mesh.corner(t, 0)), apply(pose, mesh.corner(t, 1)), apply(pose, mesh.corner(t, 2))};
}

/// Some pair of triangles has a point in common.
inline bool brute_touch(MeshView a, const Pose& pose_a, MeshView b, const Pose& pose_b) {
  for (std::size_t s = 0; s < a.triangles.size(); ++s)
    for (std::size_t t = 0; t < b.triangles.size(); ++t)
      if (triangles_intersect(corners_at(a, s, pose_a), corners_at(b, t, pose_b))) return true;
  return false;
}

/// The least distance of all pairs of triangles.
inline double brute_pair_distance(MeshView a, const Pose& pose_a, MeshView b, const Pose& pose_b) {
  double least_sq = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < a.triangles.size(); ++s)
    for (std::size_t t = 0; t < b.triangles.size(); ++t) {
      const Corners p = corners_at(a, s, pose_a), q = corners_at(b, t, pose_b);
      if (triangles_intersect(p, q)) return 0;
      least_sq = std::min(least_sq, closest_points(p, q).distance_sq);
    }
  return std::sqrt(least_sq);
}

/// A closed body: a subdivided octahedron pushed out to a sphere.
inline Mesh ball_mesh(double radius, int cuts, Vec3 center = {}) {
  Mesh mesh;
  const auto on_sphere = [&](Vec3 v) { return center + v * (radius / length(v)); };
  for (int octant = 0; octant < 8; ++octant) {
    const double sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
    const auto at = [&](int i, int j) { return on_sphere({sx * i, sy * j, sz * (cuts - i - j)}); };
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; i + j < cuts; ++j) {
        add_triangle(mesh, at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < cuts) add_triangle(mesh, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return mesh;
}

inline Mesh one_triangle(Vec3 a, Vec3 b, Vec3 c) {
  Mesh mesh;
  add_triangle(mesh, a, b, c);
  return mesh;
}

}  // namespace standoff::testing
