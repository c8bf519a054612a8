// SPDX-License-Identifier: Apache-2.0
// Whole numbers of so many 64-bit limbs, without rounding and without memory of their own: exact answers about millions
// of triangles. Products have as many limbs as both factors, so nothing overflows but sums (see touch.h for how much
// room those are left). exact_sign.h does the same for numbers of any length; tests compare both.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace standoff::testing {

template <int kLimbs>
struct Integer {
  std::array<std::uint64_t, kLimbs> limbs{};  // two's complement, the lowest first

  bool negative() const { return static_cast<std::int64_t>(limbs[kLimbs - 1]) < 0; }
  bool zero() const {
    for (const std::uint64_t limb : limbs)
      if (limb != 0) return false;
    return true;
  }

  friend Integer operator+(const Integer& a, const Integer& b) {
    Integer c;
    bool carry = false;
    for (int n = 0; n < kLimbs; ++n) {
      const std::uint64_t sum = a.limbs[n] + b.limbs[n];
      c.limbs[n] = sum + carry;
      carry = sum < a.limbs[n] || c.limbs[n] < sum;
    }
    return c;
  }
  friend Integer operator-(const Integer& a, const Integer& b) {
    Integer c;
    bool borrow = false;
    for (int n = 0; n < kLimbs; ++n) {
      const std::uint64_t rest = a.limbs[n] - b.limbs[n];
      c.limbs[n] = rest - borrow;
      borrow = a.limbs[n] < b.limbs[n] || rest < static_cast<std::uint64_t>(borrow);
    }
    return c;
  }
  friend bool operator<(const Integer& a, const Integer& b) { return (a - b).negative(); }
  friend bool operator==(const Integer&, const Integer&) = default;
};

template <int kA, int kB>
Integer<kA + kB> operator*(const Integer<kA>& a, const Integer<kB>& b) {
  __extension__ using Wide = unsigned __int128;
  Integer<kA + kB> c;
  for (int i = 0; i < kA; ++i) {
    std::uint64_t carry = 0;
    for (int j = 0; j < kB; ++j) {
      const Wide sum = Wide{a.limbs[i]} * b.limbs[j] + c.limbs[i + j] + carry;
      c.limbs[i + j] = static_cast<std::uint64_t>(sum);
      carry = static_cast<std::uint64_t>(sum >> 64);
    }
    c.limbs[i + kB] = carry;
  }
  // So far both counted as unsigned: a negative one as 2^(64 limbs) too much.
  const auto take_from_the_top = [&c](const auto& limbs, int from) {
    bool borrow = false;
    for (std::size_t n = 0; n < limbs.size(); ++n) {
      const std::uint64_t before = c.limbs[from + n], rest = before - limbs[n];
      c.limbs[from + n] = rest - borrow;
      borrow = before < limbs[n] || rest < static_cast<std::uint64_t>(borrow);
    }
  };
  if (a.negative()) take_from_the_top(b.limbs, kA);
  if (b.negative()) take_from_the_top(a.limbs, kB);
  return c;
}

/// value / 2^exponent. Requires that this is whole and fits.
template <int kLimbs>
Integer<kLimbs> integer_of(double value, int exponent) {
  Integer<kLimbs> whole;
  if (value == 0) return whole;
  const int own = std::ilogb(value) - 52;
  auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::abs(value), -own));
  if (own < exponent) {
    whole.limbs[0] = mantissa >> (exponent - own);
  } else {
    const int limb = (own - exponent) / 64, bit = (own - exponent) % 64;
    whole.limbs[limb] = mantissa << bit;
    if (bit > 0 && limb + 1 < kLimbs) whole.limbs[limb + 1] = mantissa >> (64 - bit);
  }
  return value < 0 ? Integer<kLimbs>{} - whole : whole;
}

/// The number as a floating point one, rounded to its digits.
template <class Float, int kLimbs>
Float float_of(const Integer<kLimbs>& whole) {
  if (whole.negative()) return -float_of<Float>(Integer<kLimbs>{} - whole);
  Float sum = 0;
  for (int n = kLimbs - 1; n >= 0; --n) sum = sum * Float(0x1p64) + Float(whole.limbs[n]);
  return sum;
}

/// The exponent of the lowest bit set of a double; of zero, one that is higher than all.
inline int lowest_bit(double value) {
  if (value == 0) return 1 << 20;
  const int own = std::ilogb(value) - 52;
  return own + std::countr_zero(static_cast<std::uint64_t>(std::ldexp(std::abs(value), -own)));
}

}  // namespace standoff::testing
