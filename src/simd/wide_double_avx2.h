// SPDX-License-Identifier: Apache-2.0
// Eight doubles in two AVX2 registers. Same names and same results as wide_double_avx512.h.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "geometry/host_device.h"

namespace standoff::avx2 {

struct DoubleMask {
  __m256d lo, hi;
  STANDOFF_INLINE std::uint32_t to_bits() const {
    return static_cast<std::uint32_t>(_mm256_movemask_pd(lo) | (_mm256_movemask_pd(hi) << 4));
  }
  friend STANDOFF_INLINE DoubleMask operator&(DoubleMask a, DoubleMask b) {
    return {_mm256_and_pd(a.lo, b.lo), _mm256_and_pd(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE DoubleMask operator|(DoubleMask a, DoubleMask b) {
    return {_mm256_or_pd(a.lo, b.lo), _mm256_or_pd(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE DoubleMask operator^(DoubleMask a, DoubleMask b) {
    return {_mm256_xor_pd(a.lo, b.lo), _mm256_xor_pd(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE DoubleMask negated(DoubleMask a) {
    const __m256d ones = _mm256_castsi256_pd(_mm256_set1_epi32(-1));
    return {_mm256_xor_pd(a.lo, ones), _mm256_xor_pd(a.hi, ones)};
  }
};

struct WideDouble {
  static constexpr int kLanes = 8;
  __m256d lo, hi;

  WideDouble() = default;
  STANDOFF_INLINE WideDouble(__m256d low, __m256d high) : lo(low), hi(high) {}
  STANDOFF_INLINE explicit WideDouble(double value) : lo(_mm256_set1_pd(value)), hi(lo) {}

  static STANDOFF_INLINE WideDouble load(const double* p) { return {_mm256_loadu_pd(p), _mm256_loadu_pd(p + 4)}; }
  STANDOFF_INLINE void store(double* p) const {
    _mm256_storeu_pd(p, lo);
    _mm256_storeu_pd(p + 4, hi);
  }

  friend STANDOFF_INLINE WideDouble operator+(WideDouble a, WideDouble b) {
    return {_mm256_add_pd(a.lo, b.lo), _mm256_add_pd(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideDouble operator-(WideDouble a, WideDouble b) {
    return {_mm256_sub_pd(a.lo, b.lo), _mm256_sub_pd(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideDouble operator*(WideDouble a, WideDouble b) {
    return {_mm256_mul_pd(a.lo, b.lo), _mm256_mul_pd(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideDouble operator/(WideDouble a, WideDouble b) {
    return {_mm256_div_pd(a.lo, b.lo), _mm256_div_pd(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideDouble operator-(WideDouble a) {
    const __m256d sign = _mm256_set1_pd(-0.0);
    return {_mm256_xor_pd(a.lo, sign), _mm256_xor_pd(a.hi, sign)};
  }
};

STANDOFF_INLINE WideDouble fma(WideDouble a, WideDouble b, WideDouble c) {
  return {_mm256_fmadd_pd(a.lo, b.lo, c.lo), _mm256_fmadd_pd(a.hi, b.hi, c.hi)};
}
STANDOFF_INLINE WideDouble min(WideDouble a, WideDouble b) {
  return {_mm256_min_pd(a.lo, b.lo), _mm256_min_pd(a.hi, b.hi)};
}
STANDOFF_INLINE WideDouble max(WideDouble a, WideDouble b) {
  return {_mm256_max_pd(a.lo, b.lo), _mm256_max_pd(a.hi, b.hi)};
}
STANDOFF_INLINE WideDouble sqrt(WideDouble a) { return {_mm256_sqrt_pd(a.lo), _mm256_sqrt_pd(a.hi)}; }
STANDOFF_INLINE DoubleMask less(WideDouble a, WideDouble b) {
  return {_mm256_cmp_pd(a.lo, b.lo, _CMP_LT_OQ), _mm256_cmp_pd(a.hi, b.hi, _CMP_LT_OQ)};
}
STANDOFF_INLINE WideDouble select(DoubleMask m, WideDouble yes, WideDouble no) {
  return {_mm256_blendv_pd(no.lo, yes.lo, m.lo), _mm256_blendv_pd(no.hi, yes.hi, m.hi)};
}

/// Stores (v * scale - center), and zero as the fourth number. v has three doubles, center four.
STANDOFF_INLINE void store_local(double* out, const double* v, double scale, const double* center) {
  const __m256d all = _mm256_maskload_pd(v, _mm256_setr_epi64x(-1, -1, -1, 0));
  _mm256_store_pd(out, _mm256_fmsub_pd(all, _mm256_set1_pd(scale), _mm256_loadu_pd(center)));
}

/// Column `axis` of eight rows of four.
STANDOFF_INLINE WideDouble load_column(const double (*rows)[4], int axis) {
  const auto of_four = [&](int n) __attribute__((always_inline)) {
    return _mm256_setr_pd(rows[n][axis], rows[n + 1][axis], rows[n + 2][axis], rows[n + 3][axis]);
  };
  return {of_four(0), of_four(4)};
}

/// The numbers of a table that the three bits from kShift on of each of eight integers name.
template <int kShift>
STANDOFF_INLINE WideDouble look_up(const double (&table)[8], const std::uint32_t* integers) {
  const auto four = [&](int n) __attribute__((always_inline)) {
    const auto one = [&](int k) __attribute__((always_inline)) { return table[integers[n + k] >> kShift & 7]; };
    return _mm256_setr_pd(one(0), one(1), one(2), one(3));
  };
  return {four(0), four(4)};
}

/// The lanes whose bit is set.
STANDOFF_INLINE DoubleMask double_mask_from_bits(std::uint32_t bits) {
  const auto four = [&](__m256i bit) __attribute__((always_inline)) {
    const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(bits), bit);
    return _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, bit));
  };
  return {four(_mm256_setr_epi64x(1, 2, 4, 8)), four(_mm256_setr_epi64x(16, 32, 64, 128))};
}

/// The lanes rounded to float.
STANDOFF_INLINE void store_rounded(float* out, WideDouble a) {
  _mm_storeu_ps(out, _mm256_cvtpd_ps(a.lo));
  _mm_storeu_ps(out + 4, _mm256_cvtpd_ps(a.hi));
}
/// Pairs of lanes of a and b.
STANDOFF_INLINE void store_rounded_pairs(float (*out)[2], WideDouble a, WideDouble b) {
  const auto four = [&](__m256d x, __m256d y, float(*to)[2]) __attribute__((always_inline)) {
    const __m128 first = _mm256_cvtpd_ps(x), second = _mm256_cvtpd_ps(y);
    _mm_storeu_ps(to[0], _mm_unpacklo_ps(first, second));
    _mm_storeu_ps(to[2], _mm_unpackhi_ps(first, second));
  };
  four(a.lo, b.lo, out);
  four(a.hi, b.hi, out + 4);
}

}  // namespace standoff::avx2
