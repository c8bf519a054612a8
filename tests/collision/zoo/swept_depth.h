// SPDX-License-Identifier: Apache-2.0
// How deep a triangle that goes straight goes into one that rests: exactly, by the solid that it passes through.
#pragma once

#include "tests/collision/zoo/touch.h"

namespace standoff::testing {

/// The least overlap of the shadows of two convex sets, over all axes on which they could be apart: how far one has to
/// move to be out of the other; minus a lower bound of their distance where they are apart. 0 where the set of their
/// differences is flat.
template <class T>
double depth_exactly(std::span<const Triple<T>> p, std::span<const Triple<T>> q, std::span<const Triple<T>> edges) {
  long double least = std::numeric_limits<long double>::infinity();
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const auto axis = cross_of(edges[i], edges[j]);
      if (is_zero(axis)) continue;
      using Length = decltype(axis[0] * p[0][0]);
      const auto extent = [&axis](std::span<const Triple<T>> points) {
        Shadow<Length> it{};
        for (std::size_t n = 0; n < points.size(); ++n) {
          const Length at = axis[0] * points[n][0] + axis[1] * points[n][1] + axis[2] * points[n][2];
          if (n == 0 || at < it.low) it.low = at;
          if (n == 0 || it.high < at) it.high = at;
        }
        return it;
      };
      const auto s = extent(p), t = extent(q);
      const Length up = s.high - t.low, down = t.high - s.low;
      long double size_sq = 0;
      for (const auto& x : axis) size_sq += float_of<long double>(x) * float_of<long double>(x);
      least = std::min(least, float_of<long double>(down < up ? down : up) / std::sqrt(size_sq));
    }
  return least < std::numeric_limits<long double>::infinity() ? static_cast<double>(least) : 0;
}

/// Of a triangle translated into one that rests, in their units.
template <int kLimbs>
double swept_depth(const Corners& moving, const Vec3& translation, const Corners& resting, int exponent) {
  using Number = Integer<kLimbs>;
  const auto whole = [exponent](const Vec3& v) {
    return Triple<Number>{integer_of<kLimbs>(v.x, exponent), integer_of<kLimbs>(v.y, exponent),
                          integer_of<kLimbs>(v.z, exponent)};
  };
  std::array<Triple<Number>, 6> prism;
  std::array<Triple<Number>, 3> t;
  const Triple<Number> v = whole(translation);
  for (int k = 0; k < 3; ++k) {
    prism[k] = whole(moving[k]), t[k] = whole(resting[k]);
    prism[k + 3] = {prism[k][0] + v[0], prism[k][1] + v[1], prism[k][2] + v[2]};
  }
  const Triple<Number> edges[] = {v,           prism[1] - prism[0], prism[2] - prism[1], prism[0] - prism[2],
                                  t[1] - t[0], t[2] - t[1],         t[0] - t[2]};
  return std::ldexp(depth_exactly<Number>(prism, t, edges), exponent);
}

inline double swept_depth(const Corners& moving, const Vec3& translation, const Corners& resting) {
  BitRange range;
  for (const Corners* t : {&moving, &resting})
    for (const Vec3& v : *t) range.include(v);
  range.include(translation);
  ++range.highest;  // a translated corner is a sum
  if (range.fits(1)) return swept_depth<1>(moving, translation, resting, range.lowest);
  if (range.fits(2)) return swept_depth<2>(moving, translation, resting, range.lowest);
  if (range.fits(4)) return swept_depth<4>(moving, translation, resting, range.lowest);
  return swept_depth<20>(moving, translation, resting, range.lowest);
}

}  // namespace standoff::testing
