// distance() of one pose, against what is true.
#pragma once

#include "tests/collision/zoo/findings.h"
#include "tests/collision/zoo/placed_pair.h"
#include "tests/collision/zoo/tolerances.h"

namespace difi::testing {

inline void check_distance(const PlacedPair& at, Findings& found) {
  found.count("distances");
  const double expected = at.distance();
  const Distance one = distance(at.model_a, at.pose_a, at.model_b, at.pose_b),
                 turned = distance(at.model_b, at.pose_b, at.model_a, at.pose_a);
  found.expect(one.upper == 0 || !at.touch(), "distance: above 0 where they touch");
  found.expect(one.lower == one.upper, "distance: lower is not upper, without a tolerance");
  if (!at.touch()) found.off("distance", std::abs(one.upper - expected) / at.unit, kDistanceUnits);
  found.off("distance: with a and b swapped", std::abs(one.upper - turned.upper) / at.unit, kDistanceUnits);
  found.off("distance: of the two points", std::abs(length(one.point_a - one.point_b) - one.upper) / at.world_unit,
            kPointUnits);
  const double from_a = root_of(point_triangle_sq(one.point_a, at.a.triangle(one.triangle_a))),
               from_b = root_of(point_triangle_sq(one.point_b, at.b.triangle(one.triangle_b)));
  found.off("distance: a point from its triangle", std::max(from_a, from_b) / at.world_unit, kPointUnits);
  found.off("distance: of the two triangles",
            std::abs(gap(at.a.triangle(one.triangle_a), at.b.triangle(one.triangle_b)) - one.upper) / at.unit,
            kDistanceUnits);
}

/// With a tolerance, and with a limit.
inline void check_rough_distance(const PlacedPair& at, double tolerance, Findings& found) {
  found.count("rough distances");
  const double expected = at.distance(), size = at.unit / std::numeric_limits<double>::epsilon();
  const Distance rough = distance(at.model_a, at.pose_a, at.model_b, at.pose_b, {.tolerance = tolerance});
  found.off("distance: a lower bound above it", (rough.lower - expected) / at.unit, kDistanceUnits);
  found.off("distance: an upper bound below it", (expected - rough.upper) / at.unit, kDistanceUnits);
  found.expect(rough.upper - rough.lower <= tolerance + 1e-6 * size, "distance: bounds farther apart than asked for");
  const Distance limited = distance(at.model_a, at.pose_a, at.model_b, at.pose_b, {.limit = expected / 2});
  if (expected > 2 * kDistanceUnits * at.unit)
    found.expect(std::isinf(limited.upper) && limited.lower == expected / 2, "distance: found past the limit");
}

}  // namespace difi::testing
