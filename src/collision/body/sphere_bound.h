// SPDX-License-Identifier: Apache-2.0
// The gap of a bounding sphere: a lower bound of its distance from a surface, from the surface's distance fields. In
// single precision, for the CPU's loops over sixteen spheres and the GPU's thread per sphere.
//
// Distance is 1-Lipschitz, so a sample s at x_i gives d(x) >= s - |x - x_i| for every x, and a sphere (x, r) is at
// least d(x) - r away (docs/collision.md). The nearest sample is taken, of the coarse field and then of the fine one; a
// sample clamped by the band's half-width is still a lower bound. So is the distance to the surface's box.
#pragma once

#include "collision/body/field_view.h"
#include "geometry/triple.h"

namespace standoff::collision {

/// Where along an axis the samples nearest to a point stand: their indices, and how far from them the point is, in
/// spacings, squared.
struct NearestIndex {
  std::int32_t at;
  float off_sq;
};
STANDOFF_INLINE NearestIndex nearest_index(float x, float origin, float per_spacing, float last) {
  const float u = (x - origin) * per_spacing;
  const std::int32_t at = static_cast<std::int32_t>(min(max(u, 0.0f), last) + 0.5f);
  const float off = u - static_cast<float>(at);
  return {at, off * off};
}
STANDOFF_INLINE float outside_sq(const FieldView& f, int axis, float x) {
  const float out = max(max(f.min[axis] - x, x - f.max[axis]), 0.0f);
  return out * out;
}

/// The samples nearest to a sphere's centre, and what they say less.
struct SphereSamples {
  float outside;               ///< the bound from the surface's box
  float coarse_off, fine_off;  ///< to be taken off the samples
  std::int32_t coarse;         ///< the coarse sample
  std::int32_t tile, within;   ///< the fine one: its tile, and its index there
};

STANDOFF_INLINE SphereSamples samples_near(const FieldView& f, float x, float y, float z, float radius) {
  const auto coarse = [&f](int axis, float at) __attribute__((always_inline)) {
    return nearest_index(at, f.origin[axis], f.per_coarse_spacing, f.coarse_last[axis]);
  };
  const auto fine = [&f](int axis, float at) __attribute__((always_inline)) {
    return nearest_index(at, f.origin[axis], f.per_spacing, f.last[axis]);
  };
  const NearestIndex cx = coarse(0, x), cy = coarse(1, y), cz = coarse(2, z);
  const NearestIndex fx = fine(0, x), fy = fine(1, y), fz = fine(2, z);
  return {sqrt(outside_sq(f, 0, x) + outside_sq(f, 1, y) + outside_sq(f, 2, z)) - radius,
          sqrt(cx.off_sq + cy.off_sq + cz.off_sq) * f.coarse_spacing + radius,
          sqrt(fx.off_sq + fy.off_sq + fz.off_sq) * f.spacing + radius,
          coarse_index(f, cx.at, cy.at, cz.at),
          tile_of(f, fx.at, fy.at, fz.at),
          index_in_tile(fx.at, fy.at, fz.at)};
}

/// The gap. Where the coarse field's bound exceeds `enough`, the fine field is not sampled.
STANDOFF_INLINE float gap_of_sphere(const FieldView& f, float x, float y, float z, float radius, float enough) {
  const SphereSamples at = samples_near(f, x, y, z, radius);
  const float gap = max(at.outside, f.coarse[at.coarse] - at.coarse_off);
  if (gap > enough) return gap;
  return max(gap, static_cast<float>(fine_sample(f, at.tile, at.within)) * f.step - at.fine_off);
}

/// Coordinate `axis` of a transformed point.
STANDOFF_INLINE float transformed(const FloatTransform& transform, int axis, float x, float y, float z) {
  const float* const r = transform.rotation + 3 * axis;
  return r[0] * x + r[1] * y + r[2] * z + transform.translation[axis];
}

}  // namespace standoff::collision
