// SPDX-License-Identifier: Apache-2.0
// Sixteen floats, and eight doubles, as four of the compiler's own vectors, which every processor has, with the names
// and results of wide_avx512.h. fma rounds once even if the processor has no such instruction, at the price of a
// library call.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/triple.h"

namespace standoff::portable {

using Uints = std::uint32_t __attribute__((vector_size(16)));
constexpr int kParts = 4;

/// T(f(0), ..., f(3)): one operation on all parts.
template <class T, class Function>
STANDOFF_INLINE T by_parts(Function f) {
  T result;
  for (int part = 0; part < kParts; ++part) result.v[part] = f(part);
  return result;
}
#define STANDOFF_LANES [&](int part) __attribute__((always_inline))

/// All bits of a lane are set, or none.
template <class Integer>
struct WideMask {
  using Part [[gnu::vector_size(16)]] = Integer;
  static constexpr int kPartLanes = 16 / sizeof(Integer);
  Part v[kParts];

  static STANDOFF_INLINE WideMask from_bits(std::uint32_t bits) {
    return by_parts<WideMask>(STANDOFF_LANES {
      return ((static_cast<Integer>(bits >> (kPartLanes * part)) - Part{}) & lane_bits()) == lane_bits();
    });
  }
  STANDOFF_INLINE std::uint32_t to_bits() const {
    Part set{};
    for (int part = 0; part < kParts; ++part) set |= v[part] & (lane_bits() << (kPartLanes * part));
    using LongUints [[gnu::vector_size(16)]] = std::uint64_t;
    const auto halves = reinterpret_cast<LongUints>(set);  // extracting two numbers is faster than extracting four
    const std::uint64_t both = halves[0] | halves[1];
    return static_cast<std::uint32_t>(both | both >> 32);
  }
  friend STANDOFF_INLINE WideMask operator~(const WideMask& a) {
    return by_parts<WideMask>(STANDOFF_LANES { return ~a.v[part]; });
  }
  friend STANDOFF_INLINE WideMask negated(const WideMask& a) { return ~a; }
  friend STANDOFF_INLINE WideMask operator&(const WideMask& a, const WideMask& b) {
    return by_parts<WideMask>(STANDOFF_LANES { return a.v[part] & b.v[part]; });
  }
  friend STANDOFF_INLINE WideMask operator|(const WideMask& a, const WideMask& b) {
    return by_parts<WideMask>(STANDOFF_LANES { return a.v[part] | b.v[part]; });
  }
  friend STANDOFF_INLINE WideMask operator^(const WideMask& a, const WideMask& b) {
    return by_parts<WideMask>(STANDOFF_LANES { return a.v[part] ^ b.v[part]; });
  }

 private:
  // 1, 2, 4, ..
  static STANDOFF_INLINE Part lane_bits() {
    Part bits;
    for (int lane = 0; lane < kPartLanes; ++lane) bits[lane] = Integer{1} << lane;
    return bits;
  }
};

/// to[i] = fma(to[i], b[i], c[i]). If this takes a call for each it is not inlined, or the kernels would be mostly
/// calls.
template <class Number>
#ifdef __FP_FAST_FMAF
STANDOFF_INLINE
#else
[[gnu::noinline]] static
#endif
    void
    fma_lanes(Number* to, const Number* b, const Number* c) {
  for (std::size_t i = 0; i < 64 / sizeof(Number); ++i) to[i] = standoff::fma(to[i], b[i], c[i]);
}

template <class Number, class Integer>
struct Wide {
  using Part [[gnu::vector_size(16)]] = Number;
  using Mask = WideMask<Integer>;
  static constexpr int kPartLanes = Mask::kPartLanes, kLanes = kParts * kPartLanes;
  static constexpr bool kIsFloat = sizeof(Number) == sizeof(float);
  Part v[kParts];

  Wide() = default;
  STANDOFF_INLINE explicit(!kIsFloat) Wide(Number value) {
    for (Part& part : v) part = value - Part{};
  }
  STANDOFF_INLINE explicit Wide(int value) : Wide(static_cast<Number>(value)) {}

  static STANDOFF_INLINE Wide load(const Number* p) {
    Wide result;
    __builtin_memcpy(result.v, p, sizeof result.v);
    return result;
  }
  static STANDOFF_INLINE Wide load(const float* p) requires(!kIsFloat) {
    return by_parts<Wide>(STANDOFF_LANES { return Part{p[kPartLanes * part], p[kPartLanes * part + 1]}; });
  }
  STANDOFF_INLINE void store(Number* p) const { __builtin_memcpy(p, v, sizeof v); }

  friend STANDOFF_INLINE Wide operator+(const Wide& a, const Wide& b) {
    return by_parts<Wide>(STANDOFF_LANES { return a.v[part] + b.v[part]; });
  }
  friend STANDOFF_INLINE Wide operator-(const Wide& a, const Wide& b) {
    return by_parts<Wide>(STANDOFF_LANES { return a.v[part] - b.v[part]; });
  }
  friend STANDOFF_INLINE Wide operator*(const Wide& a, const Wide& b) {
    return by_parts<Wide>(STANDOFF_LANES { return a.v[part] * b.v[part]; });
  }
  friend STANDOFF_INLINE Wide operator/(const Wide& a, const Wide& b) {
    return by_parts<Wide>(STANDOFF_LANES { return a.v[part] / b.v[part]; });
  }
  friend STANDOFF_INLINE Wide operator-(const Wide& a) {
    return by_parts<Wide>(STANDOFF_LANES { return -a.v[part]; });
  }
  friend STANDOFF_INLINE Wide fma(const Wide& a, const Wide& b, const Wide& c) {
    if constexpr (!kIsFloat)
      return by_parts<Wide>(STANDOFF_LANES {
        return Part{standoff::fma(a.v[part][0], b.v[part][0], c.v[part][0]),
                    standoff::fma(a.v[part][1], b.v[part][1], c.v[part][1])};
      });
    Number to[kLanes], by[kLanes], plus[kLanes];
    a.store(to), b.store(by), c.store(plus);
    fma_lanes(to, by, plus);
    return load(to);
  }
  friend STANDOFF_INLINE Wide min(const Wide& a, const Wide& b) {
    return by_parts<Wide>(STANDOFF_LANES { return a.v[part] < b.v[part] ? a.v[part] : b.v[part]; });
  }
  friend STANDOFF_INLINE Wide max(const Wide& a, const Wide& b) {
    return by_parts<Wide>(STANDOFF_LANES { return a.v[part] > b.v[part] ? a.v[part] : b.v[part]; });
  }
  friend STANDOFF_INLINE Wide sqrt(const Wide& a) {
    return by_parts<Wide>(STANDOFF_LANES {
      Part roots;
      for (int lane = 0; lane < kPartLanes; ++lane) roots[lane] = standoff::sqrt(a.v[part][lane]);
      return roots;
    });
  }
  friend STANDOFF_INLINE Mask less(const Wide& a, const Wide& b) {
    return by_parts<Mask>(STANDOFF_LANES { return a.v[part] < b.v[part]; });
  }
  friend STANDOFF_INLINE Wide select(const Mask& m, const Wide& yes, const Wide& no) {
    return by_parts<Wide>(STANDOFF_LANES { return m.v[part] ? yes.v[part] : no.v[part]; });
  }
};

using WideFloat = Wide<float, std::int32_t>;
using WideDouble = Wide<double, std::int64_t>;
using Mask = WideFloat::Mask;
using DoubleMask = WideDouble::Mask;

STANDOFF_INLINE WideFloat abs(const WideFloat& a) {
  return by_parts<WideFloat>(STANDOFF_LANES {
    return reinterpret_cast<WideFloat::Part>(reinterpret_cast<Mask::Part>(a.v[part]) & 0x7fffffff);
  });
}
STANDOFF_INLINE WideDouble abs(const WideDouble& a) { return max(a, -a); }
STANDOFF_INLINE Mask less_equal(const WideFloat& a, const WideFloat& b) {
  return by_parts<Mask>(STANDOFF_LANES { return a.v[part] <= b.v[part]; });
}
STANDOFF_INLINE Mask equal(const WideFloat& a, const WideFloat& b) {
  return by_parts<Mask>(STANDOFF_LANES { return a.v[part] == b.v[part]; });
}
STANDOFF_INLINE float reduce_max(const WideFloat& a) {
  float lanes[16];
  a.store(lanes);
  float m = lanes[0];
  for (const float lane : lanes) m = standoff::max(m, lane);
  return m;
}
STANDOFF_INLINE float reduce_min(const WideFloat& a) { return -reduce_max(-a); }

/// Stores the lanes rounded towards zero. Requires values within the range of int.
STANDOFF_INLINE void store_truncated(int* p, const WideFloat& a) {
  float lanes[16];
  a.store(lanes);
  for (int i = 0; i < 16; ++i) p[i] = static_cast<int>(lanes[i]);
}

struct WideUint {
  Uints v[kParts];

  WideUint() = default;
  STANDOFF_INLINE WideUint(std::uint32_t value) {
    for (Uints& part : v) part = Uints{value, value, value, value};
  }
  static STANDOFF_INLINE WideUint load(const std::uint32_t* p) {
    WideUint result;
    __builtin_memcpy(result.v, p, sizeof result.v);
    return result;
  }
  STANDOFF_INLINE void store(std::uint32_t* p) const { __builtin_memcpy(p, v, sizeof v); }
};

STANDOFF_INLINE WideUint operator+(const WideUint& a, const WideUint& b) {
  WideUint sum;
  for (int part = 0; part < kParts; ++part) sum.v[part] = a.v[part] + b.v[part];
  return sum;
}
/// The numbers 0 to 15.
STANDOFF_INLINE WideUint lane_numbers() {
  WideUint numbers;
  for (std::uint32_t part = 0; part < kParts; ++part) numbers.v[part] = Uints{0, 1, 2, 3} + part * Mask::kPartLanes;
  return numbers;
}
STANDOFF_INLINE Mask less(const WideUint& a, const WideUint& b) {
  return by_parts<Mask>(STANDOFF_LANES { return a.v[part] < b.v[part]; });
}
STANDOFF_INLINE Mask equal(const WideUint& a, const WideUint& b) {
  return by_parts<Mask>(STANDOFF_LANES { return a.v[part] == b.v[part]; });
}
STANDOFF_INLINE WideUint select(const Mask& m, const WideUint& yes, const WideUint& no) {
  return by_parts<WideUint>(STANDOFF_LANES { return m.v[part] ? yes.v[part] : no.v[part]; });
}

/// Stores the lanes of `a` whose mask bit is set, packed, and returns how many. `p` must have room for sixteen.
STANDOFF_INLINE int store_packed(std::uint32_t* p, const Mask& m, const WideUint& a) {
  std::uint32_t all[16];
  a.store(all);
  int n = 0;
  for (std::uint32_t bits = m.to_bits(); bits; bits &= bits - 1) p[n++] = all[__builtin_ctz(bits)];
  return n;
}

/// Stores the lanes of `a` whose mask bit is set, packed, and returns how many. `p` must have room for sixteen.
STANDOFF_INLINE int store_packed(float* p, const Mask& m, const WideFloat& a) {
  float all[16];
  a.store(all);
  int n = 0;
  for (std::uint32_t bits = m.to_bits(); bits; bits &= bits - 1) p[n++] = all[__builtin_ctz(bits)];
  return n;
}

/// Stores (v * scale - center) as four floats, the fourth zero. v has three doubles, center four.
STANDOFF_INLINE void store_local(float* out, const double* v, double scale, const double* center) {
  for (int axis = 0; axis < 3; ++axis) out[axis] = static_cast<float>(standoff::fma(v[axis], scale, -center[axis]));
  out[3] = 0;
}

/// Column `axis` of sixteen rows of four.
STANDOFF_INLINE WideFloat load_column(const float (*rows)[4], int axis) {
  float column[16];
  for (int i = 0; i < 16; ++i) column[i] = rows[i][axis];
  return WideFloat::load(column);
}

STANDOFF_INLINE Mask mask_from_bits(std::uint32_t bits) { return Mask::from_bits(bits); }

// Eight doubles.

/// Stores (v * scale - center), and zero as the fourth number. v has three doubles, center four.
STANDOFF_INLINE void store_local(double* out, const double* v, double scale, const double* center) {
  for (int axis = 0; axis < 3; ++axis) out[axis] = standoff::fma(v[axis], scale, -center[axis]);
  out[3] = 0;
}

/// Column `axis` of eight rows of four.
STANDOFF_INLINE WideDouble load_column(const double (*rows)[4], int axis) {
  double column[WideDouble::kLanes];
  for (int n = 0; n < WideDouble::kLanes; ++n) column[n] = rows[n][axis];
  return WideDouble::load(column);
}

/// Looks up eight numbers in a table of eight: the index of each is three bits, from bit kShift on, of an integer.
template <int kShift>
STANDOFF_INLINE WideDouble look_up(const double (&table)[8], const std::uint32_t* integers) {
  double found[WideDouble::kLanes];
  for (int n = 0; n < WideDouble::kLanes; ++n) found[n] = table[integers[n] >> kShift & 7];
  return WideDouble::load(found);
}

/// A mask of the lanes whose bit is set.
STANDOFF_INLINE DoubleMask double_mask_from_bits(std::uint32_t bits) { return DoubleMask::from_bits(bits); }

/// Stores the lanes rounded towards zero. Requires values within the range of int.
STANDOFF_INLINE void store_truncated(int* p, const WideDouble& a) {
  double lanes[WideDouble::kLanes];
  a.store(lanes);
  for (int n = 0; n < WideDouble::kLanes; ++n) p[n] = static_cast<int>(lanes[n]);
}
/// Stores the lanes rounded to float.
STANDOFF_INLINE void store_rounded(float* out, const WideDouble& a) {
  double lanes[WideDouble::kLanes];
  a.store(lanes);
  for (int n = 0; n < WideDouble::kLanes; ++n) out[n] = static_cast<float>(lanes[n]);
}
/// Stores pairs of lanes of a and b, rounded to float.
STANDOFF_INLINE void store_rounded_pairs(float (*out)[2], const WideDouble& a, const WideDouble& b) {
  float first[WideDouble::kLanes], second[WideDouble::kLanes];
  store_rounded(first, a);
  store_rounded(second, b);
  for (int n = 0; n < WideDouble::kLanes; ++n) out[n][0] = first[n], out[n][1] = second[n];
}

#undef STANDOFF_LANES

}  // namespace standoff::portable
