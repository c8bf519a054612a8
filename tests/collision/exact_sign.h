// SPDX-License-Identifier: Apache-2.0
// Integers of any length, and doubles as scaled integers: arithmetic without rounding, to test exact predicates. It is
// slow, and shares nothing with src/geometry/predicates.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace standoff::testing {

class Whole {
 public:
  Whole() = default;
  /// mantissa * 2^shift, shift >= 0.
  Whole(std::int64_t mantissa, int shift) : negative_(mantissa < 0) {
    std::uint64_t rest = negative_ ? 0 - static_cast<std::uint64_t>(mantissa) : static_cast<std::uint64_t>(mantissa);
    limbs_.assign(static_cast<std::size_t>(shift / 32), 0);
    const int bits = shift % 32;
    std::uint64_t carry = 0;
    for (; rest != 0 || carry != 0; rest >>= 32) {
      const std::uint64_t part = (rest & 0xffffffffu) << bits | carry;
      limbs_.push_back(static_cast<std::uint32_t>(part));
      carry = part >> 32;
    }
    trim();
  }

  friend Whole operator*(const Whole& a, const Whole& b) {
    Whole c;
    c.negative_ = a.negative_ != b.negative_;
    c.limbs_.assign(a.limbs_.size() + b.limbs_.size(), 0);
    for (std::size_t i = 0; i < a.limbs_.size(); ++i) {
      std::uint64_t carry = 0;
      for (std::size_t j = 0; j < b.limbs_.size() || carry != 0; ++j) {
        const std::uint64_t sum = c.limbs_[i + j] + carry +
                                  (j < b.limbs_.size() ? std::uint64_t{a.limbs_[i]} * b.limbs_[j] : std::uint64_t{0});
        c.limbs_[i + j] = static_cast<std::uint32_t>(sum);
        carry = sum >> 32;
      }
    }
    c.trim();
    return c;
  }
  friend Whole operator-(const Whole& a) {
    Whole c = a;
    c.negative_ = !a.negative_ && !a.limbs_.empty();
    return c;
  }
  friend Whole operator+(const Whole& a, const Whole& b) {
    if (a.negative_ == b.negative_) return sum(a, b);
    return less(a.limbs_, b.limbs_) ? difference(b, a) : difference(a, b);
  }
  friend Whole operator-(const Whole& a, const Whole& b) { return a + (-b); }
  friend bool operator<(const Whole& a, const Whole& b) { return (a - b).negative_; }

 private:
  using Limbs = std::vector<std::uint32_t>;
  static bool less(const Limbs& a, const Limbs& b) {
    if (a.size() != b.size()) return a.size() < b.size();
    return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
  }
  static Whole sum(const Whole& a, const Whole& b) {
    Whole c;
    c.negative_ = a.negative_;
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < std::max(a.limbs_.size(), b.limbs_.size()) || carry != 0; ++i) {
      carry += (i < a.limbs_.size() ? a.limbs_[i] : 0ull) + (i < b.limbs_.size() ? b.limbs_[i] : 0ull);
      c.limbs_.push_back(static_cast<std::uint32_t>(carry));
      carry >>= 32;
    }
    return c;
  }
  // |a| >= |b|.
  static Whole difference(const Whole& a, const Whole& b) {
    Whole c = a;
    std::int64_t borrow = 0;
    for (std::size_t i = 0; i < c.limbs_.size(); ++i) {
      std::int64_t part = std::int64_t{c.limbs_[i]} - borrow - (i < b.limbs_.size() ? std::int64_t{b.limbs_[i]} : 0);
      borrow = part < 0;
      c.limbs_[i] = static_cast<std::uint32_t>(part + (borrow << 32));
    }
    c.trim();
    return c;
  }
  void trim() {
    while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
    if (limbs_.empty()) negative_ = false;
  }

  bool negative_ = false;
  Limbs limbs_;  // the lowest first
};

/// The least power of two that divides the double; all doubles of a calculation are scaled by their least one.
inline int lowest_exponent(double value) { return value == 0 ? 1 << 20 : std::ilogb(value) - 52; }
inline Whole scaled(double value, int exponent) {
  if (value == 0) return {};
  const int own = std::ilogb(value) - 52;
  return {static_cast<std::int64_t>(std::ldexp(value, -own)), own - exponent};
}

}  // namespace standoff::testing
