// SPDX-License-Identifier: Apache-2.0
// Every operation on eight doubles of every SIMD target against plain numbers, lane by lane and bit by bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "geometry/triple.h"
#include "tests/simd/operations/operations.h"
#include "tests/simd/operations/targets.h"

namespace standoff::testing {
namespace {

constexpr int kDoubleLanes = 8;
using DoubleLanes = std::array<double, kDoubleLanes>;

// Ordinary numbers, and those that instructions treat each in its own way.
class Doubles {
 public:
  DoubleLanes lanes() {
    DoubleLanes lanes;
    for (double& lane : lanes) lane = next();
    return lanes;
  }
  Bits bits() { return static_cast<Bits>(random_() & 0xff); }
  double next() {
    using Limits = std::numeric_limits<double>;
    constexpr std::array kOdd{0.0,
                              -0.0,
                              1.0,
                              -1.0,
                              Limits::infinity(),
                              -Limits::infinity(),
                              Limits::quiet_NaN(),
                              Limits::denorm_min(),
                              -Limits::min(),
                              Limits::max()};
    if (random_() % 3 == 0) return kOdd[random_() % kOdd.size()];
    return std::ldexp(static_cast<double>(random_()) - 0x1p63, static_cast<int>(random_() % 20) - 72);
  }

 private:
  std::mt19937_64 random_{7};
};

// Not-a-numbers are alike; everything else must be so to the last bit, the sign of zero included.
void expect_same(double expected, double found) {
  if (std::isnan(expected) && std::isnan(found)) return;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(expected), std::bit_cast<std::uint64_t>(found)) << expected << " " << found;
}

template <class Check>
void for_double_targets(Check check) {
  for (const SimdOperations* target : targets()) {
    SCOPED_TRACE(target->name);
    Doubles numbers;
    for (int n = 0; n < 200; ++n) check(target->doubles, numbers);
  }
}

TEST(WideDouble, OperationsOnTwoNumbers) {
  struct Row {
    void (*DoubleOperations::*wide)(const double*, const double*, double*);
    double (*plain)(double, double);
  };
  const Row rows[] = {
      {&DoubleOperations::add, [](double a, double b) { return a + b; }},
      {&DoubleOperations::subtract, [](double a, double b) { return a - b; }},
      {&DoubleOperations::multiply, [](double a, double b) { return a * b; }},
      {&DoubleOperations::divide, [](double a, double b) { return a / b; }},
      {&DoubleOperations::min, [](double a, double b) { return standoff::min(a, b); }},
      {&DoubleOperations::max, [](double a, double b) { return standoff::max(a, b); }},
  };
  for_double_targets([&](const DoubleOperations& target, Doubles& numbers) {
    const DoubleLanes a = numbers.lanes(), b = numbers.lanes();
    for (const Row& row : rows) {
      DoubleLanes out;
      (target.*row.wide)(a.data(), b.data(), out.data());
      for (int n = 0; n < kDoubleLanes; ++n) expect_same(row.plain(a[n], b[n]), out[n]);
    }
  });
}

TEST(WideDouble, OperationsOnOneNumber) {
  for_double_targets([&](const DoubleOperations& target, Doubles& numbers) {
    const DoubleLanes a = numbers.lanes();
    DoubleLanes negative, root, same;
    target.negate(a.data(), negative.data());
    target.sqrt(a.data(), root.data());
    target.broadcast(a[0], same.data());
    for (int n = 0; n < kDoubleLanes; ++n) {
      expect_same(-a[n], negative[n]);
      expect_same(standoff::sqrt(a[n]), root[n]);
      expect_same(a[0], same[n]);
    }
  });
}

// One rounding: c is what is left of a * b, nearly, so that two roundings would leave nothing of it.
TEST(WideDouble, MultiplyAndAddAtOnce) {
  for_double_targets([&](const DoubleOperations& target, Doubles& numbers) {
    const DoubleLanes a = numbers.lanes(), b = numbers.lanes();
    DoubleLanes c = numbers.lanes(), out;
    for (int n = 0; n < kDoubleLanes; n += 2) c[n] = -(a[n] * b[n]);
    target.fma(a.data(), b.data(), c.data(), out.data());
    for (int n = 0; n < kDoubleLanes; ++n) expect_same(std::fma(a[n], b[n], c[n]), out[n]);
  });
}

TEST(WideDouble, MasksAndWhatTheySelect) {
  for_double_targets([](const DoubleOperations& target, Doubles& numbers) {
    const DoubleLanes a = numbers.lanes();
    DoubleLanes b = numbers.lanes(), out;
    b[5] = a[5];
    Bits less = 0;
    for (int n = 0; n < kDoubleLanes; ++n) less |= Bits{a[n] < b[n]} << n;
    EXPECT_EQ(target.less(a.data(), b.data()), less);

    const Bits m = numbers.bits(), other = numbers.bits();
    EXPECT_EQ(target.mask_not(m), ~m & 0xff);
    EXPECT_EQ(target.mask_and(m, other), m & other);
    EXPECT_EQ(target.mask_or(m, other), m | other);
    EXPECT_EQ(target.mask_xor(m, other), m ^ other);
    target.select(m, a.data(), b.data(), out.data());
    for (int n = 0; n < kDoubleLanes; ++n) expect_same(m >> n & 1 ? a[n] : b[n], out[n]);
  });
}

TEST(WideDouble, RowsAndColumns) {
  for_double_targets([](const DoubleOperations& target, Doubles& numbers) {
    alignas(32) double rows[kDoubleLanes][4];
    for (auto& row : rows) {
      // No fourth number is read of v; the one of the center is zero.
      const std::array v{numbers.next(), numbers.next(), numbers.next()};
      const std::array center{numbers.next(), numbers.next(), numbers.next(), 0.0};
      target.store_local(v.data(), 0.5, center.data(), row);
      for (std::size_t n = 0; n < 3; ++n) expect_same(std::fma(v[n], 0.5, -center[n]), row[n]);
      EXPECT_EQ(row[3], 0);
    }
    for (int axis = 0; axis < 4; ++axis) {
      DoubleLanes out;
      target.load_column(rows, axis, out.data());
      for (int n = 0; n < kDoubleLanes; ++n) expect_same(rows[n][axis], out[static_cast<std::size_t>(n)]);
    }
  });
}

TEST(WideDouble, OneLaneAndTables) {
  for_double_targets([](const DoubleOperations& target, Doubles& numbers) {
    const DoubleLanes a = numbers.lanes();
    DoubleLanes out;
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      target.of_lane(a.data(), lane, out.data());
      for (const double one : out) expect_same(a[static_cast<std::size_t>(lane)], one);
    }
    double table[8];
    std::copy(a.begin(), a.end(), table);
    // Other bits than the three count for nothing.
    const std::array<std::uint32_t, 8> low{0, 7, 9, 0xffffffff, 3, 0x1fa, 64, 5};
    for (const std::size_t n : {0, 1}) {
      target.look_up[n](table, low.data(), out.data());
      for (std::size_t k = 0; k < low.size(); ++k) expect_same(table[low[k] >> 6 * n & 7], out[k]);
    }
  });
}

TEST(WideDouble, RoundsToFloats) {
  for_double_targets([](const DoubleOperations& target, Doubles& numbers) {
    const DoubleLanes a = numbers.lanes(), b = numbers.lanes();
    float out[kDoubleLanes], pairs[kDoubleLanes][2];
    target.round(a.data(), out);
    target.round_pairs(a.data(), b.data(), pairs);
    for (std::size_t n = 0; n < a.size(); ++n) {
      const auto first = static_cast<float>(a[n]), second = static_cast<float>(b[n]);
      EXPECT_EQ(std::bit_cast<std::uint32_t>(out[n]), std::bit_cast<std::uint32_t>(first));
      EXPECT_EQ(std::bit_cast<std::uint32_t>(pairs[n][0]), std::bit_cast<std::uint32_t>(first));
      EXPECT_EQ(std::bit_cast<std::uint32_t>(pairs[n][1]), std::bit_cast<std::uint32_t>(second));
    }
  });
}

}  // namespace
}  // namespace standoff::testing
