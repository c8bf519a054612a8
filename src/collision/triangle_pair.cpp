// Two triangles touch exactly where an edge of one touches the other triangle. An edge touches a triangle where its
// ends are not on the same side of the triangle's plane and the line through it passes all three edges on the same
// side: signs of determinants alone, which are exact. What lies in one plane is decided in the plane, after dropping an
// axis on which the plane does not stand upright; what lies on one line, by its extents.
#include "collision/triangle_pair.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "collision/closest_pair.h"
#include "collision/predicates.h"

namespace difi {
namespace {

Flat dropped(const Vec3& v, int axis) {
  if (axis == 0) return {v.y, v.z};
  if (axis == 1) return {v.z, v.x};
  return {v.x, v.y};
}

bool between(double v, double a, double b) { return (a <= v && v <= b) || (b <= v && v <= a); }
bool in_box(const Flat& p, const Flat& a, const Flat& b) { return between(p.x, a.x, b.x) && between(p.y, a.y, b.y); }

bool segments_touch(const Flat& p, const Flat& q, const Flat& a, const Flat& b) {
  const int pa = orient2d(p, q, a), pb = orient2d(p, q, b), ap = orient2d(a, b, p), aq = orient2d(a, b, q);
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && in_box(a, p, q)) || (pb == 0 && in_box(b, p, q)) || (ap == 0 && in_box(p, a, b)) ||
         (aq == 0 && in_box(q, a, b));
}

// An axis along which the points may be dropped into a plane without two of them falling together; -1: they lie on a
// line.
int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (orient2d(dropped(a, axis), dropped(b, axis), dropped(c, axis)) != 0) return axis;
  return -1;
}

bool extents_touch(double p, double q, double a, double b) {
  return std::max(std::min(p, q), std::min(a, b)) <= std::min(std::max(p, q), std::max(a, b));
}

bool segments_touch(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  if (orient3d(p, q, a, b) != 0) return false;
  int axis = upright_axis(p, q, a);
  if (axis < 0) axis = upright_axis(p, q, b);
  if (axis < 0) axis = upright_axis(a, b, p);
  if (axis < 0) axis = upright_axis(a, b, q);
  if (axis >= 0) return segments_touch(dropped(p, axis), dropped(q, axis), dropped(a, axis), dropped(b, axis));
  return extents_touch(p.x, q.x, a.x, b.x) && extents_touch(p.y, q.y, a.y, b.y) && extents_touch(p.z, q.z, a.z, b.z);
}

bool in_triangle(const Flat& p, const Flat& a, const Flat& b, const Flat& c) {
  const int ab = orient2d(a, b, p), bc = orient2d(b, c, p), ca = orient2d(c, a, p);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

// The segment lies in the triangle's plane, or the triangle has none.
bool touches_in_plane(const Vec3& p, const Vec3& q, const Corners& t) {
  const int axis = upright_axis(t[0], t[1], t[2]);
  if (axis < 0)
    return segments_touch(p, q, t[0], t[1]) || segments_touch(p, q, t[1], t[2]) || segments_touch(p, q, t[2], t[0]);
  const Flat a = dropped(t[0], axis), b = dropped(t[1], axis), c = dropped(t[2], axis);
  const Flat u = dropped(p, axis), v = dropped(q, axis);
  return in_triangle(u, a, b, c) || in_triangle(v, a, b, c) || segments_touch(u, v, a, b) ||
         segments_touch(u, v, b, c) || segments_touch(u, v, c, a);
}

// `from` and `to` are the sides of t's plane that p and q lie on.
bool touches(const Vec3& p, const Vec3& q, int from, int to, const Corners& t) {
  if (from * to > 0) return false;
  if (from == 0 && to == 0) return touches_in_plane(p, q, t);
  const int ab = orient3d(p, q, t[0], t[1]), bc = orient3d(p, q, t[1], t[2]);
  if (ab * bc < 0) return false;
  const int ca = orient3d(p, q, t[2], t[0]);
  return ab * ca >= 0 && bc * ca >= 0;
}

Vec3 face_normal(const Corners& t) { return cross(t[1] - t[0], t[2] - t[0]); }

// A corner that both have; neighbours in one mesh, and bodies that lie in the same place, have one.
const Vec3* common_corner(const Corners& p, const Corners& q) {
  for (const Vec3& corner : p)
    if (corner == q[0] || corner == q[1] || corner == q[2]) return &corner;
  return nullptr;
}

}  // namespace

bool triangles_touch(const Corners& p, const Corners& q) {
  if (common_corner(p, q)) return true;
  int of_p[3], of_q[3];
  for (int n = 0; n < 3; ++n) of_p[n] = orient3d(q[0], q[1], q[2], p[n]);
  if (std::abs(of_p[0] + of_p[1] + of_p[2]) == 3) return false;
  for (int n = 0; n < 3; ++n) of_q[n] = orient3d(p[0], p[1], p[2], q[n]);
  if (std::abs(of_q[0] + of_q[1] + of_q[2]) == 3) return false;
  for (int n = 0, m = 2; n < 3; m = n++)
    if (touches(p[m], p[n], of_p[m], of_p[n], q) || touches(q[m], q[n], of_q[m], of_q[n], p)) return true;
  return false;
}

ClosestPair closest_points(const Corners& p, const Corners& q) {
  const auto triple = [](const Vec3& v) { return Triple<double>{v.x, v.y, v.z}; };
  const auto vec = [](const Triple<double>& v) { return Vec3{v.x, v.y, v.z}; };
  const Triple<double> of_p[3] = {triple(p[0]), triple(p[1]), triple(p[2])},
                       of_q[3] = {triple(q[0]), triple(q[1]), triple(q[2])};
  const auto found = collision::closest_pair(of_p, of_q);
  return {found.distance_sq, vec(found.on_p), vec(found.on_q)};
}

Overlap overlap(const Corners& p, const Corners& q) {
  // The shared segment: where edges of one pass through the plane of the other, within it up to rounding.
  Overlap result{};
  Vec3 sum;
  int count = 0;
  const auto add_crossings = [&](const Corners& edges, const Corners& face) {
    const Vec3 n = face_normal(face);
    for (int k = 0, j = 2; k < 3; j = k++) {
      const double from = dot(n, edges[j] - face[0]), to = dot(n, edges[k] - face[0]);
      if ((from > 0) == (to > 0) || from == to) continue;
      const Vec3 at = edges[j] + (edges[k] - edges[j]) * (from / (from - to));
      bool inside = true;
      for (int b = 0, a = 2; b < 3; a = b++) inside = inside && dot(n, cross(face[b] - face[a], at - face[a])) >= 0;
      if (!inside) continue;
      sum = sum + at;
      ++count;
    }
  };
  add_crossings(p, q);
  add_crossings(q, p);
  if (count > 0) {
    result.point = sum * (1.0 / count);
  } else if (const Vec3* const corner = common_corner(p, q)) {
    result.point = *corner;
  } else {  // in one plane, or touching at less than rounding can tell
    const ClosestPair pair = closest_points(p, q);
    result.point = (pair.on_p + pair.on_q) * 0.5;
  }
  // The shortest way out along one of the two normals, either way.
  result.depth = std::numeric_limits<double>::infinity();
  const auto try_normal = [&](Vec3 n) {
    const double size = length(n);
    if (!(size > 0)) return;
    n = n * (1 / size);
    double p_least = dot(n, p[0]), p_most = p_least, q_least = dot(n, q[0]), q_most = q_least;
    for (int k = 1; k < 3; ++k) {
      p_least = std::min(p_least, dot(n, p[k])), p_most = std::max(p_most, dot(n, p[k]));
      q_least = std::min(q_least, dot(n, q[k])), q_most = std::max(q_most, dot(n, q[k]));
    }
    const double along = p_most - q_least, against = q_most - p_least;
    if (along < result.depth) result.depth = along, result.normal = n;
    if (against < result.depth) result.depth = against, result.normal = n * -1.0;
  };
  try_normal(face_normal(p));
  try_normal(face_normal(q));
  if (!(result.depth < std::numeric_limits<double>::infinity())) result.depth = 0, result.normal = {0, 0, 1};
  result.depth = std::max(result.depth, 0.0);
  return result;
}

}  // namespace difi
