// SPDX-License-Identifier: Apache-2.0
// Sixteen floats in one AVX-512 register.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "geometry/host_device.h"

namespace standoff::avx512 {

struct Mask {
  __mmask16 bits;
  STANDOFF_INLINE std::uint32_t to_bits() const { return bits; }
  friend STANDOFF_INLINE Mask operator~(Mask a) { return {static_cast<__mmask16>(~a.bits)}; }
  friend STANDOFF_INLINE Mask operator&(Mask a, Mask b) { return {static_cast<__mmask16>(a.bits & b.bits)}; }
  friend STANDOFF_INLINE Mask operator|(Mask a, Mask b) { return {static_cast<__mmask16>(a.bits | b.bits)}; }
};

struct WideFloat {
  static constexpr int kLanes = 16;
  __m512 v;

  WideFloat() = default;
  STANDOFF_INLINE WideFloat(__m512 value) : v(value) {}
  STANDOFF_INLINE WideFloat(float value) : v(_mm512_set1_ps(value)) {}
  STANDOFF_INLINE explicit WideFloat(int value) : v(_mm512_set1_ps(static_cast<float>(value))) {}

  static STANDOFF_INLINE WideFloat load(const float* p) { return _mm512_loadu_ps(p); }
  STANDOFF_INLINE void store(float* p) const { _mm512_storeu_ps(p, v); }

  friend STANDOFF_INLINE WideFloat operator+(WideFloat a, WideFloat b) { return _mm512_add_ps(a.v, b.v); }
  friend STANDOFF_INLINE WideFloat operator-(WideFloat a, WideFloat b) { return _mm512_sub_ps(a.v, b.v); }
  friend STANDOFF_INLINE WideFloat operator*(WideFloat a, WideFloat b) { return _mm512_mul_ps(a.v, b.v); }
  friend STANDOFF_INLINE WideFloat operator/(WideFloat a, WideFloat b) { return _mm512_div_ps(a.v, b.v); }
  friend STANDOFF_INLINE WideFloat operator-(WideFloat a) { return _mm512_xor_ps(a.v, _mm512_set1_ps(-0.0f)); }
};

STANDOFF_INLINE WideFloat fma(WideFloat a, WideFloat b, WideFloat c) { return _mm512_fmadd_ps(a.v, b.v, c.v); }
STANDOFF_INLINE WideFloat min(WideFloat a, WideFloat b) { return _mm512_min_ps(a.v, b.v); }
STANDOFF_INLINE WideFloat max(WideFloat a, WideFloat b) { return _mm512_max_ps(a.v, b.v); }
STANDOFF_INLINE WideFloat sqrt(WideFloat a) { return _mm512_sqrt_ps(a.v); }
STANDOFF_INLINE WideFloat abs(WideFloat a) { return _mm512_abs_ps(a.v); }
STANDOFF_INLINE Mask less(WideFloat a, WideFloat b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ)}; }
STANDOFF_INLINE Mask less_equal(WideFloat a, WideFloat b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ)}; }
STANDOFF_INLINE Mask equal(WideFloat a, WideFloat b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ)}; }
STANDOFF_INLINE WideFloat select(Mask m, WideFloat yes, WideFloat no) {
  return _mm512_mask_blend_ps(m.bits, no.v, yes.v);
}
STANDOFF_INLINE float reduce_max(WideFloat a) { return _mm512_reduce_max_ps(a.v); }
STANDOFF_INLINE float reduce_min(WideFloat a) { return _mm512_reduce_min_ps(a.v); }

/// Stores the lanes rounded towards zero. Requires values within the range of int.
STANDOFF_INLINE void store_truncated(int* p, WideFloat a) { _mm512_storeu_si512(p, _mm512_cvttps_epi32(a.v)); }

/// Sixteen unsigned integers; compared as such.
struct WideUint {
  __m512i v;

  WideUint() = default;
  STANDOFF_INLINE WideUint(__m512i value) : v(value) {}
  STANDOFF_INLINE WideUint(std::uint32_t value) : v(_mm512_set1_epi32(static_cast<int>(value))) {}
  static STANDOFF_INLINE WideUint load(const std::uint32_t* p) { return _mm512_loadu_si512(p); }
  STANDOFF_INLINE void store(std::uint32_t* p) const { _mm512_storeu_si512(p, v); }
};

STANDOFF_INLINE WideUint operator+(WideUint a, WideUint b) { return _mm512_add_epi32(a.v, b.v); }
/// 0 to 15.
STANDOFF_INLINE WideUint lane_numbers() {
  return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
STANDOFF_INLINE Mask less(WideUint a, WideUint b) { return {_mm512_cmp_epu32_mask(a.v, b.v, _MM_CMPINT_LT)}; }
STANDOFF_INLINE Mask equal(WideUint a, WideUint b) { return {_mm512_cmpeq_epi32_mask(a.v, b.v)}; }
STANDOFF_INLINE WideUint select(Mask m, WideUint yes, WideUint no) {
  return _mm512_mask_blend_epi32(m.bits, no.v, yes.v);
}

/// Stores the elements of `a` whose mask bit is set, packed, and returns how many. `p` must have room for sixteen.
STANDOFF_INLINE int store_packed(std::uint32_t* p, Mask m, WideUint a) {
  _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.bits, a.v));
  return __builtin_popcount(m.bits);
}

/// Stores (v * scale - center) as four floats, the fourth zero. v has three doubles, center four.
STANDOFF_INLINE void store_local(float* out, const double* v, double scale, const double* center) {
  const __m256d all = _mm256_maskz_loadu_pd(0x7, v);
  _mm_store_ps(out, _mm256_cvtpd_ps(_mm256_fmsub_pd(all, _mm256_set1_pd(scale), _mm256_loadu_pd(center))));
}

/// Column `axis` of sixteen rows of four.
STANDOFF_INLINE WideFloat load_column(const float (*rows)[4], int axis) {
  const __m512i from = _mm512_add_epi32(_mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 0, 4, 8, 12, 16, 20, 24, 28),
                                        _mm512_set1_epi32(axis));
  const auto row = [&](int n) __attribute__((always_inline)) { return _mm512_loadu_ps(rows[n]); };
  const __m512 low = _mm512_permutex2var_ps(row(0), from, row(4)), high = _mm512_permutex2var_ps(row(8), from, row(12));
  return _mm512_mask_blend_ps(0xff00, low, high);
}

STANDOFF_INLINE Mask mask_from_bits(std::uint32_t bits) { return {static_cast<__mmask16>(bits)}; }

/// Stores the lanes of `a` whose mask bit is set, packed. `p` must have room for sixteen.
STANDOFF_INLINE void store_packed(float* p, Mask m, WideFloat a) {
  _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.bits, a.v));
}

}  // namespace standoff::avx512
