// SPDX-License-Identifier: Apache-2.0
#include "geometry/predicates.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace standoff {
namespace {

// If a determinant is this many times larger than its error, its relative error is below 4e-15.
constexpr double kTellsValue = 0x1p48;

using Parts = std::array<double, Expansion::kMostParts>;

double value_of_determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double beyond) {
  return value_of_determinant(
      rounded_determinant3d(a, b, c, d), kRounded3d, beyond, [&] { return are_level(a, b, c, d); },
      [&] { return twofold_determinant3d(a, b, c, d); },
      [&] {
        Parts parts;
        return determinant3d_exactly(a, b, c, d, parts.data());
      });
}
double value_of_determinant2d(const Flat& a, const Flat& b, const Flat& c, double beyond) {
  return value_of_determinant(
      rounded_determinant2d(a, b, c), kRounded2d, beyond, [&] { return are_level(a, b, c); },
      [&] { return twofold_determinant2d(a, b, c); },
      [&] {
        Parts parts;
        return determinant2d_exactly(a, b, c, parts.data());
      });
}

}  // namespace

int orient3d_beyond_rounding(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return sign_of(value_of_determinant3d(a, b, c, d, 1));
}
double determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return value_of_determinant3d(a, b, c, d, kTellsValue);
}

int orient2d_beyond_rounding(const Flat& a, const Flat& b, const Flat& c) {
  return sign_of(value_of_determinant2d(a, b, c, 1));
}
double determinant2d(const Flat& a, const Flat& b, const Flat& c) {
  return value_of_determinant2d(a, b, c, kTellsValue);
}

namespace {

bool between(double v, double a, double b) { return (a <= v && v <= b) || (b <= v && v <= a); }
bool in_box(const Flat& p, const Flat& a, const Flat& b) { return between(p.x, a.x, b.x) && between(p.y, a.y, b.y); }

bool segments_intersect(const Flat& p, const Flat& q, const Flat& a, const Flat& b) {
  const int pa = orient2d(p, q, a), pb = orient2d(p, q, b), ap = orient2d(a, b, p), aq = orient2d(a, b, q);
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && in_box(a, p, q)) || (pb == 0 && in_box(b, p, q)) || (ap == 0 && in_box(p, a, b)) ||
         (aq == 0 && in_box(q, a, b));
}

bool extents_overlap(double p, double q, double a, double b) {
  return std::max(std::min(p, q), std::min(a, b)) <= std::min(std::max(p, q), std::max(a, b));
}

bool in_triangle(const Flat& p, const Flat& a, const Flat& b, const Flat& c) {
  const int ab = orient2d(a, b, p), bc = orient2d(b, c, p), ca = orient2d(c, a, p);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

}  // namespace

int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (orient2d(dropped(a, axis), dropped(b, axis), dropped(c, axis)) != 0) return axis;
  return -1;
}

int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  int axis = upright_axis(a, b, c);
  if (axis < 0) axis = upright_axis(a, b, d);
  if (axis < 0) axis = upright_axis(c, d, a);
  if (axis < 0) axis = upright_axis(c, d, b);
  return axis;
}

bool segments_intersect(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  if (orient3d(p, q, a, b) != 0) return false;
  const int axis = upright_axis(p, q, a, b);
  if (axis >= 0) return segments_intersect(dropped(p, axis), dropped(q, axis), dropped(a, axis), dropped(b, axis));
  return extents_overlap(p.x, q.x, a.x, b.x) && extents_overlap(p.y, q.y, a.y, b.y) &&
         extents_overlap(p.z, q.z, a.z, b.z);
}

bool intersects_in_plane(const Vec3& p, const Vec3& q, const Corners& t) {
  const int axis = upright_axis(t[0], t[1], t[2]);
  if (axis < 0)
    return segments_intersect(p, q, t[0], t[1]) || segments_intersect(p, q, t[1], t[2]) ||
           segments_intersect(p, q, t[2], t[0]);
  const Flat a = dropped(t[0], axis), b = dropped(t[1], axis), c = dropped(t[2], axis);
  const Flat u = dropped(p, axis), v = dropped(q, axis);
  return in_triangle(u, a, b, c) || in_triangle(v, a, b, c) || segments_intersect(u, v, a, b) ||
         segments_intersect(u, v, b, c) || segments_intersect(u, v, c, a);
}

}  // namespace standoff
