// SPDX-License-Identifier: Apache-2.0
// How far an answer may be off, in one place, as docs/collision.md promises it. u is half the epsilon of double.
#pragma once

#include "tests/collision/zoo/truth.h"

namespace standoff::testing {

inline constexpr double kRoundoff = 0x1p-53;  // u

inline double longest(const Box& box) {
  const Vec3 e = box.extent();
  return std::max({e.x, e.y, e.z});
}
inline double farthest(const Box& box) {
  double most = 0;
  for (const Vec3& v : {box.min, box.max}) most = std::max({most, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return most;
}

/// What is allowed depends on the longest side of the box around the triangles, or bodies, that an answer is about, and
/// where it is a place in the world also on their farthest coordinate: no double is nearer to it.
struct Allowed {
  double extent, coordinate;

  explicit Allowed(const Box& box) : extent(longest(box)), coordinate(farthest(box)) {}
  Allowed(const Corners& p, const Corners& q) : Allowed(box_around(p, q)) {}

  /// Distances, and so what a margin decides.
  double distance() const { return 32 * kRoundoff * extent; }
  /// Nearest points, from the triangles they are said to lie on.
  double point() const { return distance() + 4 * kRoundoff * coordinate; }
  /// Those of distance(), also where triangles touch.
  double nearest_point() const { return 8 * kRoundoff * coordinate; }
  /// A contact's point from both of its triangles, and how far beyond its depth b moves along its normal until they are
  /// apart.
  double contact() const { return 1e-9 * extent + 4 * kRoundoff * coordinate; }
  /// The position of a body on its path, at a time that is a double, and by poses with such translations: that of a
  /// mesh far from its own origin is rounded by more than where it is in the world. So much a tolerance is at least.
  double on_path(double length_of_way, double translation) const {
    return 128 * kRoundoff * (extent + coordinate + length_of_way + translation);
  }

 private:
  static Box box_around(const Corners& p, const Corners& q) {
    Box box;
    for (const Corners* t : {&p, &q})
      for (const Vec3& v : *t) box.include(v);
    return box;
  }
};

/// The lengths of unit vectors.
inline constexpr double kUnitLengthOff = 16 * kRoundoff;

}  // namespace standoff::testing
