// SPDX-License-Identifier: Apache-2.0
// Sixteen floats, and eight doubles, in one AVX-512 register.
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
/// The numbers 0 to 15.
STANDOFF_INLINE WideUint lane_numbers() {
  return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
STANDOFF_INLINE Mask less(WideUint a, WideUint b) { return {_mm512_cmp_epu32_mask(a.v, b.v, _MM_CMPINT_LT)}; }
STANDOFF_INLINE Mask equal(WideUint a, WideUint b) { return {_mm512_cmpeq_epi32_mask(a.v, b.v)}; }
STANDOFF_INLINE WideUint select(Mask m, WideUint yes, WideUint no) {
  return _mm512_mask_blend_epi32(m.bits, no.v, yes.v);
}

/// Stores the lanes of `a` whose mask bit is set, packed, and returns how many. `p` must have room for sixteen.
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

/// Stores the lanes of `a` whose mask bit is set, packed, and returns how many. `p` must have room for sixteen.
STANDOFF_INLINE int store_packed(float* p, Mask m, WideFloat a) {
  _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.bits, a.v));
  return __builtin_popcount(m.bits);
}

// Eight doubles.

/// The result of less() for eight pairs of doubles.
struct DoubleMask {
  __mmask8 bits;
  STANDOFF_INLINE std::uint32_t to_bits() const { return bits; }
  friend STANDOFF_INLINE DoubleMask operator&(DoubleMask a, DoubleMask b) {
    return {static_cast<__mmask8>(a.bits & b.bits)};
  }
  friend STANDOFF_INLINE DoubleMask operator|(DoubleMask a, DoubleMask b) {
    return {static_cast<__mmask8>(a.bits | b.bits)};
  }
  friend STANDOFF_INLINE DoubleMask operator^(DoubleMask a, DoubleMask b) {
    return {static_cast<__mmask8>(a.bits ^ b.bits)};
  }
  friend STANDOFF_INLINE DoubleMask negated(DoubleMask a) { return {static_cast<__mmask8>(~a.bits)}; }
};

struct WideDouble {
  static constexpr int kLanes = 8;
  __m512d v;

  WideDouble() = default;
  STANDOFF_INLINE WideDouble(__m512d value) : v(value) {}
  STANDOFF_INLINE explicit WideDouble(double value) : v(_mm512_set1_pd(value)) {}

  static STANDOFF_INLINE WideDouble load(const double* p) { return _mm512_loadu_pd(p); }
  static STANDOFF_INLINE WideDouble load(const float* p) { return _mm512_cvtps_pd(_mm256_loadu_ps(p)); }
  STANDOFF_INLINE void store(double* p) const { _mm512_storeu_pd(p, v); }

  friend STANDOFF_INLINE WideDouble operator+(WideDouble a, WideDouble b) { return _mm512_add_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator-(WideDouble a, WideDouble b) { return _mm512_sub_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator*(WideDouble a, WideDouble b) { return _mm512_mul_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator/(WideDouble a, WideDouble b) { return _mm512_div_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator-(WideDouble a) { return _mm512_xor_pd(a.v, _mm512_set1_pd(-0.0)); }
};

// The same as in geometry/triple.h, lane by lane.
STANDOFF_INLINE WideDouble fma(WideDouble a, WideDouble b, WideDouble c) { return _mm512_fmadd_pd(a.v, b.v, c.v); }
STANDOFF_INLINE WideDouble min(WideDouble a, WideDouble b) { return _mm512_min_pd(a.v, b.v); }
STANDOFF_INLINE WideDouble max(WideDouble a, WideDouble b) { return _mm512_max_pd(a.v, b.v); }
STANDOFF_INLINE WideDouble sqrt(WideDouble a) { return _mm512_sqrt_pd(a.v); }
STANDOFF_INLINE WideDouble abs(WideDouble a) { return max(a, -a); }
STANDOFF_INLINE DoubleMask less(WideDouble a, WideDouble b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ)}; }
STANDOFF_INLINE WideDouble select(DoubleMask m, WideDouble yes, WideDouble no) {
  return _mm512_mask_blend_pd(m.bits, no.v, yes.v);
}

/// Stores (v * scale - center), and zero as the fourth number. v has three doubles, center four.
STANDOFF_INLINE void store_local(double* out, const double* v, double scale, const double* center) {
  const __m256d all = _mm256_maskz_loadu_pd(0x7, v);
  _mm256_store_pd(out, _mm256_fmsub_pd(all, _mm256_set1_pd(scale), _mm256_loadu_pd(center)));
}

/// Column `axis` of eight rows of four.
STANDOFF_INLINE WideDouble load_column(const double (*rows)[4], int axis) {
  const __m512i from = _mm512_add_epi64(_mm512_setr_epi64(0, 4, 8, 12, 0, 4, 8, 12), _mm512_set1_epi64(axis));
  // Load row by row, as they were stored: a load of two rows would wait until both stores are done.
  const auto two_rows = [&](int n) __attribute__((always_inline)) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(rows[n])), _mm256_load_pd(rows[n + 1]), 1);
  };
  return _mm512_mask_blend_pd(0xf0, _mm512_permutex2var_pd(two_rows(0), from, two_rows(2)),
                              _mm512_permutex2var_pd(two_rows(4), from, two_rows(6)));
}

/// Looks up eight numbers in a table of eight: the index of each is three bits, from bit kShift on, of an integer.
template <int kShift>
STANDOFF_INLINE WideDouble look_up(const double (&table)[8], const std::uint32_t* integers) {
  const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(integers));
  const __m512i which = _mm512_cvtepu32_epi64(_mm256_srli_epi32(all, kShift));  // only the low bits matter
  return _mm512_permutexvar_pd(which, _mm512_loadu_pd(table));
}

/// A mask of the lanes whose bit is set.
STANDOFF_INLINE DoubleMask double_mask_from_bits(std::uint32_t bits) { return {static_cast<__mmask8>(bits)}; }

/// Stores the lanes rounded towards zero. Requires values within the range of int.
STANDOFF_INLINE void store_truncated(int* p, WideDouble a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm512_cvttpd_epi32(a.v));
}
/// Stores the lanes rounded to float.
STANDOFF_INLINE void store_rounded(float* out, WideDouble a) { _mm256_storeu_ps(out, _mm512_cvtpd_ps(a.v)); }
/// Stores pairs of lanes of a and b, rounded to float.
STANDOFF_INLINE void store_rounded_pairs(float (*out)[2], WideDouble a, WideDouble b) {
  const __m512 both = _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(a.v)), _mm512_cvtpd_ps(b.v), 1);
  const __m512i pairs = _mm512_setr_epi32(0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15);
  _mm512_storeu_ps(out, _mm512_permutexvar_ps(pairs, both));
}

}  // namespace standoff::avx512
