// SPDX-License-Identifier: Apache-2.0
// The kernels of the sign for one instruction set, and their table: crossings of rows, sums of solid angles, and
// negation.
#pragma once

#include "sign/cpu/kernels.h"
#include "simd/target.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

// The kernels that find the rows of samples that cross triangles: the rows beside each triangle, for eight triangles at
// once; what decides about rows, for sixteen triangles; and that, for sixteen rows of a triangle.
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

// Adds a number so large that the sum has no room for fractions. Requires |x| < 2^51.
STANDOFF_INLINE WideDouble rounded_down(const WideDouble& x) {
  const WideDouble large(0x1.8p52), nearest = (x + large) - large;
  return nearest - select(less(x, nearest), WideDouble(1.0), WideDouble(0.0));
}
template <class Wide>
STANDOFF_INLINE Wide least(const Wide* v) {
  return min(min(v[0], v[1]), v[2]);
}
template <class Wide>
STANDOFF_INLINE Wide largest(const Wide* v) {
  return max(max(v[0], v[1]), v[2]);
}
STANDOFF_INLINE WideDouble magnitude(const WideDouble& v) { return max(v, -v); }

// Rows of eight triangles, from triangle n on; `exist`: a bit for each that there is.
STANDOFF_INLINE void find_rows_of_eight(const RowCorners& corners, int n, std::uint32_t exist, const RowSpace& space,
                                        RowTriangles& found) {
  const WideDouble one(1.0), zero(0.0);
  WideDouble v[3][3], begin[3], rows[3];
  DoubleMask any = double_mask_from_bits(exist);
  for (int axis = 0; axis < 3; ++axis) {
    WideDouble world[3];
    const WideDouble origin(space.origin[axis]), spacing(space.spacing[axis]), per(space.per_spacing[axis]),
        first(space.first[axis]);
    for (int c = 0; c < 3; ++c) {
      world[c] = WideDouble::load(corners.at[axis][c] + n);
      v[axis][c] = (world[c] - origin) * per - first;
    }
    if (axis == 0) continue;
    // Take the first rows after the lowest corner - kNearRow and after the highest one + kNearRow.
    begin[axis] = rounded_down(max(least(v[axis]) + WideDouble(1 - kNearRow), WideDouble(space.begin[axis])));
    WideDouble past =
        rounded_down(max(min(largest(v[axis]) + WideDouble(1 + kNearRow), WideDouble(space.end[axis])), zero));
    // Make the range half open: a row at the largest y or z passes beside the triangle.
    const auto coordinate = [&](const WideDouble& row) __attribute__((always_inline)) {
      return origin + spacing * (first + row);
    };
    begin[axis] = begin[axis] + select(less(coordinate(begin[axis]), least(world)), one, zero);
    past = past - select(less(coordinate(past - one), largest(world)), zero, one);
    rows[axis] = past - begin[axis];
    any = any & less(begin[axis], past);
  }
  const WideDouble low_x = least(v[0]);
  any = any & negated(less(WideDouble(space.size_x + 1), low_x));
  found.any |= std::uint64_t{any.to_bits()} << n;
  if (any.to_bits() == 0) return;

  begin[0] = rounded_down(max(low_x, WideDouble(-double{RowTriangles::kMostSamples})));
  DoubleMask fits = any;
  for (int axis = 0; axis < 3; ++axis) {
    WideDouble most = axis == 0 ? one : max(rows[axis], WideDouble(space.slack));
    for (int c = 0; c < 3; ++c) {
      const WideDouble at = v[axis][c] - begin[axis];
      store_rounded(found.at[axis][c] + n, at);
      most = max(most, axis == 0 ? at : magnitude(at));  // where x is negative, no crossing has samples before it
    }
    store_rounded(found.most[axis] + n, most);
    fits = fits & less(most, WideDouble(RowTriangles::kMostCoordinate));
    if (axis == 0) continue;
    store_truncated(found.rows[axis] + n, rows[axis]);
    store_rounded(found.first[axis] + n, begin[axis] - WideDouble(space.tile[axis]));
  }
  store_rounded(found.base + n, begin[0]);
  found.fits |= std::uint64_t{fits.to_bits()} << n;
}

// What decides about the rows of sixteen triangles, from triangle n on.
STANDOFF_INLINE void set_up_sixteen(int n, double slack, RowTriangles& t) {
  const auto load = [&](const float* of) __attribute__((always_inline)) { return WideFloat::load(of + n); };
  WideFloat x[3], p[3], q[3], a[3], b[3];
  for (int c = 0; c < 3; ++c) {
    x[c] = load(t.at[0][c]);
    p[c] = load(t.at[1][c]);
    q[c] = load(t.at[2][c]);
  }
  for (int c = 0; c < 3; ++c) {
    a[c] = p[(c + 1) % 3] - p[c];
    b[c] = q[c] - q[(c + 1) % 3];
  }
  const WideFloat area = a[0] * b[2] - a[2] * b[0];
  // Orient the sides as if the corners turned left.
  const Mask leaves = less(WideFloat(0.0f), area);
  const WideFloat sign = select(leaves, WideFloat(1.0f), WideFloat(-1.0f));
  for (int c = 0; c < 3; ++c) {
    (-sign * (b[c] * p[c] + a[c] * q[c])).store(t.side[c][0] + n);
    (sign * b[c]).store(t.side[c][1] + n);
    (sign * a[c]).store(t.side[c][2] + n);
  }
  select(leaves, WideFloat(0.0f), WideFloat(1.0f)).store(t.enters + n);
  const WideFloat most_x = load(t.most[0]), most_p = load(t.most[1]), most_q = load(t.most[2]);
  const WideFloat wh = most_p * most_q, w_h = most_p + most_q, s(static_cast<float>(slack));
  (WideFloat(kRounding) * wh + WideFloat(16.0f) * s * w_h).store(t.side_bound + n);

  // Take the parts of the normal u x v, with u = (x1, a0, -b0) and v = (x2, -a2, b2).
  const WideFloat x1 = x[1] - x[0], x2 = x[2] - x[0], per_area = WideFloat(1.0f) / area;
  const WideFloat x_p = (b[0] * x2 + b[2] * x1) * per_area, x_q = (a[0] * x2 + a[2] * x1) * per_area,
                  x_0 = x[0] - x_p * p[0] - x_q * q[0];
  x_0.store(t.plane[0] + n);
  x_p.store(t.plane[1] + n);
  x_q.store(t.plane[2] + n);
  const WideFloat of_minors = WideFloat(8 * kRounding) * most_x * wh + WideFloat(64.0f) * s * (wh + most_x * w_h);
  (of_minors * abs(per_area) + WideFloat(0x1p-20f) * (abs(x_0) + abs(x_p) * most_p + abs(x_q) * most_q + most_x) + s)
      .store(t.plane_bound + n);
}

void find_rows(const RowCorners& corners, int count, const RowSpace& space, RowTriangles& found) {
  found.any = found.fits = 0;
  for (int n = 0; n < count; n += WideDouble::kLanes)
    find_rows_of_eight(corners, n, count - n < WideDouble::kLanes ? (1u << (count - n)) - 1 : 0xff, space, found);
  for (int n = 0; n < count; n += WideFloat::kLanes)
    if ((found.fits >> n & 0xffff) != 0) set_up_sixteen(n, space.slack, found);
}

// Rows of a strip of each width, in order: p and q relative to the first row.
struct RowPlaces {
  float p[RowStrip::kMostWidth + 1][RowStrip::kMostRows], q[RowStrip::kMostWidth + 1][RowStrip::kMostRows];
};
constexpr RowPlaces places_of_rows() {
  RowPlaces places{};
  for (int width = 1; width <= RowStrip::kMostWidth; ++width)
    for (int row = 0; row < RowStrip::kMostRows; ++row) {
      places.p[width][row] = static_cast<float>(row % width);
      places.q[width][row] = static_cast<float>(row / width);
    }
  // Width 0 stands for a strip one row high.
  for (int row = 0; row < RowStrip::kMostRows; ++row) places.p[0][row] = static_cast<float>(row);
  return places;
}
constexpr RowPlaces kRowPlaces = places_of_rows();

// Rounds to the nearest whole number: the sum has no room for fractions. Requires |x| < 2^22.
STANDOFF_INLINE WideFloat rounded_to_nearest(const WideFloat& x) {
  const WideFloat large(0x1.8p23f);
  return (x + large) - large;
}

STANDOFF_INLINE void cross_strip(const RowTriangles& triangles, const RowStrip& strip, std::uint32_t first_number,
                                 const RowSpace& space, CrossedRows& found) {
  const auto of = [&](const float* all) __attribute__((always_inline)) { return WideFloat(all[strip.triangle]); };
  struct Linear {
    WideFloat at_0, of_p, of_q;
    STANDOFF_INLINE WideFloat at(const WideFloat& p, const WideFloat& q) const { return of_q * q + at_0 + of_p * p; }
  };
  const auto linear = [&](const float(&all)[3][RowTriangles::kMost]) __attribute__((always_inline)) {
    return Linear{of(all[0]), of(all[1]), of(all[2])};
  };
  const Linear side0 = linear(triangles.side[0]), side1 = linear(triangles.side[1]), side2 = linear(triangles.side[2]),
               plane = linear(triangles.plane);
  const WideFloat bound = of(triangles.side_bound), x_bound = of(triangles.plane_bound), base = of(triangles.base);
  const WideFloat first_j = of(triangles.first[1]), first_k = of(triangles.first[2]), enters = of(triangles.enters);
  const WideFloat first_p(static_cast<float>(strip.p)), first_q(static_cast<float>(strip.q)), zero(0.0f), one(1.0f);
  const WideFloat size_x(static_cast<float>(space.size_x)), per_layer(128 * (space.tiles_y - 1));

  const int rows = strip.width * strip.height, width = strip.height == 1 ? 0 : strip.width;
  for (int row = 0; row < rows; row += WideFloat::kLanes) {
    const WideFloat p = WideFloat::load(kRowPlaces.p[width] + row) + first_p,
                    q = WideFloat::load(kRowPlaces.q[width] + row) + first_q;
    const WideFloat e0 = side0.at(p, q), e1 = side1.at(p, q), e2 = side2.at(p, q);
    const WideFloat lowest = min(min(e0, e1), e2), highest = max(max(e0, e1), e2);
    const WideFloat x = plane.at(p, q), nearest = rounded_to_nearest(x), off = x - nearest;
    const Mask inside = less(bound, lowest), outside = less(lowest, -bound) & less(bound, highest),
               is_clear = less(x_bound, abs(off));
    const Mask exist = mask_from_bits(rows - row < WideFloat::kLanes ? (1u << (rows - row)) - 1 : 0xffff);
    const Mask crosses = inside & is_clear & exist, unsure = ~(crosses | outside) & exist;
    const WideFloat past = max(nearest + select(less(zero, off), one, zero) + base, zero);
    const Mask counts = crosses & less(past, size_x);
    // Number the rows 64 (j / 8 + tiles_y (k / 8)) + j % 8 + 8 (k % 8). All sums are whole and less than 2^24.
    const auto tile_of = [&](const WideFloat& at) __attribute__((always_inline)) {
      return rounded_to_nearest(at * WideFloat(0.125f) - WideFloat(0.4375f));
    };
    const WideFloat j = first_j + p, k = first_k + q;
    const WideFloat in_layer = WideFloat(2.0f) * j + WideFloat(112.0f) * tile_of(j) + enters;
    store_packed(found.past + found.count, counts, past);
    const int n =
        store_packed(found.row + found.count, counts, in_layer + WideFloat(16.0f) * k + per_layer * tile_of(k));
    found.count += n;
    if (unsure.to_bits() != 0)
      found.unsure_count += store_packed(found.unsure + found.unsure_count, unsure,
                                         WideUint(first_number + static_cast<std::uint32_t>(row)) + lane_numbers());
  }
}

void cross_rows(const RowTriangles& triangles, const RowStrip* strips, int count, const RowSpace& space,
                CrossedRows& found) {
  found.count = found.unsure_count = 0;
  for (int n = 0; n < count; ++n)
    cross_strip(triangles, strips[n], static_cast<std::uint32_t>(RowStrip::kMostRows * n), space, found);
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

// The kernel that adds up winding numbers along rows, for 64 rows at once.

namespace {

struct WideWinding {
  using Bytes = std::int8_t __attribute__((vector_size(64)));
  Bytes v{};

  STANDOFF_INLINE void add(const std::int8_t* steps) {
    Bytes more;
    __builtin_memcpy(&more, steps, sizeof more);
    v += more;
  }
  STANDOFF_INLINE bool any() const {
    std::uint64_t words[8], all = 0;
    __builtin_memcpy(words, &v, sizeof words);
    for (const std::uint64_t word : words) all |= word;
    return all != 0;
  }
};

// Calls mark(winding, bits), where bits of the rows inside are to be set.
template <class Mark>
STANDOFF_INLINE TileRange mark_by(std::int8_t* steps, std::uint8_t* is_stepped, std::int64_t tiles,
                                  std::uint8_t* inside, const Mark& mark) {
  constexpr int kSide = 8, kRows = 64;
  WideWinding winding;
  bool any = false;
  TileRange marks{tiles, 0};
  for (std::int64_t tile = 0; tile < tiles; ++tile) {
    if (!is_stepped[tile] && !any) continue;
    if (marks.end == 0) marks.first = tile;
    marks.end = tile + 1;
    WideWinding::Bytes marked{};
    if (is_stepped[tile]) {
      std::int8_t* const here = steps + kRows * kSide * tile;
      for (int sample = 0; sample < kSide; ++sample) {
        winding.add(here + kRows * sample);
        mark(winding.v, static_cast<std::int8_t>(1 << sample), marked);
      }
      __builtin_memset(here, 0, kRows * kSide);
      is_stepped[tile] = 0;
      any = winding.any();
    } else {
      mark(winding.v, std::int8_t{-1}, marked);
    }
    __builtin_memcpy(inside + kRows * tile, &marked, sizeof marked);
  }
  return marks;
}

TileRange mark_inside(std::int8_t* steps, std::uint8_t* is_stepped, std::int64_t tiles, WindingRule rule,
                      std::uint8_t* inside) {
  using Bytes = WideWinding::Bytes;
  const auto by = [&](const auto& mark) __attribute__((always_inline)) {
    return mark_by(steps, is_stepped, tiles, inside, mark);
  };
  switch (rule) {
    case WindingRule::positive:
      return by([](const Bytes& w, std::int8_t bits, Bytes& to)
                    __attribute__((always_inline)) { to |= (w > 0) & bits; });
    case WindingRule::nonzero:
      return by([](const Bytes& w, std::int8_t bits, Bytes& to)
                    __attribute__((always_inline)) { to |= (w != 0) & bits; });
    case WindingRule::odd:
      return by([](const Bytes& w, std::int8_t bits, Bytes& to)
                    __attribute__((always_inline)) { to |= -(w & 1) & bits; });
  }
  return {};
}

}  // namespace

// The kernel that gives values their signs.

namespace {

void negate(const std::uint8_t* inside, std::int64_t count, float* values) {
  std::int64_t n = 0;
  for (; n + WideFloat::kLanes <= count; n += WideFloat::kLanes) {
    const std::uint32_t bits = inside[n / 8] | static_cast<std::uint32_t>(inside[n / 8 + 1]) << 8;
    if (bits == 0) continue;  // leaves a line of memory alone
    const WideFloat v = WideFloat::load(values + n);
    select(mask_from_bits(bits) & ~equal(v, WideFloat(0.0f)), -v, v).store(values + n);
  }
  for (; n < count; ++n)
    if ((inside[n / 8] >> n % 8 & 1) != 0 && values[n] != 0) values[n] = -values[n];
}

}  // namespace

constexpr SignKernels kTable{.find_rows = find_rows,
                             .cross_rows = cross_rows,
                             .add_solid_angles = add_solid_angles,
                             .mark_inside = mark_inside,
                             .negate = negate};

}  // namespace standoff::cpu::STANDOFF_TARGET

const standoff::cpu::SignKernels standoff::cpu::SignKernels::STANDOFF_TARGET = standoff::cpu::STANDOFF_TARGET::kTable;
