// SPDX-License-Identifier: Apache-2.0
// Two triangles intersect if and only if an edge of one intersects the other. An edge intersects a triangle if its ends
// are not on the same side of the triangle's plane and the line through it passes all three edges on the same side. The
// signs of determinants decide this exactly. Edges in the triangle's plane are decided in the plane (predicates.h).
#include "geometry/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "geometry/closest_pair.h"
#include "geometry/overlap_penetration.h"

namespace standoff {
namespace {

// `from` and `to`: the sides of t's plane that p and q lie on.
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

// The intersection of two triangles is convex. Its corners are corners of one that lie in the other, points where an
// edge of one passes through the other, and crossings of edges in one plane. Exact signs of determinants decide which
// of them exist; ratios of determinants, which are accurate however small they are, give their positions.

namespace {

// Six times the volume that a point spans with a triangle; exactly 0 for the triangle's own corners.
double height_over(const Corners& t, const Vec3& at) {
  if (at == t[0] || at == t[1] || at == t[2]) return 0;
  return determinant3d(t[0], t[1], t[2], at);
}

struct Heights {
  double of[3];
  Heights(const Corners& corners, const Corners& over)
      : of{height_over(over, corners[0]), height_over(over, corners[1]), height_over(over, corners[2])} {}
};

// Whether the triangle has corners on both sides of the other one's plane; common corners are on it.
bool on_both_sides(const Corners& corners, const Corners& of) {
  bool above = false, below = false;
  for (const Vec3& at : corners) {
    if (at == of[0] || at == of[1] || at == of[2]) continue;
    const int side = orient3d(of[0], of[1], of[2], at);
    above = above || side > 0, below = below || side < 0;
  }
  return above && below;
}

// The point between a and b where a linear function is zero that is `from` at a and `to`, of the other sign, at b.
Vec3 zero_between(const Vec3& a, const Vec3& b, double from, double to) { return a + (b - a) * (from / (from - to)); }

// Keeps the two points that are farthest from each other: the middle between two points of a convex set lies in it.
class Farthest {
 public:
  void add(const Vec3& point) {
    for (int n = 0; n < count_; ++n) {
      const Vec3 offset = point - points_[n];
      if (const double apart_sq = dot(offset, offset); apart_sq > most_sq_) {
        most_sq_ = apart_sq;
        middle_ = points_[n] + offset * 0.5;
      }
    }
    if (count_ == 0) middle_ = point;
    if (count_ < kMost) points_[count_++] = point;
  }
  bool any() const { return count_ > 0; }
  Vec3 middle() const { return middle_; }

 private:
  static constexpr int kMost = 6 + 6 + 9;  // corners, edges through faces, crossings of edges
  Vec3 points_[kMost], middle_;
  int count_ = 0;
  double most_sq_ = 0;
};

void add_corners_inside(const Corners& corners, const Heights& heights, const Corners& t, Farthest& shared) {
  for (int k = 0; k < 3; ++k)
    if (heights.of[k] == 0 && intersects_in_plane(corners[k], corners[k], t)) shared.add(corners[k]);
}

// Adds the points where edges pass through the triangle.
void add_passes(const Corners& corners, const Heights& heights, const Corners& t, Farthest& shared) {
  for (int k = 0, j = 2; k < 3; j = k++) {
    const double from = heights.of[j], to = heights.of[k];
    if (!((from < 0 && to > 0) || (from > 0 && to < 0))) continue;
    const Vec3 &a = corners[j], &b = corners[k];
    const int side[3] = {orient3d(a, b, t[0], t[1]), orient3d(a, b, t[1], t[2]), orient3d(a, b, t[2], t[0])};
    if (std::min({side[0], side[1], side[2]}) >= 0 || std::max({side[0], side[1], side[2]}) <= 0)
      shared.add(zero_between(a, b, from, to));
  }
}

void add_crossing(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, Farthest& shared) {
  const int axis = orient3d(p, q, a, b) == 0 ? upright_axis(p, q, a, b) : -1;
  if (axis < 0) return;
  const Flat c = dropped(a, axis), d = dropped(b, axis), u = dropped(p, axis), v = dropped(q, axis);
  if (orient2d(u, v, c) * orient2d(u, v, d) >= 0 || orient2d(c, d, u) * orient2d(c, d, v) >= 0) return;
  shared.add(zero_between(p, q, determinant2d(c, d, u), determinant2d(c, d, v)));
}

bool is_zero(const Vec3& v) { return v == Vec3{}; }

// The shortest translation, of all directions tried, that separates both triangles. It uses their measured extents
// along a direction: no triangle is taken to be flat.
class MinimumTranslation {
 public:
  MinimumTranslation(const Corners& p, const Corners& q) : p_(p), q_(q) {}
  void try_along(const Vec3& direction) {
    const double most = max_norm(direction);
    if (!(most > 0)) return;
    const Vec3 scaled = direction * (1 / most), n = scaled * (1 / length(scaled));
    const Reach p = reach(p_, n), q = reach(q_, n);
    keep_shallower(n, p.most - q.least);
    keep_shallower(n * -1.0, q.most - p.least);
  }
  bool any() const { return depth_ < std::numeric_limits<double>::infinity(); }
  Vec3 normal() const { return normal_; }
  double depth() const { return std::max(depth_, 0.0); }

 private:
  struct Reach {
    double least, most;
  };
  Reach reach(const Corners& t, const Vec3& n) const {
    const double at[3] = {dot(n, t[0] - p_[0]), dot(n, t[1] - p_[0]), dot(n, t[2] - p_[0])};
    return {std::min({at[0], at[1], at[2]}), std::max({at[0], at[1], at[2]})};
  }
  void keep_shallower(const Vec3& n, double depth) {
    if (depth < depth_) depth_ = depth, normal_ = n;
  }

  const Corners &p_, &q_;
  Vec3 normal_{0, 0, 1};
  double depth_ = std::numeric_limits<double>::infinity();
};

Vec3 longest_edge(const Corners& t) {
  const Vec3 edges[3] = {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
  return *std::max_element(edges, edges + 3, [](const Vec3& a, const Vec3& b) { return dot(a, a) < dot(b, b); });
}

// A direction perpendicular to another one; any direction if that is zero.
Vec3 across(const Vec3& v) {
  const Vec3 size{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
  const Vec3 least = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                     : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                          : Vec3{0, 0, 1};
  const Vec3 result = cross(v, least);
  return is_zero(result) ? least : result;
}

// Finds the answer in double; false if rounding may spoil it.
bool take_accurate(const Corners& p, const Corners& q, Penetration& result) {
  const Triple<double> of_p[3] = {triple_of(p[0]), triple_of(p[1]), triple_of(p[2])},
                       of_q[3] = {triple_of(q[0]), triple_of(q[1]), triple_of(q[2])};
  const auto overlap = triangle_overlap(of_p, of_q);
  if (!overlap.intersecting) return false;
  const auto found = penetration(overlap, of_p, of_q);
  result = {vec_of(found.point), vec_of(found.normal), found.depth};
  return found.accurate;
}

}  // namespace

Vec3 common_point(const Corners& p, const Corners& q) {
  // Neighbours of one mesh, and bodies with the same pose, share a corner: if they do not cross, it is the point.
  if (const Vec3* const corner = common_corner(p, q); corner && !(on_both_sides(p, q) && on_both_sides(q, p)))
    return *corner;
  const Heights of_p(p, q), of_q(q, p);
  Farthest shared;
  add_corners_inside(p, of_p, q, shared);
  add_corners_inside(q, of_q, p, shared);
  add_passes(p, of_p, q, shared);
  add_passes(q, of_q, p, shared);
  for (int k = 0, j = 2; k < 3; j = k++)
    for (int n = 0, m = 2; n < 3; m = n++) add_crossing(p[j], p[k], q[m], q[n], shared);
  if (shared.any()) return shared.middle();
  const ClosestPair pair = closest_points(p, q);
  return pair.on_p + pair.separation * 0.5;
}

Penetration penetration(const Corners& p, const Corners& q) {
  // Common corners are on both planes, where the quick test cannot decide.
  if (Penetration quick; !common_corner(p, q) && take_accurate(p, q, quick)) return quick;
  MinimumTranslation translation(p, q);
  translation.try_along(normal_direction(p));
  translation.try_along(normal_direction(q));
  if (!translation.any()) {  // segments and points: try the direction across both, or across the one that is no point
    const Vec3 along_p = longest_edge(p), along_q = longest_edge(q);
    translation.try_along(cross(along_p, along_q));
    if (!(translation.depth() == 0)) translation.try_along(across(is_zero(along_p) ? along_q : along_p));
  }
  return {common_point(p, q), translation.normal(), translation.depth()};
}

namespace {

// If a slab is thinner than this share of the triangles' distance, rounding has turned its direction.
constexpr double kTurned = 0.5;

Slab slab_along(const Corners& p, const Corners& q, const Vec3& normal) {
  double top = 0;
  for (const Vec3& corner : p) top = std::max(top, dot(normal, corner - p[0]));
  Slab slab{normal, {}, std::numeric_limits<double>::infinity()};
  for (int k = 0; k < 3; ++k) {
    slab.height[k] = dot(normal, q[k] - p[0]) - top;
    slab.thickness = std::min(slab.thickness, slab.height[k]);
  }
  return slab;
}

class Thickest {
 public:
  Thickest(const Corners& p, const Corners& q, const Slab& first) : p_(p), q_(q), best_(first) {}

  /// Tries the slab along a direction; its normal points to the side of `separation`, from p to q.
  void try_along(const Vec3& direction, const Vec3& separation) {
    const double size = length(direction);
    if (!(size > 0)) return;
    const Slab slab = slab_along(p_, q_, direction * ((dot(direction, separation) < 0 ? -1 : 1) / size));
    if (slab.thickness > best_.thickness) best_ = slab;
  }
  const Slab& best() const { return best_; }

 private:
  const Corners &p_, &q_;
  Slab best_;
};

}  // namespace

Slab slab_between(const Corners& p, const Corners& q, const ClosestPair& closest) {
  const double apart = std::sqrt(closest.distance_sq);
  const Slab slab = slab_along(p, q, apart > 0 ? closest.separation * (1 / apart) : Vec3{});
  if (slab.thickness > kTurned * apart) return slab;
  Thickest thickest(p, q, slab);
  const Vec3& separation = closest.separation;
  const auto edge = [](const Corners& t, int k) { return t[(k + 1) % 3] - t[k]; };
  for (const Corners* t : {&p, &q}) {
    thickest.try_along(normal_direction(*t), separation);
    for (int k = 0; k < 3; ++k) thickest.try_along(cross(edge(*t, k), cross(separation, edge(*t, k))), separation);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) thickest.try_along(cross(edge(p, i), edge(q, j)), separation);
  return thickest.best();
}

}  // namespace standoff
