// SPDX-License-Identifier: Apache-2.0
// Have two triangles a point in common? Exactly, and whatever they are: segments and points too. standoff decides it by
// the sides of planes on which corners lie; this asks for an axis on which shadows are apart. Two convex sets of
// corners are apart where the origin is outside the set of their differences, and that set has few facets: their
// normals are cross products of edges where it is solid, perpendicular to edges and within its plane where it is flat.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "geometry/triangle_pair.h"
#include "tests/collision/independent.h"
#include "tests/collision/zoo/integers.h"

namespace standoff::testing {

template <class T>
bool is_zero(const Triple<T>& v) {
  return v[0].zero() && v[1].zero() && v[2].zero();
}

/// The shadows of both have no point in common.
template <class Axis, class Coordinate>
bool shadows_apart(const Triple<Axis>& axis, std::span<const Triple<Coordinate>> p,
                   std::span<const Triple<Coordinate>> q, bool* flat = nullptr) {
  using Length = decltype(axis[0] * p[0][0]);
  const auto at = [&axis](const Triple<Coordinate>& v) { return axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]; };
  const auto extent = [&](std::span<const Triple<Coordinate>> points) {
    Shadow<Length> it{at(points[0]), at(points[0])};
    for (const Triple<Coordinate>& v : points.subspan(1)) {
      const Length here = at(v);
      if (here < it.low) it.low = here;
      if (it.high < here) it.high = here;
    }
    return it;
  };
  const auto s = extent(p), t = extent(q);
  if (flat) *flat = s.low == s.high && t.low == t.high && s.low == t.low;
  return s.high < t.low || t.high < s.low;
}

template <class T>
auto cross_of(const Triple<T>& a, const auto& b) {
  using Product = decltype(a[0] * b[0]);
  return Triple<Product>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Two convex sets have no point in common. `p_edges` and `q_edges` are the directions of their edges, each with those
/// of all its faces.
template <class T>
bool apart_exactly(std::span<const Triple<T>> p, std::span<const Triple<T>> q, std::span<const Triple<T>> p_edges,
                   std::span<const Triple<T>> q_edges) {
  std::array<Triple<T>, 8> edges;
  std::copy(q_edges.begin(), q_edges.end(), std::copy(p_edges.begin(), p_edges.end(), edges.begin()));
  const std::size_t count = p_edges.size() + q_edges.size();
  bool any_axis = false;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j) {
      const auto axis = cross_of(edges[i], edges[j]);
      if (is_zero(axis)) continue;
      bool flat = false;
      if (shadows_apart(axis, p, q, &flat)) return true;
      any_axis = true;
      if (!flat) continue;
      // All in one plane: the sides of their difference in it.
      for (std::size_t k = 0; k < count; ++k) {
        const auto in_plane = cross_of(axis, edges[k]);
        if (!is_zero(in_plane) && shadows_apart(in_plane, p, q)) return true;
      }
      return false;
    }
  if (any_axis) return false;
  // All edges have one direction, or none a length.
  const Triple<T> separation = p[0] - q[0];
  for (std::size_t k = 0; k < count; ++k) {
    if (is_zero(edges[k])) continue;
    return !is_zero(cross_of(separation, edges[k])) || shadows_apart(edges[k], p, q);
  }
  return !is_zero(separation);
}

template <int kLimbs>
bool touch_in_integers(const Corners& p, const Corners& q, int exponent) {
  using Number = Integer<kLimbs>;
  const auto whole = [exponent](const Corners& t) {
    ThreeCorners<Number> w;
    for (int k = 0; k < 3; ++k)
      w[k] = {integer_of<kLimbs>(t[k].x, exponent), integer_of<kLimbs>(t[k].y, exponent),
              integer_of<kLimbs>(t[k].z, exponent)};
    return w;
  };
  const auto a = whole(p), b = whole(q);
  const ThreeCorners<Number> e{a[1] - a[0], a[2] - a[1], a[0] - a[2]}, f{b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  return !apart_exactly<Number>(a, b, e, f);
}

/// What whole numbers it takes to hold some points: multiples of 2^lowest below 2^highest.
struct BitRange {
  int lowest = 1 << 20, highest = -(1 << 20);
  void include(const Vec3& v) {
    for (const double x : {v.x, v.y, v.z}) {
      if (x == 0) continue;
      lowest = std::min(lowest, lowest_bit(x));
      highest = std::max(highest, std::ilogb(x) + 1);
    }
  }
  /// Coordinates below 2^b make edges below 2^(b + 1), cross products below 2^(2b + 3), those with an edge again below
  /// 2^(3b + 5), and shadows below 2^(4b + 8): four bits of each limb are for them.
  bool fits(int limbs) const { return highest - lowest <= 64 * limbs - 4; }
};

/// The same as touch(), always in whole numbers.
inline bool touch_without_filter(const Corners& p, const Corners& q) {
  BitRange range;
  for (const Corners* t : {&p, &q})
    for (const Vec3& v : *t) range.include(v);
  if (range.fits(1)) return touch_in_integers<1>(p, q, range.lowest);
  if (range.fits(2)) return touch_in_integers<2>(p, q, range.lowest);
  if (range.fits(4)) return touch_in_integers<4>(p, q, range.lowest);
  return touch_in_integers<20>(p, q, range.lowest);  // from 2^-1074 to 1e15
}

enum class Sure { apart, touching, no };

/// Decided in double where its rounding cannot hide the answer.
inline Sure touch_in_doubles(const Corners& p, const Corners& q) {
  double most = 0;
  const auto a = seen_from<double>(q[0], p), b = seen_from<double>(q[0], q);
  for (const auto* t : {&a, &b})
    for (const auto& v : *t)
      for (const double x : v) most = std::max(most, std::abs(x));
  // Corners are off by u most, u = epsilon / 2, edges (up to 2 most) by 4 u most, axes (8 most^2) by 48 u most^2, and
  // shadows (24 most^3) by 240 u most^3; the gap between two by 528 u most^3.
  const double off = 1024 * (std::numeric_limits<double>::epsilon() / 2) * most * most * most;
  if (!(off > 1e-280)) return Sure::no;
  bool sure = true;
  const bool apart = any_axis(a, b, false, [&](const Triple<double>& axis) {
    const auto s = shadow(axis, a), t = shadow(axis, b);
    const double gap = std::max(t.low - s.high, s.low - t.high);
    sure = sure && gap < -off;
    return gap > off;
  });
  // A flat difference is never sure to touch: along the normal of its plane the gap is none.
  return apart ? Sure::apart : sure ? Sure::touching : Sure::no;
}

/// The triangles have a point in common. Segments and points are triangles.
inline bool touch(const Corners& p, const Corners& q) {
  const Sure sure = touch_in_doubles(p, q);
  return sure == Sure::no ? touch_without_filter(p, q) : sure == Sure::touching;
}

}  // namespace standoff::testing
