// Sixteen floats in an array, for any processor. Same names and same results as wide_avx512.h: fma has one rounding even
// where the processor has none, at the price of a library call.
#pragma once

#include <cstdint>

#include "geometry/scalar.h"

namespace difi::portable {

struct Mask {
  std::uint32_t bits;
  DIFI_INLINE std::uint32_t to_bits() const { return bits; }
  friend DIFI_INLINE Mask operator~(Mask a) { return {~a.bits & 0xffffu}; }
  friend DIFI_INLINE Mask operator&(Mask a, Mask b) { return {a.bits & b.bits}; }
  friend DIFI_INLINE Mask operator|(Mask a, Mask b) { return {a.bits | b.bits}; }
};

struct WideFloat {
  float v[16];

  WideFloat() = default;
  DIFI_INLINE WideFloat(float value) {
    for (float& lane : v) lane = value;
  }
  DIFI_INLINE explicit WideFloat(int value) : WideFloat(static_cast<float>(value)) {}

  static DIFI_INLINE WideFloat load(const float* p) {
    return of([&](int i) { return p[i]; });
  }
  DIFI_INLINE void store(float* p) const {
    for (int i = 0; i < 16; ++i) p[i] = v[i];
  }

  /// The lanes f(0) to f(15).
  template <class Function>
  static DIFI_INLINE WideFloat of(Function f) {
    WideFloat result;
    for (int i = 0; i < 16; ++i) result.v[i] = f(i);
    return result;
  }

  friend DIFI_INLINE WideFloat operator+(const WideFloat& a, const WideFloat& b) {
    return of([&](int i) { return a.v[i] + b.v[i]; });
  }
  friend DIFI_INLINE WideFloat operator-(const WideFloat& a, const WideFloat& b) {
    return of([&](int i) { return a.v[i] - b.v[i]; });
  }
  friend DIFI_INLINE WideFloat operator*(const WideFloat& a, const WideFloat& b) {
    return of([&](int i) { return a.v[i] * b.v[i]; });
  }
  friend DIFI_INLINE WideFloat operator/(const WideFloat& a, const WideFloat& b) {
    return of([&](int i) { return a.v[i] / b.v[i]; });
  }
  friend DIFI_INLINE WideFloat operator-(const WideFloat& a) {
    return of([&](int i) { return -a.v[i]; });
  }
};

template <class Function>
DIFI_INLINE Mask mask_of(Function f) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 16; ++i) bits |= static_cast<std::uint32_t>(f(i)) << i;
  return {bits};
}

DIFI_INLINE WideFloat fma(const WideFloat& a, const WideFloat& b, const WideFloat& c) {
  return WideFloat::of([&](int i) { return difi::fma(a.v[i], b.v[i], c.v[i]); });
}
DIFI_INLINE WideFloat min(const WideFloat& a, const WideFloat& b) {
  return WideFloat::of([&](int i) { return difi::min(a.v[i], b.v[i]); });
}
DIFI_INLINE WideFloat max(const WideFloat& a, const WideFloat& b) {
  return WideFloat::of([&](int i) { return difi::max(a.v[i], b.v[i]); });
}
DIFI_INLINE WideFloat sqrt(const WideFloat& a) {
  return WideFloat::of([&](int i) { return difi::sqrt(a.v[i]); });
}
DIFI_INLINE WideFloat abs(const WideFloat& a) {
  return WideFloat::of([&](int i) { return difi::abs(a.v[i]); });
}
DIFI_INLINE Mask less(const WideFloat& a, const WideFloat& b) {
  return mask_of([&](int i) { return a.v[i] < b.v[i]; });
}
DIFI_INLINE Mask equal(const WideFloat& a, const WideFloat& b) {
  return mask_of([&](int i) { return a.v[i] == b.v[i]; });
}
DIFI_INLINE WideFloat select(Mask m, const WideFloat& yes, const WideFloat& no) {
  return WideFloat::of([&](int i) { return (m.bits >> i & 1) != 0 ? yes.v[i] : no.v[i]; });
}
DIFI_INLINE float reduce_max(const WideFloat& a) {
  float m = a.v[0];
  for (const float lane : a.v) m = difi::max(m, lane);
  return m;
}
DIFI_INLINE float reduce_min(const WideFloat& a) { return -reduce_max(-a); }

/// Stores the lanes rounded towards zero. Requires values within the range of int.
DIFI_INLINE void store_truncated(int* p, const WideFloat& a) {
  for (int i = 0; i < 16; ++i) p[i] = static_cast<int>(a.v[i]);
}

struct WideUint {
  std::uint32_t v[16];

  WideUint() = default;
  DIFI_INLINE WideUint(std::uint32_t value) {
    for (std::uint32_t& lane : v) lane = value;
  }
  static DIFI_INLINE WideUint load(const std::uint32_t* p) {
    WideUint result;
    for (int i = 0; i < 16; ++i) result.v[i] = p[i];
    return result;
  }
  DIFI_INLINE void store(std::uint32_t* p) const {
    for (int i = 0; i < 16; ++i) p[i] = v[i];
  }
};

DIFI_INLINE Mask less(const WideUint& a, const WideUint& b) {
  return mask_of([&](int i) { return a.v[i] < b.v[i]; });
}
DIFI_INLINE WideUint select(Mask m, const WideUint& yes, const WideUint& no) {
  WideUint result;
  for (int i = 0; i < 16; ++i) result.v[i] = (m.bits >> i & 1) != 0 ? yes.v[i] : no.v[i];
  return result;
}

DIFI_INLINE int store_packed(std::uint32_t* p, Mask m, const WideUint& a) {
  int n = 0;
  for (std::uint32_t bits = m.bits; bits; bits &= bits - 1) p[n++] = a.v[__builtin_ctz(bits)];
  return n;
}

/// Stores (v * scale - center) as four floats, the fourth zero. v has three doubles, center four.
DIFI_INLINE void store_local(float* out, const double* v, double scale, const double* center) {
  for (int axis = 0; axis < 3; ++axis) out[axis] = static_cast<float>(difi::fma(v[axis], scale, -center[axis]));
  out[3] = 0;
}

/// Column `axis` of sixteen rows of four.
DIFI_INLINE WideFloat load_column(const float (*rows)[4], int axis) {
  return WideFloat::of([&](int i) { return rows[i][axis]; });
}

/// Lanes p[0] to p[count - 1]; the others zero, their memory untouched. `count` from 0 to 16.
DIFI_INLINE WideFloat load_some(const float* p, int count) {
  return WideFloat::of([&](int i) { return i < count ? p[i] : 0.0f; });
}
DIFI_INLINE Mask mask_from_bits(std::uint32_t bits) { return {bits}; }

/// Stores the lanes of `a` whose mask bit is set, packed. `p` must have room for sixteen.
DIFI_INLINE void store_packed(float* p, Mask m, const WideFloat& a) {
  int n = 0;
  for (std::uint32_t bits = m.bits; bits; bits &= bits - 1) p[n++] = a.v[__builtin_ctz(bits)];
}

}  // namespace difi::portable
