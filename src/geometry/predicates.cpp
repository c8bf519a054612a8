// SPDX-License-Identifier: Apache-2.0
// After Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates (1997): his first
// stage with its error bound; then twofold arithmetic, where a number is the sum of two doubles; and if these 100 bits
// do not decide, the exact sum of all products.
#include "geometry/predicates.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace standoff {
namespace {

// The error of a determinant in twofold arithmetic: a share of the sum of its products' magnitudes, and underflow.
constexpr double kTwofoldBound = 0x1p-97, kUnderflow = 1e-250;
// If a determinant is this many times larger than its error, its relative error is below 4e-15.
constexpr double kTellsValue = 0x1p48;

// value + tail is the exact result.
struct Two {
  double value, tail;
};
Two two_sum(double a, double b) {
  const double sum = a + b, bb = sum - a;
  return {sum, (a - (sum - bb)) + (b - bb)};
}
Two two_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

Two difference_of(double a, double b) { return two_sum(a, -b); }
Two operator-(const Two& a) { return {-a.value, -a.tail}; }
Two operator+(const Two& a, const Two& b) {
  const Two sum = two_sum(a.value, b.value);
  return two_sum(sum.value, sum.tail + (a.tail + b.tail));
}
Two operator-(const Two& a, const Two& b) { return a + -b; }
Two operator*(const Two& a, const Two& b) {
  const Two product = two_product(a.value, b.value);
  return two_sum(product.value, product.tail + (a.value * b.tail + a.tail * b.value));
}

// An exact sum of doubles: its parts do not overlap, and grow in magnitude.
class Expansion {
 public:
  void add(double value) {
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
  // The rounded sum. Its sign is the sign of the largest part.
  double value() const {
    double sum = 0;
    for (int n = 0; n < count_; ++n) sum += parts_[n];
    return sum;
  }

 private:
  std::array<double, 200> parts_;  // at most 192 are added: 6 permutations, 8 choices of parts, 4 parts of each
  int count_ = 0;
};

// The exact difference b - a, in two parts.
using Parts = std::array<double, 2>;
Parts difference(double a, double b) {
  const Two d = difference_of(b, a);
  return {d.value, d.tail};
}

void add_product(Expansion& sum, const Parts& x, const Parts& y, const Parts& z, double factor) {
  for (const double i : x)
    for (const double j : y) {
      if (i == 0 || j == 0) continue;
      const Two ij = two_product(i, j);
      for (const double k : z) {
        if (k == 0) continue;
        const Two high = two_product(ij.value, k * factor), low = two_product(ij.tail, k * factor);
        for (const double part : {low.tail, low.value, high.tail, high.value}) sum.add(part);
      }
    }
}

Two twofold_determinant2d(const Flat& a, const Flat& b, const Flat& c) {
  return difference_of(b.x, a.x) * difference_of(c.y, a.y) - difference_of(b.y, a.y) * difference_of(c.x, a.x);
}

Two twofold_determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto edge = [&a](const Vec3& to) {
    return std::array<Two, 3>{difference_of(to.x, a.x), difference_of(to.y, a.y), difference_of(to.z, a.z)};
  };
  const std::array<Two, 3> u = edge(b), v = edge(c), w = edge(d);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

double determinant2d_exactly(const Flat& a, const Flat& b, const Flat& c) {
  const Parts one = {1, 0};
  Expansion sum;
  add_product(sum, difference(a.x, b.x), difference(a.y, c.y), one, 1);
  add_product(sum, difference(a.y, b.y), difference(a.x, c.x), one, -1);
  return sum.value();
}

double determinant3d_exactly(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Parts bx = difference(a.x, b.x), by = difference(a.y, b.y), bz = difference(a.z, b.z);
  const Parts cx = difference(a.x, c.x), cy = difference(a.y, c.y), cz = difference(a.z, c.z);
  const Parts dx = difference(a.x, d.x), dy = difference(a.y, d.y), dz = difference(a.z, d.z);
  Expansion sum;
  add_product(sum, bx, cy, dz, 1);
  add_product(sum, by, cz, dx, 1);
  add_product(sum, bz, cx, dy, 1);
  add_product(sum, bx, cz, dy, -1);
  add_product(sum, by, cx, dz, -1);
  add_product(sum, bz, cy, dx, -1);
  return sum.value();
}

// Decides by twofold arithmetic, or exactly if its error bound leaves the sign open. `is_level`: whether the points'
// coordinates along an axis are equal, as they are in most planes that hold several triangles; then the determinant is
// 0.
template <class Level, class Twofold, class Exact>
double value_of(const RoundedDeterminant& first, double bound, double beyond, Level is_level, Twofold twofold,
                Exact exactly) {
  if (std::abs(first.value) > beyond * (bound * first.magnitude) + kUnderflow) return first.value;
  if (is_level()) return 0;
  const double second = twofold().value;
  if (std::abs(second) > beyond * (kTwofoldBound * first.magnitude) + kUnderflow) return second;
  return exactly();
}

bool are_level(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (a.x == b.x && a.x == c.x && a.x == d.x) || (a.y == b.y && a.y == c.y && a.y == d.y) ||
         (a.z == b.z && a.z == c.z && a.z == d.z);
}
bool are_level(const Flat& a, const Flat& b, const Flat& c) {
  return (a.x == b.x && a.x == c.x) || (a.y == b.y && a.y == c.y);
}

double value_of_determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double beyond) {
  return value_of(
      rounded_determinant3d(a, b, c, d), kRounded3d, beyond, [&] { return are_level(a, b, c, d); },
      [&] { return twofold_determinant3d(a, b, c, d); }, [&] { return determinant3d_exactly(a, b, c, d); });
}
double value_of_determinant2d(const Flat& a, const Flat& b, const Flat& c, double beyond) {
  return value_of(
      rounded_determinant2d(a, b, c), kRounded2d, beyond, [&] { return are_level(a, b, c); },
      [&] { return twofold_determinant2d(a, b, c); }, [&] { return determinant2d_exactly(a, b, c); });
}

int sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

}  // namespace

int orient3d_beyond_rounding(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return sign(value_of_determinant3d(a, b, c, d, 1));
}
double determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return value_of_determinant3d(a, b, c, d, kTellsValue);
}

int orient2d_beyond_rounding(const Flat& a, const Flat& b, const Flat& c) {
  return sign(value_of_determinant2d(a, b, c, 1));
}
double determinant2d(const Flat& a, const Flat& b, const Flat& c) {
  return value_of_determinant2d(a, b, c, kTellsValue);
}

namespace {

bool between(double v, double a, double b) { return (a <= v && v <= b) || (b <= v && v <= a); }
bool in_box(const Flat& p, const Flat& a, const Flat& b) { return between(p.x, a.x, b.x) && between(p.y, a.y, b.y); }

bool segments_intersect(const Flat& p, const Flat& q, const Flat& a, const Flat& b) {
  const int pa = orient2d(p, q, a), pb = orient2d(p, q, b), ap = orient2d(a, b, p), aq = orient2d(a, b, q);
  if (pa * pb < 0 && ap * aq < 0) return true;
  return (pa == 0 && in_box(a, p, q)) || (pb == 0 && in_box(b, p, q)) || (ap == 0 && in_box(p, a, b)) ||
         (aq == 0 && in_box(q, a, b));
}

bool extents_overlap(double p, double q, double a, double b) {
  return std::max(std::min(p, q), std::min(a, b)) <= std::min(std::max(p, q), std::max(a, b));
}

bool in_triangle(const Flat& p, const Flat& a, const Flat& b, const Flat& c) {
  const int ab = orient2d(a, b, p), bc = orient2d(b, c, p), ca = orient2d(c, a, p);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

}  // namespace

int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (orient2d(dropped(a, axis), dropped(b, axis), dropped(c, axis)) != 0) return axis;
  return -1;
}

int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  int axis = upright_axis(a, b, c);
  if (axis < 0) axis = upright_axis(a, b, d);
  if (axis < 0) axis = upright_axis(c, d, a);
  if (axis < 0) axis = upright_axis(c, d, b);
  return axis;
}

bool segments_intersect(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  if (orient3d(p, q, a, b) != 0) return false;
  const int axis = upright_axis(p, q, a, b);
  if (axis >= 0) return segments_intersect(dropped(p, axis), dropped(q, axis), dropped(a, axis), dropped(b, axis));
  return extents_overlap(p.x, q.x, a.x, b.x) && extents_overlap(p.y, q.y, a.y, b.y) &&
         extents_overlap(p.z, q.z, a.z, b.z);
}

bool intersects_in_plane(const Vec3& p, const Vec3& q, const Corners& t) {
  const int axis = upright_axis(t[0], t[1], t[2]);
  if (axis < 0)
    return segments_intersect(p, q, t[0], t[1]) || segments_intersect(p, q, t[1], t[2]) ||
           segments_intersect(p, q, t[2], t[0]);
  const Flat a = dropped(t[0], axis), b = dropped(t[1], axis), c = dropped(t[2], axis);
  const Flat u = dropped(p, axis), v = dropped(q, axis);
  return in_triangle(u, a, b, c) || in_triangle(v, a, b, c) || segments_intersect(u, v, a, b) ||
         segments_intersect(u, v, b, c) || segments_intersect(u, v, c, a);
}

}  // namespace standoff
