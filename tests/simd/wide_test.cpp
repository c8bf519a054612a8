// SPDX-License-Identifier: Apache-2.0
// Every operation of every SIMD target against plain numbers, lane by lane and bit by bit: that the targets agree is
// what "the same bits on every processor" rests on.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "geometry/triple.h"
#include "tests/simd/operations/operations.h"
#include "tests/simd/operations/targets.h"

namespace standoff::testing {
namespace {

constexpr int kLanes = 16;
using Lanes = std::array<float, kLanes>;
using UintLanes = std::array<std::uint32_t, kLanes>;

// Ordinary numbers, and those that instructions treat each in its own way.
class Numbers {
 public:
  float next() {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    constexpr std::array kOdd{0.0f,
                              -0.0f,
                              1.0f,
                              -1.0f,
                              kInfinite,
                              -kInfinite,
                              std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::denorm_min(),
                              -std::numeric_limits<float>::min(),
                              std::numeric_limits<float>::max()};
    if (random() % 3 == 0) return kOdd[random() % kOdd.size()];
    return ordinary();
  }
  float ordinary() { return std::ldexp(static_cast<float>(random()) - 2147483648.0f, int(random() % 20) - 40); }
  Lanes lanes() {
    Lanes lanes;
    for (float& lane : lanes) lane = next();
    return lanes;
  }
  Lanes ordinary_lanes() {
    Lanes lanes;
    for (float& lane : lanes) lane = ordinary();
    return lanes;
  }
  // Around the places where a comparison of signed numbers would go wrong.
  UintLanes uints() {
    UintLanes lanes;
    for (auto& lane : lanes) lane = (random() % 2 ? 0x80000000u : 0u) + (random() % 5 - 2u);
    return lanes;
  }
  Bits bits() { return random() & 0xffff; }

 private:
  std::uint32_t random() { return static_cast<std::uint32_t>(random_()); }

  std::mt19937 random_{11};
};

// Not-a-numbers are alike; everything else must be so to the last bit, the sign of zero included.
void expect_same(float expected, float found) {
  if (std::isnan(expected) && std::isnan(found)) return;
  EXPECT_EQ(std::bit_cast<std::uint32_t>(expected), std::bit_cast<std::uint32_t>(found)) << expected << " " << found;
}

template <class Check>
void for_targets(Check check) {
  for (const SimdOperations* target : targets()) {
    SCOPED_TRACE(target->name);
    Numbers numbers;
    for (int n = 0; n < 200; ++n) check(*target, numbers);
  }
}

TEST(Simd, TargetsOfThisProcessor) {
  for (const SimdOperations* target : targets()) RecordProperty(target->name, "tested");
  EXPECT_GE(targets().size(), 1u);
}

TEST(Simd, OperationsOnTwoNumbers) {
  struct Row {
    void (*SimdOperations::*wide)(Floats, Floats, float*);
    float (*plain)(float, float);
  };
  const Row rows[] = {
      {&SimdOperations::add, [](float a, float b) { return a + b; }},
      {&SimdOperations::subtract, [](float a, float b) { return a - b; }},
      {&SimdOperations::multiply, [](float a, float b) { return a * b; }},
      {&SimdOperations::divide, [](float a, float b) { return a / b; }},
      {&SimdOperations::min, [](float a, float b) { return standoff::min(a, b); }},
      {&SimdOperations::max, [](float a, float b) { return standoff::max(a, b); }},
  };
  for_targets([&](const SimdOperations& target, Numbers& numbers) {
    const Lanes a = numbers.lanes(), b = numbers.lanes();
    for (const Row& row : rows) {
      Lanes out;
      (target.*row.wide)(a.data(), b.data(), out.data());
      for (int n = 0; n < kLanes; ++n) expect_same(row.plain(a[n], b[n]), out[n]);
    }
  });
}

TEST(Simd, OperationsOnOneNumber) {
  struct Row {
    void (*SimdOperations::*wide)(Floats, float*);
    float (*plain)(float);
  };
  const Row rows[] = {
      {&SimdOperations::negate, [](float a) { return -a; }},
      {&SimdOperations::sqrt, [](float a) { return standoff::sqrt(a); }},
      {&SimdOperations::abs, [](float a) { return standoff::abs(a); }},
  };
  for_targets([&](const SimdOperations& target, Numbers& numbers) {
    const Lanes a = numbers.lanes();
    for (const Row& row : rows) {
      Lanes out;
      (target.*row.wide)(a.data(), out.data());
      for (int n = 0; n < kLanes; ++n) expect_same(row.plain(a[n]), out[n]);
    }
  });
}

TEST(Simd, FmaRoundsOnce) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    const Lanes a = numbers.lanes(), b = numbers.lanes();
    Lanes c = numbers.lanes(), out;
    // Minus the product, rounded: what is left is the rounding, which two roundings would lose.
    for (int n = 0; n < kLanes; n += 2) c[n] = -(a[n] * b[n]);
    target.fma(a.data(), b.data(), c.data(), out.data());
    for (int n = 0; n < kLanes; ++n) expect_same(std::fma(a[n], b[n], c[n]), out[n]);
  });
}

TEST(Simd, Broadcasts) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    const float number = numbers.next();
    const auto whole = static_cast<int>(numbers.bits()) - 0x8000;
    const std::uint32_t uint = numbers.uints()[0];
    Lanes out, out_int;
    UintLanes out_uint, lane_numbers;
    target.broadcast(number, out.data());
    target.broadcast_int(whole, out_int.data());
    target.broadcast_uint(uint, out_uint.data());
    target.lane_numbers(lane_numbers.data());
    for (int n = 0; n < kLanes; ++n) {
      expect_same(number, out[n]);
      expect_same(static_cast<float>(whole), out_int[n]);
      EXPECT_EQ(out_uint[n], uint);
      EXPECT_EQ(lane_numbers[n], static_cast<std::uint32_t>(n));
    }
  });
}

TEST(Simd, Reductions) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    const Lanes a = numbers.ordinary_lanes();
    EXPECT_EQ(target.reduce_max(a.data()), *std::ranges::max_element(a));
    EXPECT_EQ(target.reduce_min(a.data()), *std::ranges::min_element(a));
  });
  // Each lane has its turn.
  for (const SimdOperations* target : targets())
    for (int n = 0; n < kLanes; ++n) {
      Lanes a{};
      a[n] = 1;
      EXPECT_EQ(target->reduce_max(a.data()), 1) << target->name << " " << n;
      a[n] = -1;
      EXPECT_EQ(target->reduce_min(a.data()), -1) << target->name << " " << n;
    }
}

TEST(Simd, TruncatesTowardsZero) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    Lanes a;
    for (float& lane : a) lane = std::ldexp(numbers.ordinary(), -3);
    a[3] = -0.75f, a[4] = 0.75f, a[5] = -1.5f;
    std::array<int, kLanes> out;
    target.truncate(a.data(), out.data());
    for (int n = 0; n < kLanes; ++n) EXPECT_EQ(out[n], static_cast<int>(a[n]));
  });
}

TEST(Simd, Comparisons) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    const Lanes a = numbers.lanes();
    Lanes b = numbers.lanes();
    b[2] = a[2], b[15] = a[15];
    const UintLanes c = numbers.uints();
    UintLanes d = numbers.uints();
    d[0] = c[0], d[9] = c[9];
    Bits less = 0, less_equal = 0, equal = 0, less_uints = 0, equal_uints = 0;
    for (int n = 0; n < kLanes; ++n) {
      less |= Bits{a[n] < b[n]} << n;
      less_equal |= Bits{a[n] <= b[n]} << n;
      equal |= Bits{a[n] == b[n]} << n;
      less_uints |= Bits{c[n] < d[n]} << n;
      equal_uints |= Bits{c[n] == d[n]} << n;
    }
    EXPECT_EQ(target.less(a.data(), b.data()), less);
    EXPECT_EQ(target.less_equal(a.data(), b.data()), less_equal);
    EXPECT_EQ(target.equal(a.data(), b.data()), equal);
    EXPECT_EQ(target.less_uints(c.data(), d.data()), less_uints);
    EXPECT_EQ(target.equal_uints(c.data(), d.data()), equal_uints);
  });
}

TEST(Simd, Masks) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    const Bits m = numbers.bits(), other = numbers.bits();
    EXPECT_EQ(target.mask_not(m), ~m & 0xffff);
    EXPECT_EQ(target.mask_and(m, other), m & other);
    EXPECT_EQ(target.mask_or(m, other), m | other);

    const Lanes yes = numbers.lanes(), no = numbers.lanes();
    const UintLanes yes_uints = numbers.uints(), no_uints = numbers.uints();
    Lanes out;
    UintLanes out_uints;
    target.select(m, yes.data(), no.data(), out.data());
    target.select_uints(m, yes_uints.data(), no_uints.data(), out_uints.data());
    for (int n = 0; n < kLanes; ++n) {
      expect_same(m >> n & 1 ? yes[n] : no[n], out[n]);
      EXPECT_EQ(out_uints[n], m >> n & 1 ? yes_uints[n] : no_uints[n]);
    }
  });
}

TEST(Simd, PacksTheLanesOfAMask) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    const Bits m = numbers.bits();
    const Lanes a = numbers.lanes();
    const UintLanes b = numbers.uints();
    Lanes out;
    UintLanes out_uints;
    target.pack(m, a.data(), out.data());
    EXPECT_EQ(target.pack_uints(m, b.data(), out_uints.data()), std::popcount(m));
    int packed = 0;
    for (int n = 0; n < kLanes; ++n) {
      if (!(m >> n & 1)) continue;
      expect_same(a[n], out[packed]);
      EXPECT_EQ(out_uints[packed++], b[n]);
    }
  });
}

TEST(Simd, LoadsColumnsOfRows) {
  float rows[kLanes][4];
  for (int n = 0; n < kLanes; ++n)
    for (int axis = 0; axis < 4; ++axis) rows[n][axis] = static_cast<float>(10 * n + axis);
  for (const SimdOperations* target : targets())
    for (int axis = 0; axis < 3; ++axis) {
      Lanes out;
      target->load_column(rows, axis, out.data());
      for (int n = 0; n < kLanes; ++n) EXPECT_EQ(out[n], static_cast<float>(10 * n + axis)) << target->name;
    }
}

// Far from the origin the difference must be taken in double, and rounded once to double and once to float. Real scales
// are powers of two, for which a second rounding would not show.
TEST(Simd, StoresPointsRelativeToACentre) {
  for_targets([](const SimdOperations& target, Numbers& numbers) {
    std::array<double, 3> v;
    std::array<double, 4> center{};
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = 1e6 * numbers.ordinary();
      v[axis] = (center[axis] + 1e-3 * numbers.ordinary()) / 3;
    }
    alignas(16) std::array<float, 4> out;
    target.store_local(v.data(), 3, center.data(), out.data());
    for (int axis = 0; axis < 3; ++axis)
      expect_same(static_cast<float>(std::fma(v[axis], 3.0, -center[axis])), out[axis]);
    EXPECT_EQ(out[3], 0);
  });
}

}  // namespace
}  // namespace standoff::testing
