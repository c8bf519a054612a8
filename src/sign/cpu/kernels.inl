// SPDX-License-Identifier: Apache-2.0
// The kernels of the sign for one instruction set, and their table: crossings of rows, sums of solid angles, and
// negation.
#pragma once

#include "sign/cpu/kernels.h"
#include "simd/target.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

// The kernel that tests rows of samples against triangles, sixteen rows at once.
//
// Side n of the triangle, from corner n to the next one, has the function E(p, q) = a q + b p + c, the determinant of
// the side and the row: positive where the row is on its left. A row crosses the triangle where all three have the same
// sign. x = x_0 + x_p p + x_q q is where it crosses the plane.
//
// Let W, H and R bound |p|, |q| and |x|, and let u = 2^-24. A corner is rounded to float, off by W u. So |a| <= 2W,
// |b| <= 2H, |c| <= 4WH are off by 4Wu, 4Hu, 20WHu, and E, of four operations more, by less than 2^6 WH u. Its sign is
// sure beyond twice that, kRounding W H; and 8 s (W + H + s) more where coordinates are off by s, which is at most W
// and H.
//
// x_p and x_q are quotients by the area, of minors like it, with R in place of W or H. In the triangle the errors of
// the three move x by less than the first order of 4 R W H / area times the error of E / (W H). That is taken twice: if
// the area is not half of what it should be, the bound is more than 1/2, as R >= 1. For s it is the same. Rounding of
// the coefficients and of four operations moves x by less than 2^-20 (|x_0| + |x_p| W + |x_q| H).

namespace {

constexpr float kRounding = 0x1p-17f;

// Rows of a patch of each width, in order: p and q relative to the first row.
struct RowPlaces {
  float p[RowPatch::kMostWidth + 1][RowPatch::kMostRows], q[RowPatch::kMostWidth + 1][RowPatch::kMostRows];
};
constexpr RowPlaces places_of_rows() {
  RowPlaces places{};
  for (int width = 1; width <= RowPatch::kMostWidth; ++width)
    for (int row = 0; row < RowPatch::kMostRows; ++row) {
      places.p[width][row] = static_cast<float>(row % width);
      places.q[width][row] = static_cast<float>(row / width);
    }
  // Width 0 stands for a patch one row high.
  for (int row = 0; row < RowPatch::kMostRows; ++row) places.p[0][row] = static_cast<float>(row);
  return places;
}
constexpr RowPlaces kRowPlaces = places_of_rows();

struct LinearOfRow {
  WideFloat of_p, of_q, at_0;
  STANDOFF_INLINE WideFloat at(const WideFloat& p, const WideFloat& q) const { return of_q * q + at_0 + of_p * p; }
};

STANDOFF_INLINE void cross_patch(const RowPatch& t, std::uint32_t first_number, bool& leaves, CrossedRows& found) {
  const float a0 = t.at[1].p - t.at[0].p, a1 = t.at[2].p - t.at[1].p, a2 = t.at[0].p - t.at[2].p;
  const float b0 = t.at[0].q - t.at[1].q, b1 = t.at[1].q - t.at[2].q, b2 = t.at[2].q - t.at[0].q;
  const float area = a0 * b2 - a2 * b0;
  leaves = area > 0;
  // Orient the sides as if the corners turned left.
  const float sign = leaves ? 1.0f : -1.0f;
  const auto side = [&](float a, float b, float p, float q) __attribute__((always_inline)) {
    return LinearOfRow{WideFloat(sign * b), WideFloat(sign * a), WideFloat(-sign * (b * p + a * q))};
  };
  const LinearOfRow side0 = side(a0, b0, t.at[0].p, t.at[0].q), side1 = side(a1, b1, t.at[1].p, t.at[1].q),
                    side2 = side(a2, b2, t.at[2].p, t.at[2].q);
  const float wh = t.most.p * t.most.q, w_h = t.most.p + t.most.q;
  const float bound = kRounding * wh + 16 * t.slack * w_h;

  const float x1 = t.x[1] - t.x[0], x2 = t.x[2] - t.x[0], per_area = 1 / area;
  // Take the parts of the normal u x v, with u = (x1, a0, -b0) and v = (x2, -a2, b2).
  const float x_p = (b0 * x2 + b2 * x1) * per_area, x_q = (a0 * x2 + a2 * x1) * per_area;
  const float x_0 = t.x[0] - x_p * t.at[0].p - x_q * t.at[0].q;
  const LinearOfRow plane{WideFloat(x_p), WideFloat(x_q), WideFloat(x_0)};
  const float of_minors = 8 * t.most_x * kRounding * wh + 64 * t.slack * (wh + t.most_x * w_h);
  const float x_bound =
      of_minors * __builtin_fabsf(per_area) +
      0x1p-20f * (__builtin_fabsf(x_0) + __builtin_fabsf(x_p) * t.most.p + __builtin_fabsf(x_q) * t.most.q + t.most_x) +
      t.slack;

  const int rows = t.width * t.height, width = t.height == 1 ? 0 : t.width;
  for (int row = 0; row < rows; row += WideFloat::kLanes) {
    const WideFloat p = WideFloat::load(kRowPlaces.p[width] + row) + WideFloat(t.first.p),
                    q = WideFloat::load(kRowPlaces.q[width] + row) + WideFloat(t.first.q);
    const WideFloat e0 = side0.at(p, q), e1 = side1.at(p, q), e2 = side2.at(p, q);
    const WideFloat least = min(min(e0, e1), e2), most = max(max(e0, e1), e2);
    const WideFloat x = plane.at(p, q);
    // Round to the nearest whole number: the sum has no room for fractions.
    const WideFloat whole(0x1.8p23f), nearest = (x + whole) - whole, off = x - nearest;
    const Mask inside = less(WideFloat(bound), least),
               outside = less(least, WideFloat(-bound)) & less(WideFloat(bound), most),
               is_clear = less(WideFloat(x_bound), abs(off));
    const Mask exist = mask_from_bits(rows - row < WideFloat::kLanes ? (1u << (rows - row)) - 1 : 0xffff);
    const Mask crosses = inside & is_clear & exist, unsure = ~(crosses | outside) & exist;
    const WideUint number = WideUint(first_number + static_cast<std::uint32_t>(row)) + lane_numbers();
    store_packed(found.past + found.count, crosses,
                 nearest + select(less(WideFloat(0), off), WideFloat(1), WideFloat(0)));
    found.count += store_packed(found.row + found.count, crosses, number);
    if (unsure.to_bits() != 0) found.unsure_count += store_packed(found.unsure + found.unsure_count, unsure, number);
  }
}

void cross_rows(const RowPatch* patches, int count, CrossedRows& found) {
  found.count = found.unsure_count = 0;
  for (int n = 0; n < count; ++n)
    cross_patch(patches[n], static_cast<std::uint32_t>(RowPatch::kMostRows * n), found.leaves[n], found);
}

}  // namespace

// The kernel that adds up solid angles of triangles, sixteen at once. Half of a solid angle is the argument of x + iy
// (van Oosterom and Strackee 1983); angle_error() bounds its error.

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
    // NaN makes a comparison false, and so is left out.
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
    // Two angles of the upper half plane add up to [0, 2 pi]; beyond pi, the product is in the lower half plane.
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

// The kernel that gives values their signs.

namespace {

STANDOFF_INLINE void negate_sixteen(std::uint32_t inside, float* values) {
  const WideFloat v = WideFloat::load(values);
  select(mask_from_bits(inside) & ~equal(v, WideFloat(0.0f)), -v, v).store(values);
}

void negate(const std::uint8_t* inside, std::int64_t count, float* values) {
  std::int64_t n = 0;
  for (; n + WideFloat::kLanes <= count; n += WideFloat::kLanes)
    negate_sixteen(inside[n / 8] | static_cast<std::uint32_t>(inside[n / 8 + 1]) << 8, values + n);
  for (; n < count; ++n)
    if ((inside[n / 8] >> n % 8 & 1) != 0 && values[n] != 0) values[n] = -values[n];
}

}  // namespace

constexpr SignKernels kTable{.cross_rows = cross_rows, .add_solid_angles = add_solid_angles, .negate = negate};

}  // namespace standoff::cpu::STANDOFF_TARGET

const standoff::cpu::SignKernels standoff::cpu::SignKernels::STANDOFF_TARGET = standoff::cpu::STANDOFF_TARGET::kTable;
