// SPDX-License-Identifier: Apache-2.0
// What the flags of the build must keep: a float is rounded, whatever is packed with it.
#include <gtest/gtest.h>

#include <array>

#include "standoff/vec.h"

namespace standoff {
namespace {

// Far from constants, and one by one: the numbers to compare with.
[[gnu::noinline]] double through_float(double x) {
  const volatile float rounded = static_cast<float>(x);
  return rounded;
}

[[gnu::noinline]] Vec3 rounded(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

[[gnu::noinline]] Vec3 what_rounding_takes(const Vec3& v) {
  return {v.x - static_cast<double>(static_cast<float>(v.x)), v.y - static_cast<double>(static_cast<float>(v.y)),
          v.z - static_cast<double>(static_cast<float>(v.z))};
}

[[gnu::noinline]] std::array<double, 4> rounded(const std::array<double, 4>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(v[3])};
}

// GCC 12.2 at -O2 made of two neighbours one packed move and left their digits as they were; so it did with four where
// registers are wider. -fno-tree-slp-vectorize (cmake/compiler.cmake) is why it does not here.
TEST(Rounding, NeighboursAreRoundedToFloat) {
  const Vec3 v{0.1, 0.2, 0.3};
  EXPECT_EQ(rounded(v), (Vec3{through_float(0.1), through_float(0.2), through_float(0.3)}));
  EXPECT_NE(rounded(v), v);
  const Vec3 left = what_rounding_takes(v);
  EXPECT_EQ(left, (Vec3{0.1 - through_float(0.1), 0.2 - through_float(0.2), 0.3 - through_float(0.3)}));
  const std::array<double, 4> four{0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(rounded(four),
            (std::array<double, 4>{through_float(0.1), through_float(0.2), through_float(0.3), through_float(0.4)}));
}

}  // namespace
}  // namespace standoff
