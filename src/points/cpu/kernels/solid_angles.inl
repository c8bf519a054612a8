// SPDX-License-Identifier: Apache-2.0
// The kernel that adds up the solid angles of all triangles, eight at a time. Angles are arguments of complex numbers
// [Van Oosterom and Strackee 1983], and the argument of a product is the sum of arguments: so only the eight products
// need an arctangent.
#pragma once

#include "points/cpu/kernels/node_frames.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

STANDOFF_INLINE WideDouble magnitude(const WideDouble& a) { return max(a, -a); }

void add_solid_angles(const BvhView& tree, const std::int8_t* use, SolidAngles& sum) {
  constexpr int kCount = SolidAngles::kCount;
  static_assert(kCount == WideDouble::kLanes);
  // Factors are from 1e-6 to 4 in magnitude: a product of 16 of them neither overflows nor underflows.
  constexpr std::uint32_t kMostFactors = 16 * kCount;
  const WideDouble zero(0.0), one(1.0);
  WideDouble re(1.0), im(0.0), around(0.0);
  sum.flat_count = 0;
  for (std::uint32_t first = 0; first < tree.triangles; first += kCount) {
    alignas(64) double rows[3][kCount][4], times[kCount];
    for (std::uint32_t lane = 0; lane < kCount; ++lane) {
      const std::uint32_t place = first + lane < tree.triangles ? first + lane : tree.triangles - 1;
      const std::uint32_t triangle = tree.index[place];
      times[lane] = first + lane >= tree.triangles ? 0 : use ? use[triangle] : 1;
      for (int which = 0; which < 3; ++which)
        store_local(rows[which][lane], corner_of(tree, triangle, which), sum.scale, sum.at);
    }
    const auto corner = [&](int which) __attribute__((always_inline)) {
      return DoublePoint{load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
    };
    // Represent the solid angle of each triangle as a complex number.
    const DoublePoint a = corner(0), b = corner(1), c = corner(2);
    const WideDouble of_a = sqrt(dot(a, a)), of_b = sqrt(dot(b, b)), of_c = sqrt(dot(c, c));
    // Half of a triangle's angle is the argument of x + iy.
    const WideDouble product = of_a * of_b * of_c, share = one / product, weight = WideDouble::load(times);
    WideDouble x = fma(fma(dot(a, b), of_c, fma(dot(b, c), of_a, dot(c, a) * of_b)), share, one);
    WideDouble y = dot(a, cross(b, c)) * share * weight;
    const DoubleMask counts = less(zero, magnitude(weight));
    // Near an edge, rounding decides the angle; at a corner it is undefined.
    const DoubleMask certain = less(WideDouble(SolidAngles::kLeastSq), fma(x, x, y * y));
    if ((counts & negated(certain)).to_bits() != 0) {
      sum.is_certain = false;
      return;
    }
    // Set flat triangles aside: exact predicates decide them later.
    const DoubleMask flat = counts & less(x, zero) & less(magnitude(y), WideDouble(SolidAngles::kFlat));
    if (std::uint32_t lanes = flat.to_bits(); lanes != 0) {
      for (; lanes != 0; lanes &= lanes - 1) {
        if (sum.flat_count == SolidAngles::kMostFlat) {
          sum.is_certain = false;
          return;
        }
        sum.flat[sum.flat_count++] = tree.index[first + static_cast<unsigned>(__builtin_ctz(lanes))];
      }
    }
    const DoubleMask added = counts & negated(flat);
    x = select(added, x, one);
    y = select(added, y, zero);
    const WideDouble next_re = fma(re, x, -(im * y)), next_im = fma(re, y, im * x);
    // Two angles in the upper half plane sum up to [0, 2 pi]: beyond pi, the product is in the lower half plane.
    const DoubleMask below = less(im, zero), y_below = less(y, zero), next_below = less(next_im, zero);
    around = around + select(negated(below | y_below) & next_below, one, zero) -
             select(below & y_below & negated(next_below), one, zero);
    re = next_re, im = next_im;
    // Scale the product back to magnitude 1 before it may overflow.
    if ((first + kCount) % kMostFactors == 0) {
      const WideDouble size = one / (magnitude(re) + magnitude(im));
      re = re * size, im = im * size;
    }
  }
  re.store(sum.re), im.store(sum.im), around.store(sum.around);
  sum.is_certain = true;
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
