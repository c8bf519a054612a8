// SPDX-License-Identifier: Apache-2.0
// Let L be the line in which the planes of triangles p and q meet. If p is on one closed side of q's plane, then L
// passes no point of p's interior, so q does not cut p. If p is on both sides, L passes through p's interior, and q
// cuts p if q's part of L is there. That part is
// - a corner or an edge of q, if q is on one closed side of p's plane: all its ends are corners, and exact signs in the
//   plane of p decide,
// - else a segment with an inner point of q. Then both cut each other or none does, but for ends that touch: those
//   count as a cut.
#include "sign/outer/triangle_cut.h"

#include <array>

#include "geometry/predicates.h"
#include "geometry/triangle_pair.h"

namespace standoff {
namespace {

// Whether the line through a and b has p on one closed side and all of q on the other one. a and b are of p's border.
template <class Points>
bool line_separates(const Flat& a, const Flat& b, const Flat& third, const Points& q) {
  const int own = orient2d(a, b, third);
  for (const Flat& point : q)
    if (orient2d(a, b, point) * own > 0) return false;
  return true;
}

template <class Points>
bool edge_separates(const FlatCorners& p, const Points& q) {
  for (std::size_t n = 0; n < 3; ++n)
    if (line_separates(p[n], p[(n + 1) % 3], p[(n + 2) % 3], q)) return true;
  return false;
}

// Whether the segment, which may be a point and lies in the triangle's plane, has points in its interior. The line that
// separates them else is one along an edge or along the segment.
bool is_in_interior(const Vec3& from, const Vec3& to, const Corners& t) {
  const int axis = upright_axis(t[0], t[1], t[2]);
  const FlatCorners p = dropped(t, axis);
  const std::array<Flat, 2> ends{dropped(from, axis), dropped(to, axis)};
  if (edge_separates(p, ends)) return false;
  if (from == to) return true;
  bool left = false, right = false;
  for (const Flat& corner : p) {
    const int side = orient2d(ends[0], ends[1], corner);
    left = left || side > 0;
    right = right || side < 0;
  }
  return left && right;
}

struct CornerSides {
  std::array<int, 3> of;
  int above = 0, below = 0;

  CornerSides(const Corners& plane, const Corners& t) {
    for (std::size_t n = 0; n < 3; ++n) {
      // Neighbours have corners in common, which would take the exact stage.
      const bool common = t[n] == plane[0] || t[n] == plane[1] || t[n] == plane[2];
      of[n] = common ? 0 : orient3d(plane[0], plane[1], plane[2], t[n]);
      above += of[n] > 0;
      below += of[n] < 0;
    }
  }
  bool both() const { return above > 0 && below > 0; }
  int zero() const { return 3 - above - below; }
};

// Whether q, on one closed side of p's plane, has a corner or an edge in p's interior.
bool touches_interior(const Corners& p, const Corners& q, const CornerSides& q_sides) {
  const Vec3 *from = nullptr, *to = nullptr;
  for (std::size_t n = 0; n < 3; ++n)
    if (q_sides.of[n] == 0) (from ? to : from) = &q[n];
  return from && is_in_interior(*from, to ? *to : *from, p);
}

// Triangles that both pass through the other's plane. They cannot share an edge; if they share a corner, then L begins
// there, and their parts of it have more in common if an edge across reaches the other triangle.
bool pass_through_each_other(const Corners& p, const Corners& q) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (p[i] == q[j]) {
        const Vec3 &a = p[(i + 1) % 3], &b = p[(i + 2) % 3], &c = q[(j + 1) % 3], &d = q[(j + 2) % 3];
        return triangles_intersect({a, b, b}, q) || triangles_intersect({c, d, d}, p);
      }
  return triangles_intersect(p, q);
}

}  // namespace

Cuts cuts_between(const Corners& first, const Corners& second) {
  const CornerSides second_sides(first, second);
  if (!second_sides.both() && second_sides.zero() == 0) return {};
  const CornerSides first_sides(second, first);
  if (first_sides.both() && second_sides.both()) {
    const bool cut = pass_through_each_other(first, second);
    return {cut, cut};
  }
  return {first_sides.both() && touches_interior(first, second, second_sides),
          second_sides.both() && touches_interior(second, first, first_sides)};
}

}  // namespace standoff
