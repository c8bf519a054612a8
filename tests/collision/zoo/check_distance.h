// SPDX-License-Identifier: Apache-2.0
// distance() of one pose, against what is true.
#pragma once

#include "tests/collision/zoo/findings.h"
#include "tests/collision/zoo/placed_pair.h"
#include "tests/collision/zoo/tolerances.h"

namespace standoff::testing {

inline void check_distance(const PlacedPair& at, Findings& found) {
  found.count("distances");
  const double expected = at.distance();
  const DistanceResult one = distance(at.model_a, at.pose_a, at.model_b, at.pose_b),
                       turned = distance(at.model_b, at.pose_b, at.model_a, at.pose_a);
  const Corners &p = at.a.triangle(one.triangle_a), &q = at.b.triangle(one.triangle_b);
  const Allowed allowed(p, q);
  found.expect(one.upper == 0 || !at.touch(), "distance: above 0 where they touch");
  found.expect(one.lower == one.upper, "distance: lower is not upper, without a tolerance");
  if (!at.touch()) found.off("distance", std::abs(one.upper - expected), at.allowed.distance());
  found.off("distance: with a and b swapped", std::abs(one.upper - turned.upper), at.allowed.distance());
  found.off("distance: of the two triangles", std::abs(gap(p, q) - one.upper), allowed.distance());
  found.off("distance: of the two points", std::abs(length(one.point_a - one.point_b) - one.upper), allowed.point());
  const double from_a = root_of(point_triangle_sq(one.point_a, p)), from_b = root_of(point_triangle_sq(one.point_b, q));
  found.off(
      at.touch() ? "distance: where they touch, a point from its triangle" : "distance: a point from its triangle",
      std::max(from_a, from_b), allowed.nearest_point());
}

/// With a tolerance, and with a limit.
inline void check_rough_distance(const PlacedPair& at, double tolerance, Findings& found) {
  found.count("rough distances");
  const double expected = at.distance();
  const DistanceResult rough = distance(at.model_a, at.pose_a, at.model_b, at.pose_b, {.tolerance = tolerance});
  found.off("distance: a lower bound above it", rough.lower - expected, at.allowed.distance());
  found.off("distance: an upper bound below it", expected - rough.upper, at.allowed.distance());
  found.expect(rough.upper - rough.lower <= tolerance + 1e-6 * at.allowed.extent,
               "distance: bounds farther apart than asked for");
  const DistanceResult limited = distance(at.model_a, at.pose_a, at.model_b, at.pose_b, {.limit = expected / 2});
  if (expected > 2 * at.allowed.distance())
    found.expect(std::isinf(limited.upper) && limited.lower == expected / 2, "distance: found past the limit");
}

}  // namespace standoff::testing
