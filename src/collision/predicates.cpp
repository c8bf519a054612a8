// After Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates (1997): his first
// stage with its error bound, and in place of the others the sum of all products, exactly.
#include "collision/predicates.h"

#include <array>
#include <cmath>

namespace difi {
namespace {

constexpr double kEps = 0x1p-53;
// Shewchuk's bound of the first stage, in terms of the sum of the products' magnitudes.
constexpr double kBound2d = (3 + 16 * kEps) * kEps;

// Where a determinant is not small against its products, the bounds leave its value no farther off than 4e-15 of it.
constexpr double kTellsValue = 0.25, kTellsValueAbove = 1e-280;

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

// A sum of doubles, exact: its parts do not overlap and grow in magnitude.
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
  // The sum, rounded: the sign is that of its largest part.
  double value() const {
    double sum = 0;
    for (int n = 0; n < count_; ++n) sum += parts_[n];
    return sum;
  }

 private:
  std::array<double, 200> parts_;  // as many as are ever added: 6 permutations, 8 choices of parts, 4 parts of each
  int count_ = 0;
};

// The difference b - a: two parts, exact.
using Parts = std::array<double, 2>;
Parts difference(double a, double b) {
  const Two d = two_sum(b, -a);
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

RoundedDeterminant rounded_determinant2d(const Flat& a, const Flat& b, const Flat& c) {
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  return {left - right, std::abs(left) + std::abs(right)};
}

double determinant2d_exactly(const Flat& a, const Flat& b, const Flat& c) {
  const Parts one = {1, 0};
  Expansion sum;
  add_product(sum, difference(a.x, b.x), difference(a.y, c.y), one, 1);
  add_product(sum, difference(a.y, b.y), difference(a.x, c.x), one, -1);
  return sum.value();
}

}  // namespace

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

double determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const RoundedDeterminant det = rounded_determinant3d(a, b, c, d);
  if (std::abs(det.value) > kTellsValue * det.magnitude + kTellsValueAbove) return det.value;
  return determinant3d_exactly(a, b, c, d);
}

int orient2d(const Flat& a, const Flat& b, const Flat& c) {
  const RoundedDeterminant det = rounded_determinant2d(a, b, c);
  const double bound = kBound2d * det.magnitude + 1e-290;
  if (std::abs(det.value) > bound) return det.value > 0 ? 1 : -1;
  const double exact = determinant2d_exactly(a, b, c);
  return exact > 0 ? 1 : exact < 0 ? -1 : 0;
}

double determinant2d(const Flat& a, const Flat& b, const Flat& c) {
  const RoundedDeterminant det = rounded_determinant2d(a, b, c);
  if (std::abs(det.value) > kTellsValue * det.magnitude + kTellsValueAbove) return det.value;
  return determinant2d_exactly(a, b, c);
}

}  // namespace difi
