// SPDX-License-Identifier: Apache-2.0
// Determinants of points, for host and device, in three stages. After Shewchuk, Adaptive precision floating-point
// arithmetic and fast robust geometric predicates (1997): his first stage with its error bound; then twofold
// arithmetic, where a number is the sum of two doubles; and if these 100 bits do not decide, the exact sum of all
// products. All functions require coordinates that are zero or of magnitude 1e-90 to 1e100.
#pragma once

#include "geometry/host_device.h"
#include "geometry/rounding.h"
#include "geometry/triple.h"
#include "standoff/vec.h"

namespace standoff {

STANDOFF_INLINE int sign_of(double value) { return (value > 0) - (value < 0); }

/// A point in the plane.
struct Flat {
  double x, y;
};

/// Shewchuk's error bound of the first stage, as a share of the sum of the products' magnitudes.
inline constexpr double kRounded3d = (7 + 56 * kRoundoffDouble) * kRoundoffDouble;
inline constexpr double kRounded2d = (3 + 16 * kRoundoffDouble) * kRoundoffDouble;
/// The error in twofold arithmetic: a share of the sum of the products' magnitudes, and underflow.
inline constexpr double kTwofoldBound = 0x1p-97, kTwofoldUnderflow = 1e-250;

/// A determinant in double arithmetic, and the sum of its products' magnitudes, which bounds its rounding.
struct RoundedDeterminant {
  double value, magnitude;
};
STANDOFF_INLINE RoundedDeterminant rounded_determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double vxwy = v.x * w.y, vywx = v.y * w.x, uxwy = u.x * w.y, uywx = u.y * w.x, uxvy = u.x * v.y,
               uyvx = u.y * v.x;
  return {u.z * (vxwy - vywx) - v.z * (uxwy - uywx) + w.z * (uxvy - uyvx),
          (abs(vxwy) + abs(vywx)) * abs(u.z) + (abs(uxwy) + abs(uywx)) * abs(v.z) + (abs(uxvy) + abs(uyvx)) * abs(w.z)};
}
STANDOFF_INLINE RoundedDeterminant rounded_determinant2d(const Flat& a, const Flat& b, const Flat& c) {
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  return {left - right, abs(left) + abs(right)};
}

/// Whether the points' coordinates along an axis are equal, as they are in most planes that hold several triangles.
/// Then the determinant is 0.
STANDOFF_INLINE bool are_level(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (a.x == b.x && a.x == c.x && a.x == d.x) || (a.y == b.y && a.y == c.y && a.y == d.y) ||
         (a.z == b.z && a.z == c.z && a.z == d.z);
}
STANDOFF_INLINE bool are_level(const Flat& a, const Flat& b, const Flat& c) {
  return (a.x == b.x && a.x == c.x) || (a.y == b.y && a.y == c.y);
}

/// value + tail is the exact result.
struct Two {
  double value, tail;
};
STANDOFF_INLINE Two two_sum(double a, double b) {
  const double sum = a + b, bb = sum - a;
  return {sum, (a - (sum - bb)) + (b - bb)};
}
STANDOFF_INLINE Two two_product(double a, double b) {
  const double product = a * b;
  return {product, fma(a, b, -product)};
}

/// Twofold arithmetic.
STANDOFF_INLINE Two difference_of(double a, double b) { return two_sum(a, -b); }
STANDOFF_INLINE Two operator-(const Two& a) { return {-a.value, -a.tail}; }
STANDOFF_INLINE Two operator+(const Two& a, const Two& b) {
  const Two sum = two_sum(a.value, b.value);
  return two_sum(sum.value, sum.tail + (a.tail + b.tail));
}
STANDOFF_INLINE Two operator-(const Two& a, const Two& b) { return a + -b; }
STANDOFF_INLINE Two operator*(const Two& a, const Two& b) {
  const Two product = two_product(a.value, b.value);
  return two_sum(product.value, product.tail + (a.value * b.tail + a.tail * b.value));
}

STANDOFF_INLINE Two twofold_determinant2d(const Flat& a, const Flat& b, const Flat& c) {
  return difference_of(b.x, a.x) * difference_of(c.y, a.y) - difference_of(b.y, a.y) * difference_of(c.x, a.x);
}
STANDOFF_INLINE Two twofold_determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Two ux = difference_of(b.x, a.x), uy = difference_of(b.y, a.y), uz = difference_of(b.z, a.z);
  const Two vx = difference_of(c.x, a.x), vy = difference_of(c.y, a.y), vz = difference_of(c.z, a.z);
  const Two wx = difference_of(d.x, a.x), wy = difference_of(d.y, a.y), wz = difference_of(d.z, a.z);
  return ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx);
}

/// An exact sum of doubles: its parts do not overlap, and grow in magnitude.
class Expansion {
 public:
  /// At most so many numbers are added for a determinant: 6 permutations, 8 choices of parts, 4 parts of each.
  static constexpr int kMostParts = 192;

  /// `parts`: memory for kMostParts numbers.
  STANDOFF_HD explicit Expansion(double* parts) : parts_(parts) {}

  STANDOFF_HD void add(double value) {
    if (value == 0) return;
    int kept = 0;
    for (int n = 0; n < count_; ++n) {
      const Two sum = two_sum(value, parts_[n]);
      if (sum.tail != 0) parts_[kept++] = sum.tail;
      value = sum.value;
    }
    if (value != 0) parts_[kept++] = value;
    count_ = kept;
  }
  /// Adds x y z factor, where x, y and z are sums of two parts.
  STANDOFF_HD void add_product(const Two& x, const Two& y, const Two& z, double factor) {
    add_product(x.value, y, z, factor);
    add_product(x.tail, y, z, factor);
  }
  /// The rounded sum. Its sign is the sign of the largest part.
  STANDOFF_HD double value() const {
    double sum = 0;
    for (int n = 0; n < count_; ++n) sum += parts_[n];
    return sum;
  }

 private:
  STANDOFF_HD void add_product(double x, const Two& y, const Two& z, double factor) {
    add_product(two_product(x, y.value), z, factor);
    add_product(two_product(x, y.tail), z, factor);
  }
  STANDOFF_HD void add_product(const Two& xy, const Two& z, double factor) {
    add_product(xy, z.value * factor);
    add_product(xy, z.tail * factor);
  }
  STANDOFF_HD void add_product(const Two& xy, double z) {
    const Two high = two_product(xy.value, z), low = two_product(xy.tail, z);
    add(low.tail);
    add(low.value);
    add(high.tail);
    add(high.value);
  }

  double* parts_;
  int count_ = 0;
};

/// The determinants to the last bit, rounded once at the end. `parts`: memory for Expansion::kMostParts numbers.
STANDOFF_HD inline double determinant2d_exactly(const Flat& a, const Flat& b, const Flat& c, double* parts) {
  Expansion sum(parts);
  sum.add_product(difference_of(b.x, a.x), difference_of(c.y, a.y), {1, 0}, 1);
  sum.add_product(difference_of(b.y, a.y), difference_of(c.x, a.x), {1, 0}, -1);
  return sum.value();
}
STANDOFF_HD inline double determinant3d_exactly(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                                double* parts) {
  const Two bx = difference_of(b.x, a.x), by = difference_of(b.y, a.y), bz = difference_of(b.z, a.z);
  const Two cx = difference_of(c.x, a.x), cy = difference_of(c.y, a.y), cz = difference_of(c.z, a.z);
  const Two dx = difference_of(d.x, a.x), dy = difference_of(d.y, a.y), dz = difference_of(d.z, a.z);
  Expansion sum(parts);
  sum.add_product(bx, cy, dz, 1);
  sum.add_product(by, cz, dx, 1);
  sum.add_product(bz, cx, dy, 1);
  sum.add_product(bx, cz, dy, -1);
  sum.add_product(by, cx, dz, -1);
  sum.add_product(bz, cy, dx, -1);
  return sum.value();
}

/// Decides by twofold arithmetic, or exactly if its error bound leaves the sign open. `beyond`: how many times larger
/// than its error bound a value must be.
template <class Level, class Twofold, class Exact>
STANDOFF_HD inline double value_of_determinant(const RoundedDeterminant& first, double bound, double beyond,
                                               const Level& is_level, const Twofold& twofold, const Exact& exactly) {
  if (abs(first.value) > beyond * (bound * first.magnitude) + kTwofoldUnderflow) return first.value;
  if (is_level()) return 0;
  const double second = twofold().value;
  if (abs(second) > beyond * (kTwofoldBound * first.magnitude) + kTwofoldUnderflow) return second;
  return exactly();
}

}  // namespace standoff
