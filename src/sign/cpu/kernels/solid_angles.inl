// SPDX-License-Identifier: Apache-2.0
// The kernel that adds up solid angles of triangles, sixteen at once. Half of a solid angle is the argument of x + iy
// (van Oosterom and Strackee 1983); solid_angles.h has the bound of its error.
#pragma once

#include "sign/cpu/kernels.h"
#include "simd/target.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

struct WideVec {
  WideFloat x, y, z;
};
STANDOFF_INLINE WideFloat dot(const WideVec& a, const WideVec& b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
STANDOFF_INLINE WideVec cross(const WideVec& a, const WideVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Scales products so that they stay in the range of float for some factors.
STANDOFF_INLINE void scale_products(WideFloat& re, WideFloat& im) {
  const WideFloat scale = WideFloat(1.0f) / max(abs(re), abs(im));
  re = re * scale;
  im = im * scale;
}

// Adds triangles first to first + count - 1, at most AngleChunk::kMost, seen from p; corners nearer than least_length
// are left.
void add_solid_angles(const AngleTriangles& triangles, std::int64_t first, int count, const float* p,
                      float least_length, AngleSums& sums, AngleChunk& chunk) {
  constexpr int kBetweenScales = 8;  // each factor is between 0.2 and 4.1
  const WideFloat zero(0.0f), one(1.0f), far(3e38f);
  const WideFloat px(p[0]), py(p[1]), pz(p[2]);
  WideFloat re = WideFloat::load(sums.re), im = WideFloat::load(sums.im), around = WideFloat::load(sums.around);
  WideFloat least_l = far, least_sq = far;
  chunk.left_count = 0;
  for (int n = 0, factors = 0; n < count; n += WideFloat::kLanes) {
    const auto corner = [&](int k) __attribute__((always_inline)) {
      const auto at = [&](int axis) __attribute__((always_inline)) {
        return WideFloat::load(triangles.corner[k][axis] + first + n);
      };
      return WideVec{at(0) - px, at(1) - py, at(2) - pz};
    };
    const WideVec a = corner(0), b = corner(1), c = corner(2);
    const WideFloat la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
    const WideFloat ab = la * lb, all = ab * lc, per = one / all;
    WideFloat x = (all + fma(dot(a, b), lc, fma(dot(b, c), la, dot(c, a) * lb))) * per, y = dot(a, cross(b, c)) * per;
    const WideFloat nearest = min(la, min(lb, lc)), sq = fma(x, x, y * y);
    const Mask exist = mask_from_bits(count - n < WideFloat::kLanes ? (1u << (count - n)) - 1 : 0xffff);
    // Not where a comparison with no number is false.
    const Mask good = exist & less_equal(WideFloat(least_length), nearest) & less_equal(WideFloat(kLeastSq), sq) &
                      (less_equal(WideFloat(0.1f), x) | less_equal(WideFloat(1e-3f), abs(y)));
    const Mask left = exist & ~good;
    if (left.to_bits() != 0)
      chunk.left_count +=
          store_packed(chunk.left + chunk.left_count, left, WideUint(static_cast<std::uint32_t>(n)) + lane_numbers());
    least_l = min(least_l, select(good, nearest, far));
    least_sq = min(least_sq, select(good, sq, far));
    x = select(good, x, one);
    y = select(good, y, zero);
    const WideFloat next_re = re * x - im * y, next_im = re * y + im * x;
    // Two angles of the upper half plane sum up to [0, 2 pi]: beyond pi, the product is in the lower one.
    const Mask lower = less(im, zero), y_lower = less(y, zero), next_lower = less(next_im, zero);
    around =
        around + select(~lower & ~y_lower & next_lower, one, zero) - select(lower & y_lower & ~next_lower, one, zero);
    re = next_re;
    im = next_im;
    if (++factors % kBetweenScales == 0) scale_products(re, im);
  }
  scale_products(re, im);
  re.store(sums.re);
  im.store(sums.im);
  around.store(sums.around);
  chunk.least_length = reduce_min(least_l);
  chunk.least_sq = reduce_min(least_sq);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
