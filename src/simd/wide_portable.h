// SPDX-License-Identifier: Apache-2.0
// Sixteen floats, and eight doubles, as four of the compiler's own vectors, which every processor has, with the names
// and results of wide_avx512.h. fma rounds once even if the processor has no such instruction, at the price of a
// library call.
#pragma once

#include <cstdint>

#include "geometry/triple.h"

namespace standoff::portable {

using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));
using Uints = std::uint32_t __attribute__((vector_size(16)));
using LongUints = std::uint64_t __attribute__((vector_size(16)));
constexpr int kParts = 4, kPartLanes = 4;

/// T(f(0), ..., f(3)): one operation on all parts.
template <class T, class Function>
STANDOFF_INLINE T by_parts(Function f) {
  T result;
  for (int part = 0; part < kParts; ++part) result.v[part] = f(part);
  return result;
}
#define STANDOFF_LANES [&](int part) __attribute__((always_inline))

struct Mask {
  Ints v[kParts];  // all bits of a lane are set, or none

  STANDOFF_INLINE std::uint32_t to_bits() const {
    const Ints bit{1, 2, 4, 8};
    Ints set{};
    for (int part = 0; part < kParts; ++part) set |= v[part] & (bit << (kPartLanes * part));
    const auto halves = reinterpret_cast<LongUints>(set);  // extracting two numbers is faster than extracting four
    const std::uint64_t both = halves[0] | halves[1];
    return static_cast<std::uint32_t>(both | both >> 32);
  }
  friend STANDOFF_INLINE Mask operator~(const Mask& a) {
    return by_parts<Mask>(STANDOFF_LANES { return ~a.v[part]; });
  }
  friend STANDOFF_INLINE Mask operator&(const Mask& a, const Mask& b) {
    return by_parts<Mask>(STANDOFF_LANES { return a.v[part] & b.v[part]; });
  }
  friend STANDOFF_INLINE Mask operator|(const Mask& a, const Mask& b) {
    return by_parts<Mask>(STANDOFF_LANES { return a.v[part] | b.v[part]; });
  }
};

struct WideFloat {
  static constexpr int kLanes = 16;
  Floats v[kParts];

  WideFloat() = default;
  STANDOFF_INLINE WideFloat(float value) {
    for (Floats& part : v) part = Floats{value, value, value, value};
  }
  STANDOFF_INLINE explicit WideFloat(int value) : WideFloat(static_cast<float>(value)) {}

  static STANDOFF_INLINE WideFloat load(const float* p) {
    WideFloat result;
    __builtin_memcpy(result.v, p, sizeof result.v);
    return result;
  }
  STANDOFF_INLINE void store(float* p) const { __builtin_memcpy(p, v, sizeof v); }

  friend STANDOFF_INLINE WideFloat operator+(const WideFloat& a, const WideFloat& b) {
    return by_parts<WideFloat>(STANDOFF_LANES { return a.v[part] + b.v[part]; });
  }
  friend STANDOFF_INLINE WideFloat operator-(const WideFloat& a, const WideFloat& b) {
    return by_parts<WideFloat>(STANDOFF_LANES { return a.v[part] - b.v[part]; });
  }
  friend STANDOFF_INLINE WideFloat operator*(const WideFloat& a, const WideFloat& b) {
    return by_parts<WideFloat>(STANDOFF_LANES { return a.v[part] * b.v[part]; });
  }
  friend STANDOFF_INLINE WideFloat operator/(const WideFloat& a, const WideFloat& b) {
    return by_parts<WideFloat>(STANDOFF_LANES { return a.v[part] / b.v[part]; });
  }
  friend STANDOFF_INLINE WideFloat operator-(const WideFloat& a) {
    return by_parts<WideFloat>(STANDOFF_LANES { return -a.v[part]; });
  }
};

/// to[i] = fma(to[i], b[i], c[i]). If this takes sixteen calls it is not inlined, or the kernels would be mostly calls.
#ifdef __FP_FAST_FMAF
STANDOFF_INLINE
#else
[[gnu::noinline]] static
#endif
void fma_lanes(float* to, const float* b, const float* c) {
  for (int i = 0; i < kParts * kPartLanes; ++i) to[i] = standoff::fma(to[i], b[i], c[i]);
}

STANDOFF_INLINE WideFloat fma(const WideFloat& a, const WideFloat& b, const WideFloat& c) {
  float to[16], by[16], plus[16];
  a.store(to);
  b.store(by);
  c.store(plus);
  fma_lanes(to, by, plus);
  return WideFloat::load(to);
}
STANDOFF_INLINE WideFloat min(const WideFloat& a, const WideFloat& b) {
  return by_parts<WideFloat>(STANDOFF_LANES { return a.v[part] < b.v[part] ? a.v[part] : b.v[part]; });
}
STANDOFF_INLINE WideFloat max(const WideFloat& a, const WideFloat& b) {
  return by_parts<WideFloat>(STANDOFF_LANES { return a.v[part] > b.v[part] ? a.v[part] : b.v[part]; });
}
STANDOFF_INLINE WideFloat sqrt(const WideFloat& a) {
  return by_parts<WideFloat>(STANDOFF_LANES {
    const Floats x = a.v[part];
    return Floats{standoff::sqrt(x[0]), standoff::sqrt(x[1]), standoff::sqrt(x[2]), standoff::sqrt(x[3])};
  });
}
STANDOFF_INLINE WideFloat abs(const WideFloat& a) {
  return by_parts<WideFloat>(
      STANDOFF_LANES { return reinterpret_cast<Floats>(reinterpret_cast<Ints>(a.v[part]) & 0x7fffffff); });
}
STANDOFF_INLINE Mask less(const WideFloat& a, const WideFloat& b) {
  return by_parts<Mask>(STANDOFF_LANES { return a.v[part] < b.v[part]; });
}
STANDOFF_INLINE Mask less_equal(const WideFloat& a, const WideFloat& b) {
  return by_parts<Mask>(STANDOFF_LANES { return a.v[part] <= b.v[part]; });
}
STANDOFF_INLINE Mask equal(const WideFloat& a, const WideFloat& b) {
  return by_parts<Mask>(STANDOFF_LANES { return a.v[part] == b.v[part]; });
}
STANDOFF_INLINE WideFloat select(const Mask& m, const WideFloat& yes, const WideFloat& no) {
  return by_parts<WideFloat>(STANDOFF_LANES { return m.v[part] ? yes.v[part] : no.v[part]; });
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
  for (std::uint32_t part = 0; part < kParts; ++part) numbers.v[part] = Uints{0, 1, 2, 3} + part * kPartLanes;
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

STANDOFF_INLINE Mask mask_from_bits(std::uint32_t bits) {
  Mask m;
  for (int part = 0; part < kParts; ++part) {
    const auto four = static_cast<std::int32_t>(bits >> (kPartLanes * part));
    const Ints bit{1, 2, 4, 8};
    m.v[part] = (Ints{four, four, four, four} & bit) == bit;
  }
  return m;
}

// Eight doubles.

using Doubles = double __attribute__((vector_size(16)));
using LongInts = std::int64_t __attribute__((vector_size(16)));
constexpr int kDoubleParts = 4, kDoublePartLanes = 2;

/// T(f(0), ..., f(3)): one operation on all parts.
template <class T, class Function>
STANDOFF_INLINE T by_double_parts(Function f) {
  T result;
  for (int part = 0; part < kDoubleParts; ++part) result.v[part] = f(part);
  return result;
}

struct DoubleMask {
  LongInts v[kDoubleParts];  // all bits of a lane are set, or none

  STANDOFF_INLINE std::uint32_t to_bits() const {
    const LongInts bit{1, 2};
    LongInts set{};
    for (int part = 0; part < kDoubleParts; ++part) set |= v[part] & (bit << (kDoublePartLanes * part));
    return static_cast<std::uint32_t>(set[0] | set[1]);
  }
  friend STANDOFF_INLINE DoubleMask operator&(const DoubleMask& a, const DoubleMask& b) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] & b.v[part]; });
  }
  friend STANDOFF_INLINE DoubleMask operator|(const DoubleMask& a, const DoubleMask& b) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] | b.v[part]; });
  }
  friend STANDOFF_INLINE DoubleMask operator^(const DoubleMask& a, const DoubleMask& b) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] ^ b.v[part]; });
  }
  friend STANDOFF_INLINE DoubleMask negated(const DoubleMask& a) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return ~a.v[part]; });
  }
};

struct WideDouble {
  static constexpr int kLanes = 8;
  Doubles v[kDoubleParts];

  WideDouble() = default;
  STANDOFF_INLINE explicit WideDouble(double value) {
    for (Doubles& part : v) part = Doubles{value, value};
  }

  static STANDOFF_INLINE WideDouble load(const double* p) {
    WideDouble result;
    __builtin_memcpy(result.v, p, sizeof result.v);
    return result;
  }
  static STANDOFF_INLINE WideDouble load(const float* p) {
    return by_double_parts<WideDouble>([&](int part) __attribute__((always_inline)) {
      return Doubles{p[kDoublePartLanes * part], p[kDoublePartLanes * part + 1]};
    });
  }
  STANDOFF_INLINE void store(double* p) const { __builtin_memcpy(p, v, sizeof v); }

  friend STANDOFF_INLINE WideDouble operator+(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] + b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator-(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] - b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator*(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] * b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator/(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] / b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator-(const WideDouble& a) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return -a.v[part]; });
  }
};

STANDOFF_INLINE WideDouble fma(const WideDouble& a, const WideDouble& b, const WideDouble& c) {
  return by_double_parts<WideDouble>(STANDOFF_LANES {
    return Doubles{standoff::fma(a.v[part][0], b.v[part][0], c.v[part][0]),
                   standoff::fma(a.v[part][1], b.v[part][1], c.v[part][1])};
  });
}
STANDOFF_INLINE WideDouble min(const WideDouble& a, const WideDouble& b) {
  return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] < b.v[part] ? a.v[part] : b.v[part]; });
}
STANDOFF_INLINE WideDouble max(const WideDouble& a, const WideDouble& b) {
  return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] > b.v[part] ? a.v[part] : b.v[part]; });
}
STANDOFF_INLINE WideDouble sqrt(const WideDouble& a) {
  return by_double_parts<WideDouble>(STANDOFF_LANES {
    return Doubles{standoff::sqrt(a.v[part][0]), standoff::sqrt(a.v[part][1])};
  });
}
STANDOFF_INLINE WideDouble abs(const WideDouble& a) { return max(a, -a); }
STANDOFF_INLINE DoubleMask less(const WideDouble& a, const WideDouble& b) {
  return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] < b.v[part]; });
}
STANDOFF_INLINE WideDouble select(const DoubleMask& m, const WideDouble& yes, const WideDouble& no) {
  return by_double_parts<WideDouble>(STANDOFF_LANES { return m.v[part] ? yes.v[part] : no.v[part]; });
}
#undef STANDOFF_LANES

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
STANDOFF_INLINE DoubleMask double_mask_from_bits(std::uint32_t bits) {
  DoubleMask m;
  for (int part = 0; part < kDoubleParts; ++part) {
    const std::int64_t two = bits >> (kDoublePartLanes * part);
    const LongInts bit{1, 2};
    m.v[part] = (LongInts{two, two} & bit) == bit;
  }
  return m;
}

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

}  // namespace standoff::portable
