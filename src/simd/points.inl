// SPDX-License-Identifier: Apache-2.0
// Loads points from arrays of lanes into wide types.
#pragma once

#include <cstddef>

#include "geometry/triple.h"
#include "simd/target.h"

namespace standoff::STANDOFF_TARGET {

using WidePoint = Triple<WideFloat>;
using DoublePoint = Triple<WideDouble>;

namespace {

/// Loads sixteen points, or three sides of sixteen boxes: axis, lane.
STANDOFF_INLINE WidePoint load_points(const float (&at)[3][WideFloat::kLanes]) {
  return {WideFloat::load(at[0]), WideFloat::load(at[1]), WideFloat::load(at[2])};
}
STANDOFF_INLINE void store_points(const WidePoint& points, float (&at)[3][WideFloat::kLanes]) {
  points.x.store(at[0]), points.y.store(at[1]), points.z.store(at[2]);
}

/// Lane `lane` of a number, in all lanes.
STANDOFF_INLINE WideDouble of_lane(const WideDouble& eight, int lane) {
  double one;
  __builtin_memcpy(&one, reinterpret_cast<const char*>(&eight) + sizeof one * static_cast<std::size_t>(lane),
                   sizeof one);
  return WideDouble(one);
}

STANDOFF_INLINE DoublePoint of_lane(const DoublePoint& eight, int lane) {
  return {of_lane(eight.x, lane), of_lane(eight.y, lane), of_lane(eight.z, lane)};
}

/// Loads eight points in double precision.
STANDOFF_INLINE DoublePoint load_points(const double (&at)[3][WideDouble::kLanes]) {
  return {WideDouble::load(at[0]), WideDouble::load(at[1]), WideDouble::load(at[2])};
}
STANDOFF_INLINE void store_points(const DoublePoint& points, double (&at)[3][WideDouble::kLanes]) {
  points.x.store(at[0]), points.y.store(at[1]), points.z.store(at[2]);
}

}  // namespace
}  // namespace standoff::STANDOFF_TARGET
