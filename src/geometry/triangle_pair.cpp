// SPDX-License-Identifier: Apache-2.0
// Two triangles intersect exactly where an edge of one intersects the other. An edge intersects a triangle where its
// ends are not on the same side of the triangle's plane and the line through it passes all three edges on the same
// side: signs of determinants alone, which are exact. What lies in one plane is decided in the plane (coplanar.h).
#include "geometry/triangle_pair.h"

#include <algorithm>
#include <cstdlib>

#include "geometry/closest_pair.h"

namespace standoff {
namespace {

// `from` and `to` are the sides of t's plane that p and q lie on.
bool edge_intersects(const Vec3& p, const Vec3& q, int from, int to, const Corners& t) {
  if (from * to > 0) return false;
  if (from == 0 && to == 0) return intersects_in_plane(p, q, t);
  const int ab = orient3d(p, q, t[0], t[1]), bc = orient3d(p, q, t[1], t[2]);
  if (ab * bc < 0) return false;
  const int ca = orient3d(p, q, t[2], t[0]);
  return ab * ca >= 0 && bc * ca >= 0;
}

}  // namespace

bool triangles_intersect(const Corners& p, const Corners& q) {
  if (common_corner(p, q)) return true;
  int of_p[3], of_q[3];
  for (int n = 0; n < 3; ++n) of_p[n] = orient3d(q[0], q[1], q[2], p[n]);
  if (std::abs(of_p[0] + of_p[1] + of_p[2]) == 3) return false;
  for (int n = 0; n < 3; ++n) of_q[n] = orient3d(p[0], p[1], p[2], q[n]);
  if (std::abs(of_q[0] + of_q[1] + of_q[2]) == 3) return false;
  for (int n = 0, m = 2; n < 3; m = n++)
    if (edge_intersects(p[m], p[n], of_p[m], of_p[n], q) || edge_intersects(q[m], q[n], of_q[m], of_q[n], p))
      return true;
  return false;
}

ClosestPair closest_points(const Corners& p, const Corners& q) {
  const Triple<double> of_p[3] = {triple_of(p[0]), triple_of(p[1]), triple_of(p[2])},
                       of_q[3] = {triple_of(q[0]), triple_of(q[1]), triple_of(q[2])};
  const auto found = closest_pair(of_p, of_q);
  return {found.distance_sq, vec_of(found.on_p), vec_of(found.on_q), vec_of(found.separation)};
}

double extent_of(const Corners& p, const Corners& q) {
  Box box;
  for (const Corners* corners : {&p, &q})
    for (const Vec3& corner : *corners) box.include(corner);
  return box.longest_side();
}

}  // namespace standoff
