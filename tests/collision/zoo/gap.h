// SPDX-License-Identifier: Apache-2.0
// How far apart are two triangles, whatever they are? In 113 bits, where differences of doubles and their products are
// exact as long as they are of like size: the normal of a sliver comes out as it is. Squares are off by less than
// 1e-17 of the corners' distances from each other, squared; roots are rounded to double.
#pragma once

#include "tests/collision/zoo/touch.h"

namespace standoff::testing {

#if defined(__SIZEOF_FLOAT128__)
__extension__ using Quad = __float128;
#else
using Quad = long double;  // 113 bits where there is no other name for them
static_assert(std::numeric_limits<long double>::digits >= 113);
#endif

using QuadPoint = Triple<Quad>;

inline QuadPoint quad_from(const Vec3& at, const Vec3& v) {
  return {Quad(v.x) - Quad(at.x), Quad(v.y) - Quad(at.y), Quad(v.z) - Quad(at.z)};
}

inline double root_of(Quad square) { return static_cast<double>(std::sqrt(static_cast<long double>(square))); }

inline QuadPoint along(const QuadPoint& from, const QuadPoint& step, Quad t) {
  return {from[0] + step[0] * t, from[1] + step[1] * t, from[2] + step[2] * t};
}
inline Quad squared(const QuadPoint& v) { return dotted(v, v); }

inline Quad point_segment_sq(const QuadPoint& x, const QuadPoint& from, const QuadPoint& to) {
  const QuadPoint step = to - from, separation = x - from;
  const Quad all = squared(step), here = dotted(separation, step);
  if (!(here > 0)) return squared(separation);
  if (!(here < all)) return squared(x - to);
  return squared(x - along(from, step, here / all));
}

/// Of a point that is above or below a triangle from its plane; infinite where it is not above it, or there is no
/// plane.
inline Quad point_face_sq(const QuadPoint& x, const std::array<QuadPoint, 3>& t) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const QuadPoint n = crossed(t[1] - t[0], t[2] - t[0]);
  const Quad size = squared(n);
  if (!(size > 0)) return kInfinity;
  for (int k = 0; k < 3; ++k)
    if (dotted(crossed(t[(k + 1) % 3] - t[k], x - t[k]), n) < 0) return kInfinity;
  const Quad off = dotted(x - t[0], n);
  return off * off / size;
}

inline Quad segments_sq(const QuadPoint& u, const QuadPoint& v, const QuadPoint& x, const QuadPoint& y) {
  // The lines' closest points. Of lines that are parallel but for 1e-16 even these 113 bits leave the place uncertain,
  // so it is kept within one segment, and the other's place is the best for it: what is measured are points of both.
  const QuadPoint d = v - u, e = y - x, r = u - x;
  const Quad dd = squared(d), ee = squared(e), de = dotted(d, e), det = dd * ee - de * de;
  if (!(det > 0)) return std::numeric_limits<double>::infinity();
  const Quad s = (de * dotted(e, r) - ee * dotted(d, r)) / det;
  return point_segment_sq(along(u, d, std::clamp(s, Quad(0), Quad(1))), x, y);
}

/// The square of the distance of a point of space from a triangle.
inline Quad point_triangle_sq(const Vec3& point, const Corners& triangle) {
  const std::array<QuadPoint, 3> t{quad_from(point, triangle[0]), quad_from(point, triangle[1]),
                                   quad_from(point, triangle[2])};
  const QuadPoint x{};
  Quad least = point_face_sq(x, t);
  for (int k = 0; k < 3; ++k) least = std::min(least, point_segment_sq(x, t[k], t[(k + 1) % 3]));
  return least;
}

/// The square of the distance of triangles that do not cross.
inline Quad gap_of_free_sq(const Corners& p, const Corners& q) {
  std::array<QuadPoint, 3> a, b;
  for (int k = 0; k < 3; ++k) a[k] = quad_from(q[0], p[k]), b[k] = quad_from(q[0], q[k]);
  Quad least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    least = std::min({least, point_face_sq(a[i], b), point_face_sq(b[i], a)});
    for (int j = 0; j < 3; ++j) {
      const int i_next = (i + 1) % 3, j_next = (j + 1) % 3;
      least = std::min({least, point_segment_sq(a[i], b[j], b[j_next]), point_segment_sq(b[j], a[i], a[i_next]),
                        segments_sq(a[i], a[i_next], b[j], b[j_next])});
    }
  }
  return least;
}

/// The distance of two triangles, 0 where they touch.
inline double gap(const Corners& p, const Corners& q) { return touch(p, q) ? 0 : root_of(gap_of_free_sq(p, q)); }

}  // namespace standoff::testing
