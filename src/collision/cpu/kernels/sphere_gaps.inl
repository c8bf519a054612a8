// SPDX-License-Identifier: Apache-2.0
// The kernels that bound how far sixteen spheres are from a surface, by its fields (sphere_bound.h).
#pragma once

#include "collision/body/sphere_bound.h"
#include "collision/cpu/kernels/target.inl"

namespace standoff::collision::STANDOFF_TARGET {
namespace {

// The loops are plain ones, which the compiler turns into vectors: sphere_bound.h is also a GPU thread's.
void gaps_at(const FieldView& f, const float (*center)[kLanes], const float* radius, float enough, float* gap) {
  alignas(64) std::int32_t coarse_at[kLanes], tile[kLanes], within[kLanes];
  alignas(64) float coarse_off[kLanes], fine_off[kLanes], outside[kLanes];
  for (int n = 0; n < kLanes; ++n) {
    const SphereSamples at = samples_near(f, center[0][n], center[1][n], center[2][n], radius[n]);
    outside[n] = at.outside, coarse_off[n] = at.coarse_off, fine_off[n] = at.fine_off;
    coarse_at[n] = at.coarse, tile[n] = at.tile, within[n] = at.within;
  }
  alignas(64) float bound[kLanes];
  for (int n = 0; n < kLanes; ++n) bound[n] = f.coarse[coarse_at[n]];
  const WideFloat by_coarse = max(WideFloat::load(outside), WideFloat::load(bound) - WideFloat::load(coarse_off));
  by_coarse.store(gap);
  const Mask settled = less(WideFloat(enough), by_coarse);
  for (std::uint32_t asked = (~settled).to_bits(); asked != 0; asked &= asked - 1) {
    const int n = __builtin_ctz(asked);
    gap[n] = standoff::max(gap[n], static_cast<float>(fine_sample(f, tile[n], within[n])) * f.step - fine_off[n]);
  }
}

void gaps(const FieldView& f, const FloatTransform& transform, const Sphere16& spheres, float enough, float* gap) {
  alignas(64) float center[3][kLanes];
  store_points(transformed(transform, load_points(spheres.center)), center);
  gaps_at(f, center, spheres.radius, enough, gap);
}

}  // namespace
}  // namespace standoff::collision::STANDOFF_TARGET
