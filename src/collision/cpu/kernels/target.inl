// SPDX-License-Identifier: Apache-2.0
// What all fragments of the queries' kernels begin with: the wide types of the instruction set, and the blocks of
// sixteen lanes they are filled from. Nothing is fused, so all sets round alike.
#pragma once

#include "collision/body/simd_blocks.h"
#include "collision/cpu/kernels.h"
#include "simd/points.inl"

namespace standoff::collision::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

static_assert(kLanes == WideFloat::kLanes && kPairs == WideDouble::kLanes);

namespace {

/// One point in all lanes.
STANDOFF_INLINE WidePoint same_points(const float* at) {
  return {WideFloat(at[0]), WideFloat(at[1]), WideFloat(at[2])};
}
/// A lane of sixteen points in all lanes.
STANDOFF_INLINE WidePoint same_points(const float (&at)[3][kLanes], int lane) {
  return {WideFloat(at[0][lane]), WideFloat(at[1][lane]), WideFloat(at[2][lane])};
}

STANDOFF_INLINE WidePoint min(const WidePoint& a, const WidePoint& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
STANDOFF_INLINE WidePoint max(const WidePoint& a, const WidePoint& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}

/// Sixteen points, transformed in another frame.
STANDOFF_INLINE WidePoint transformed(const FloatTransform& transform, const WidePoint& p) {
  const auto row = [&](int axis) __attribute__((always_inline)) {
    const float* const r = transform.rotation + 3 * axis;
    return WideFloat(r[0]) * p.x + WideFloat(r[1]) * p.y + WideFloat(r[2]) * p.z +
           WideFloat(transform.translation[axis]);
  };
  return {row(0), row(1), row(2)};
}

}  // namespace
}  // namespace standoff::collision::STANDOFF_TARGET
