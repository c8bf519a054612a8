// SPDX-License-Identifier: Apache-2.0
// Eight doubles in one AVX-512 register.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "geometry/host_device.h"

namespace standoff::avx512 {

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
  STANDOFF_INLINE void store(double* p) const { _mm512_storeu_pd(p, v); }

  friend STANDOFF_INLINE WideDouble operator+(WideDouble a, WideDouble b) { return _mm512_add_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator-(WideDouble a, WideDouble b) { return _mm512_sub_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator*(WideDouble a, WideDouble b) { return _mm512_mul_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator/(WideDouble a, WideDouble b) { return _mm512_div_pd(a.v, b.v); }
  friend STANDOFF_INLINE WideDouble operator-(WideDouble a) { return _mm512_xor_pd(a.v, _mm512_set1_pd(-0.0)); }
};

// As those of geometry/scalar.h, lane by lane.
STANDOFF_INLINE WideDouble fma(WideDouble a, WideDouble b, WideDouble c) { return _mm512_fmadd_pd(a.v, b.v, c.v); }
STANDOFF_INLINE WideDouble min(WideDouble a, WideDouble b) { return _mm512_min_pd(a.v, b.v); }
STANDOFF_INLINE WideDouble max(WideDouble a, WideDouble b) { return _mm512_max_pd(a.v, b.v); }
STANDOFF_INLINE WideDouble sqrt(WideDouble a) { return _mm512_sqrt_pd(a.v); }
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
  // Row by row, as they were stored: a load of two would wait until both stores are done.
  const auto two_rows = [&](int n) __attribute__((always_inline)) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(rows[n])), _mm256_load_pd(rows[n + 1]), 1);
  };
  return _mm512_mask_blend_pd(0xf0, _mm512_permutex2var_pd(two_rows(0), from, two_rows(2)),
                              _mm512_permutex2var_pd(two_rows(4), from, two_rows(6)));
}

/// The numbers of a table that the three bits from kShift on of each of eight integers name.
template <int kShift>
STANDOFF_INLINE WideDouble look_up(const double (&table)[8], const std::uint32_t* integers) {
  const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(integers));
  const __m512i which = _mm512_cvtepu32_epi64(_mm256_srli_epi32(all, kShift));  // its low bits count
  return _mm512_permutexvar_pd(which, _mm512_loadu_pd(table));
}

/// The lanes whose bit is set.
STANDOFF_INLINE DoubleMask double_mask_from_bits(std::uint32_t bits) { return {static_cast<__mmask8>(bits)}; }

/// The lanes rounded to float.
STANDOFF_INLINE void store_rounded(float* out, WideDouble a) { _mm256_storeu_ps(out, _mm512_cvtpd_ps(a.v)); }
/// Pairs of lanes of a and b.
STANDOFF_INLINE void store_rounded_pairs(float (*out)[2], WideDouble a, WideDouble b) {
  const __m512 both = _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(a.v)), _mm512_cvtpd_ps(b.v), 1);
  const __m512i pairs = _mm512_setr_epi32(0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15);
  _mm512_storeu_ps(out, _mm512_permutexvar_ps(pairs, both));
}

}  // namespace standoff::avx512
