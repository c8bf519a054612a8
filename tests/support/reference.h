// SPDX-License-Identifier: Apache-2.0
// Distances by definition, independent of everything in src: a triangle is its three edges and, where the point's foot
// lies between them, its face. In long double, so that slivers and far points need no thought.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff::testing {

struct LongVec3 {
  long double x, y, z;
  friend LongVec3 operator-(const LongVec3& a, const LongVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};
inline LongVec3 to_long(Vec3 v) { return {v.x, v.y, v.z}; }
inline long double inner(const LongVec3& a, const LongVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline LongVec3 outer(const LongVec3& a, const LongVec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The distance from p to the triangle abc, which may be a segment or a point.
inline double reference_distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const LongVec3 corner[3] = {to_long(a) - to_long(p), to_long(b) - to_long(p), to_long(c) - to_long(p)};
  const LongVec3 n = outer(corner[1] - corner[0], corner[2] - corner[0]);
  const long double n_sq = inner(n, n);
  bool over_face = n_sq > 0;
  long double least_sq = std::numeric_limits<long double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const LongVec3 &from = corner[k], edge = corner[(k + 1) % 3] - from;
    over_face = over_face && inner(outer(n, edge), from) <= 0;
    const long double edge_sq = inner(edge, edge);
    const long double t = edge_sq > 0 ? std::clamp(-inner(from, edge) / edge_sq, 0.0L, 1.0L) : 0.0L;
    const LongVec3 q{from.x + t * edge.x, from.y + t * edge.y, from.z + t * edge.z};
    least_sq = std::min(least_sq, inner(q, q));
  }
  if (over_face) {
    const long double height = inner(corner[0], n);
    least_sq = std::min(least_sq, height * height / n_sq);
  }
  return static_cast<double>(std::sqrt(least_sq));
}

inline double reference_distance(MeshView mesh, std::size_t triangle, Vec3 p) {
  return reference_distance(p, mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2));
}

inline double reference_distance(MeshView mesh, Vec3 p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) least = std::min(least, reference_distance(mesh, t, p));
  return least;
}

/// What compute() promises where the distance is `distance`, and what a double cannot tell apart at the grid's place.
inline double promised_error(const Grid& grid, double distance) {
  const Box box = grid.bounds();
  double reach = 0;
  for (const double c : {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z})
    reach = std::max(reach, std::abs(c));
  return 1e-6 * (distance + 16 * grid.max_spacing()) + 4 * std::numeric_limits<double>::epsilon() * reach;
}

}  // namespace standoff::testing
