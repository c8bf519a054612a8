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
  const auto two_rows = [&](int n) __attribute__((always_inline)) { return _mm512_loadu_pd(rows[n]); };
  return _mm512_mask_blend_pd(0xf0, _mm512_permutex2var_pd(two_rows(0), from, two_rows(2)),
                              _mm512_permutex2var_pd(two_rows(4), from, two_rows(6)));
}

}  // namespace standoff::avx512
