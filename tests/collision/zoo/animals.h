// SPDX-License-Identifier: Apache-2.0
// The zoo: bodies of few triangles, each of a shape that has broken somebody's collision test, and poses in which they
// touch, nearly touch, or do not.
#pragma once

#include "tests/collision/zoo/slivers.h"

namespace standoff::testing {

inline Vec3 rounded(Vec3 v) { return {std::round(v.x), std::round(v.y), std::round(v.z)}; }

/// A triangle of about unit size, alone or placed at one of the herd.
inline Corners animal(Random& random, const Mesh& herd) {
  const auto moved_to = [&](const Corners& t, Vec3 by) { return Corners{t[0] + by, t[1] + by, t[2] + by}; };
  const Vec3 at = random.in_cube(1), p = at + random.in_cube(1), q = at + random.in_cube(1), r = at + random.in_cube(1);
  const auto lattice = [&] { return rounded(random.in_cube(2.4)) * 0.5; };
  const auto sliver_at = [&](Thin thin) { return sliver(random, log_between(random, 1e-15, 1), thin).at(at); };
  if (!herd.triangles.empty() && random.below(2)) {
    const auto other = random.below(static_cast<std::uint32_t>(herd.triangles.size()));
    const MeshView view = herd;
    const Vec3 a = view.corner(other, 0), b = view.corner(other, 1), c = view.corner(other, 2);
    switch (random.below(9)) {
      case 0:
        return {a, b, c};  // twice
      case 1:
        return {b, a, c};  // twice, turned round
      case 2:
        return {a, b, p};  // a shared edge
      case 3:
        return {a, p, q};  // a shared corner
      case 4:
        return {(a + b) * 0.5, p, q};  // a corner on an edge
      case 5:
        return {(a + b) * 0.5, (a + c) * 0.5, (b + c) * 0.5};  // in it, or nearly
      case 6:
        return {a, a + (b - a) * 2.0, a + (c - a) * 0.5};  // in its plane
      case 7:
        return moved_to({a, b, c}, direction(random) * log_between(random, 1e-16, 1e-3));  // stacks
      default:
        return {(a + b + c) * (1 / 3.0), (a + b) * 0.5, p};  // an edge out of its middle
    }
  }
  switch (random.below(12)) {
    case 0:
      return {p, q, r};
    case 1:
      return sliver_at(Thin::any_way);
    case 2:
      return moved_to(sliver_at(Thin::along_z), Vec3{0, 0, -at.z});
    case 3:
      return {p, p + direction(random) * log_between(random, 1e-15, 1e-2), r};  // a needle
    case 4: {                                                                   // a speck
      const double size = log_between(random, 1e-14, 1e-2);
      return {p, p + random.in_cube(size), p + random.in_cube(size)};
    }
    case 5:
      return {p, p + (q - p) * random.between(-1, 2), q};  // on a line, up to rounding
    case 6:
      return {p, (p + q) * 0.5, q};  // on a line, often exactly
    case 7:
      return random.below(2) ? Corners{p, q, q} : Corners{p, p, p};
    case 8: {  // huge
      const double size = log_between(random, 10, 1e6);
      return {p - (q - at) * size, p + (q - at) * size, p + (r - at) * size};
    }
    case 9: {  // on an axis' plane
      const double x = 0.5 * std::round(random.between(-2, 2));
      return {Vec3{x, p.y, p.z}, Vec3{x, q.y, q.z}, Vec3{x, r.y, r.z}};
    }
    default:
      return {lattice(), lattice(), lattice()};
  }
}

inline Mesh herd(Random& random, int count) {
  Mesh mesh;
  for (int n = 0; n < count; ++n) {
    const Corners t = animal(random, mesh);
    add_triangle(mesh, t[0], t[1], t[2]);
  }
  return mesh;
}

/// The herd in other units, somewhere: within the limits of docs/collision.md.
inline Mesh in_units(Mesh mesh, double unit, Vec3 at) {
  for (Vec3& v : mesh.vertices) v = v * unit + at;
  return mesh;
}

/// A rotation: none, by quarters, any, or as far from rigid as kRigidTolerance allows.
inline Pose any_rotation(Random& random) {
  constexpr std::array<std::array<double, 9>, 3> kQuarters{
      {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 1, 0, 1, 0, -1, 0, 0}, {-1, 0, 0, 0, 1, 0, 0, 0, -1}}};
  Pose pose;
  const std::uint32_t kind = random.below(6);
  if (kind < 2) return pose;
  if (kind == 2) return {kQuarters[random.below(3)], {}};
  pose = random_pose(random, 0);
  pose.translation = {};
  if (kind == 3)
    for (double& r : pose.rotation) r = static_cast<float>(r);
  if (kind == 4)
    for (double& r : pose.rotation) r *= 1 + random.between(-1, 1) * 2e-7;
  return pose;
}

/// A point of a triangle: a corner, on an edge, inside.
inline Vec3 point_of(Random& random, const Corners& t) {
  switch (random.below(5)) {
    case 0:
      return t[random.below(3)];
    case 1:
      return (t[0] + t[1]) * 0.5;
    case 2:
      return t[1] + (t[2] - t[1]) * random.between(0, 1);
    default: {
      const double s = random.between(0, 1), u = random.between(0, 1 - s);
      return t[0] + (t[1] - t[0]) * s + (t[2] - t[0]) * u;
    }
  }
}

/// A pose of b that brings a point of one of its triangles to a point of one of a's, exactly or about so.
inline Pose meeting_pose(Random& random, MeshView a, const Pose& pose_a, MeshView b, double size) {
  const Vec3 on_a = apply(
                 pose_a,
                 point_of(random, corners_at(a, random.below(static_cast<std::uint32_t>(a.triangles.size())), {}))),
             on_b = point_of(random, corners_at(b, random.below(static_cast<std::uint32_t>(b.triangles.size())), {}));
  Pose pose = any_rotation(random);
  if (random.below(4) == 0) pose.rotation = pose_a.rotation;
  pose.translation = on_a - rotate(pose, on_b);
  const std::uint32_t kind = random.below(4);
  if (kind == 0) pose.translation = pose.translation + direction(random) * (size * log_between(random, 1e-17, 1));
  if (kind == 1) pose.translation = pose.translation + random.in_cube(2 * size);
  return pose;
}

}  // namespace standoff::testing
