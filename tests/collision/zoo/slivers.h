// SPDX-License-Identifier: Apache-2.0
// Slivers that touch or nearly touch others by construction. The lengths are about 1/2, the heights `ratio` of them.
#pragma once

#include <cmath>
#include <numbers>

#include "tests/collision/bodies.h"

namespace standoff::testing {

/// A number from `low` to `high`, each power of two in between as likely as the others.
inline double log_between(Random& random, double low, double high) {
  return low * std::exp(random.between(0, 1) * std::log(high / low));
}

inline Vec3 direction(Random& random) {
  for (;;) {
    const Vec3 v = random.in_cube(1);
    if (const double size = length(v); size > 0.1 && size <= 1) return v * (1 / size);
  }
}

/// A triangle as its middle point, and corners seen from there.
struct Shape {
  Corners corners;
  Corners at(Vec3 place) const { return {corners[0] + place, corners[1] + place, corners[2] + place}; }
};

/// How slivers are thin.
enum class Thin {
  any_way,  ///< heights are as exact as the rounding of the corners leaves them
  along_z,  ///< near z = 0, where heights of 1e-300 would be exact
};

/// A triangle whose height is `ratio` of its length: the third corner over the middle of the long edge, or near one of
/// its ends, seen from a point of it that is chosen at random: inside, on an edge, or a corner.
inline Shape sliver(Random& random, double ratio, Thin thin) {
  Vec3 u = direction(random), v = cross(u, direction(random));
  if (thin == Thin::along_z) {
    const double angle = random.between(0, 2 * std::numbers::pi);
    u = {std::cos(angle), std::sin(angle), random.below(2) ? 0 : ratio * random.between(-1, 1)}, v = {0, 0, 1};
  }
  const double size = random.between(0.25, 0.6), rise = ratio * size / length(v);
  const double foot = random.below(3) ? random.between(0.1, 0.9) : ratio * random.between(-1, 1);
  const Vec3 a{}, b = u * size, c = u * (size * foot) + v * rise;
  double s = random.between(0.05, 0.9), t = random.between(0.02, 0.98) * (1 - s);
  switch (random.below(8)) {
    case 0:
      t = 0;
      break;
    case 1:
      s = 0;
      break;
    case 2:
      s = t = 0;
      break;
    case 3:
      s = 0.5, t = 0;
      break;
    default:
      break;
  }
  const Vec3 middle = b * s + c * t;
  const Corners corners{a - middle, b - middle, c - middle};
  const std::uint32_t first = random.below(3);  // corners in any order
  return {{corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]}};
}

/// Two triangles, at least one of them a sliver.
struct SliverPair {
  Corners p, q;
};

/// How the second one comes to its place.
enum class TriangleOverlap {
  touching,  ///< a point of it falls on a point of the first one, but for rounding
  near,      ///< beside such a place, by 1e-17 to 0.1
  anywhere,  ///< about as far as they are long
};

inline SliverPair sliver_pair(Random& random, double ratio, Thin thin, TriangleOverlap meeting) {
  const Shape p = sliver(random, ratio, thin);
  // Every other partner is a sliver too, of the same height or another one; some lie nearly in the plane of the first.
  const std::uint32_t kind = random.below(8);
  Shape q = sliver(random, kind < 3 ? ratio : kind < 5 ? log_between(random, 1e-15, 1) : 1, thin);
  if (kind == 3) {
    // Corners moved along the first one's edges, which lie in its plane and almost along it.
    for (Vec3& v : q.corners)
      v = (p.corners[1] - p.corners[0]) * random.between(-1, 1) + (p.corners[2] - p.corners[0]) * random.between(-1, 1);
  }
  Vec3 by{};
  if (meeting == TriangleOverlap::near) by = direction(random) * log_between(random, 1e-17, 0.1);
  if (meeting == TriangleOverlap::anywhere) by = random.in_cube(0.4);
  return {p.at({}), q.at(by)};
}

/// Pairs in cells of a lattice, one body of the first ones, one of the second ones.
struct SliverBodies {
  Mesh a, b;
};

inline SliverBodies sliver_bodies(unsigned seed, double ratio, int count) {
  Random random(seed);
  const Thin thin = random.below(2) ? Thin::along_z : Thin::any_way;
  // Slivers thin along z keep near z = 0: their lattice is flat.
  const int along = static_cast<int>(thin == Thin::along_z ? std::ceil(std::sqrt(count)) : std::ceil(std::cbrt(count)));
  SliverBodies bodies;
  for (int n = 0; n < count; ++n) {
    const auto meeting = static_cast<TriangleOverlap>(random.below(3));
    const SliverPair pair = sliver_pair(random, ratio, thin, meeting);
    const double x = n % along - along / 2, y = n / along % along - along / 2,
                 z = thin == Thin::along_z ? 0 : n / along / along - along / 2;
    const Vec3 at{x, y, z};
    add_triangle(bodies.a, pair.p[0] + at, pair.p[1] + at, pair.p[2] + at);
    add_triangle(bodies.b, pair.q[0] + at, pair.q[1] + at, pair.q[2] + at);
  }
  return bodies;
}

}  // namespace standoff::testing
