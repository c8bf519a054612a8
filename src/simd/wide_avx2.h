// SPDX-License-Identifier: Apache-2.0
// Sixteen floats, and eight doubles, in two AVX2 registers, with the names and results of wide_avx512.h.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "geometry/host_device.h"

namespace standoff::avx2 {

struct Mask {
  __m256 lo, hi;
  STANDOFF_INLINE std::uint32_t to_bits() const {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(lo) | (_mm256_movemask_ps(hi) << 8));
  }
  friend STANDOFF_INLINE Mask operator~(Mask a) {
    const __m256 ones = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
    return {_mm256_xor_ps(a.lo, ones), _mm256_xor_ps(a.hi, ones)};
  }
  friend STANDOFF_INLINE Mask operator&(Mask a, Mask b) {
    return {_mm256_and_ps(a.lo, b.lo), _mm256_and_ps(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE Mask operator|(Mask a, Mask b) { return {_mm256_or_ps(a.lo, b.lo), _mm256_or_ps(a.hi, b.hi)}; }
};

struct WideFloat {
  static constexpr int kLanes = 16;
  __m256 lo, hi;

  WideFloat() = default;
  STANDOFF_INLINE WideFloat(__m256 low, __m256 high) : lo(low), hi(high) {}
  STANDOFF_INLINE WideFloat(float value) : lo(_mm256_set1_ps(value)), hi(lo) {}
  STANDOFF_INLINE explicit WideFloat(int value) : WideFloat(static_cast<float>(value)) {}

  static STANDOFF_INLINE WideFloat load(const float* p) { return {_mm256_loadu_ps(p), _mm256_loadu_ps(p + 8)}; }
  STANDOFF_INLINE void store(float* p) const {
    _mm256_storeu_ps(p, lo);
    _mm256_storeu_ps(p + 8, hi);
  }

  friend STANDOFF_INLINE WideFloat operator+(WideFloat a, WideFloat b) {
    return {_mm256_add_ps(a.lo, b.lo), _mm256_add_ps(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideFloat operator-(WideFloat a, WideFloat b) {
    return {_mm256_sub_ps(a.lo, b.lo), _mm256_sub_ps(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideFloat operator*(WideFloat a, WideFloat b) {
    return {_mm256_mul_ps(a.lo, b.lo), _mm256_mul_ps(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideFloat operator/(WideFloat a, WideFloat b) {
    return {_mm256_div_ps(a.lo, b.lo), _mm256_div_ps(a.hi, b.hi)};
  }
  friend STANDOFF_INLINE WideFloat operator-(WideFloat a) {
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return {_mm256_xor_ps(a.lo, sign), _mm256_xor_ps(a.hi, sign)};
  }
};

STANDOFF_INLINE WideFloat fma(WideFloat a, WideFloat b, WideFloat c) {
  return {_mm256_fmadd_ps(a.lo, b.lo, c.lo), _mm256_fmadd_ps(a.hi, b.hi, c.hi)};
}
STANDOFF_INLINE WideFloat min(WideFloat a, WideFloat b) {
  return {_mm256_min_ps(a.lo, b.lo), _mm256_min_ps(a.hi, b.hi)};
}
STANDOFF_INLINE WideFloat max(WideFloat a, WideFloat b) {
  return {_mm256_max_ps(a.lo, b.lo), _mm256_max_ps(a.hi, b.hi)};
}
STANDOFF_INLINE WideFloat sqrt(WideFloat a) { return {_mm256_sqrt_ps(a.lo), _mm256_sqrt_ps(a.hi)}; }
STANDOFF_INLINE WideFloat abs(WideFloat a) {
  const __m256 sign = _mm256_set1_ps(-0.0f);
  return {_mm256_andnot_ps(sign, a.lo), _mm256_andnot_ps(sign, a.hi)};
}
STANDOFF_INLINE Mask less(WideFloat a, WideFloat b) {
  return {_mm256_cmp_ps(a.lo, b.lo, _CMP_LT_OQ), _mm256_cmp_ps(a.hi, b.hi, _CMP_LT_OQ)};
}
STANDOFF_INLINE Mask less_equal(WideFloat a, WideFloat b) {
  return {_mm256_cmp_ps(a.lo, b.lo, _CMP_LE_OQ), _mm256_cmp_ps(a.hi, b.hi, _CMP_LE_OQ)};
}
STANDOFF_INLINE Mask equal(WideFloat a, WideFloat b) {
  return {_mm256_cmp_ps(a.lo, b.lo, _CMP_EQ_OQ), _mm256_cmp_ps(a.hi, b.hi, _CMP_EQ_OQ)};
}
STANDOFF_INLINE WideFloat select(Mask m, WideFloat yes, WideFloat no) {
  return {_mm256_blendv_ps(no.lo, yes.lo, m.lo), _mm256_blendv_ps(no.hi, yes.hi, m.hi)};
}
STANDOFF_INLINE float reduce_max(WideFloat a) {
  __m256 m = _mm256_max_ps(a.lo, a.hi);
  m = _mm256_max_ps(m, _mm256_permute2f128_ps(m, m, 1));
  m = _mm256_max_ps(m, _mm256_permute_ps(m, 0x4e));
  m = _mm256_max_ps(m, _mm256_permute_ps(m, 0xb1));
  return _mm256_cvtss_f32(m);
}
STANDOFF_INLINE float reduce_min(WideFloat a) { return -reduce_max(-a); }

/// Stores the lanes rounded towards zero. Requires values within the range of int.
STANDOFF_INLINE void store_truncated(int* p, WideFloat a) {
  auto* q = reinterpret_cast<__m256i*>(p);
  _mm256_storeu_si256(q, _mm256_cvttps_epi32(a.lo));
  _mm256_storeu_si256(q + 1, _mm256_cvttps_epi32(a.hi));
}

struct WideUint {
  __m256i lo, hi;

  WideUint() = default;
  STANDOFF_INLINE WideUint(__m256i low, __m256i high) : lo(low), hi(high) {}
  STANDOFF_INLINE WideUint(std::uint32_t value) : lo(_mm256_set1_epi32(static_cast<int>(value))), hi(lo) {}
  static STANDOFF_INLINE WideUint load(const std::uint32_t* p) {
    const auto* q = reinterpret_cast<const __m256i*>(p);
    return {_mm256_loadu_si256(q), _mm256_loadu_si256(q + 1)};
  }
  STANDOFF_INLINE void store(std::uint32_t* p) const {
    auto* q = reinterpret_cast<__m256i*>(p);
    _mm256_storeu_si256(q, lo);
    _mm256_storeu_si256(q + 1, hi);
  }
};

STANDOFF_INLINE WideUint operator+(WideUint a, WideUint b) {
  return {_mm256_add_epi32(a.lo, b.lo), _mm256_add_epi32(a.hi, b.hi)};
}
/// The numbers 0 to 15.
STANDOFF_INLINE WideUint lane_numbers() {
  return {_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), _mm256_setr_epi32(8, 9, 10, 11, 12, 13, 14, 15)};
}
STANDOFF_INLINE Mask less(WideUint a, WideUint b) {
  const __m256i flip = _mm256_set1_epi32(static_cast<int>(0x80000000u));  // AVX2 compares signed integers only
  const auto lower = [&](__m256i x, __m256i y) __attribute__((always_inline)) {
    return _mm256_castsi256_ps(_mm256_cmpgt_epi32(_mm256_xor_si256(y, flip), _mm256_xor_si256(x, flip)));
  };
  return {lower(a.lo, b.lo), lower(a.hi, b.hi)};
}
STANDOFF_INLINE Mask equal(WideUint a, WideUint b) {
  return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(a.lo, b.lo)), _mm256_castsi256_ps(_mm256_cmpeq_epi32(a.hi, b.hi))};
}
STANDOFF_INLINE WideUint select(Mask m, WideUint yes, WideUint no) {
  return {_mm256_blendv_epi8(no.lo, yes.lo, _mm256_castps_si256(m.lo)),
          _mm256_blendv_epi8(no.hi, yes.hi, _mm256_castps_si256(m.hi))};
}

STANDOFF_INLINE int store_packed(std::uint32_t* p, Mask m, WideUint a) {
  std::uint32_t all[16];
  a.store(all);
  int n = 0;
  for (std::uint32_t bits = m.to_bits(); bits; bits &= bits - 1) p[n++] = all[__builtin_ctz(bits)];
  return n;
}

/// Stores (v * scale - center) as four floats, the fourth zero. v has three doubles, center four.
STANDOFF_INLINE void store_local(float* out, const double* v, double scale, const double* center) {
  const __m256d all = _mm256_maskload_pd(v, _mm256_setr_epi64x(-1, -1, -1, 0));
  _mm_store_ps(out, _mm256_cvtpd_ps(_mm256_fmsub_pd(all, _mm256_set1_pd(scale), _mm256_loadu_pd(center))));
}

/// Column `axis` of sixteen rows of four.
STANDOFF_INLINE WideFloat load_column(const float (*rows)[4], int axis) {
  const __m256i from = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
  return {_mm256_i32gather_ps(rows[0] + axis, from, 4), _mm256_i32gather_ps(rows[8] + axis, from, 4)};
}

STANDOFF_INLINE Mask mask_from_bits(std::uint32_t bits) {
  const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const auto half = [&](std::uint32_t byte) __attribute__((always_inline)) {
    const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(byte)), bit);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit));
  };
  return {half(bits & 0xff), half(bits >> 8)};
}

/// Stores the lanes of `a` whose mask bit is set, packed, and returns how many. `p` must have room for sixteen.
STANDOFF_INLINE int store_packed(float* p, Mask m, WideFloat a) {
  float all[16];
  a.store(all);
  int n = 0;
  for (std::uint32_t bits = m.to_bits(); bits; bits &= bits - 1) p[n++] = all[__builtin_ctz(bits)];
  return n;
}

// Eight doubles.

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
  static STANDOFF_INLINE WideDouble load(const float* p) {
    return {_mm256_cvtps_pd(_mm_loadu_ps(p)), _mm256_cvtps_pd(_mm_loadu_ps(p + 4))};
  }
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
STANDOFF_INLINE WideDouble abs(WideDouble a) { return max(a, -a); }
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

/// Looks up eight numbers in a table of eight: the index of each is three bits, from bit kShift on, of an integer.
template <int kShift>
STANDOFF_INLINE WideDouble look_up(const double (&table)[8], const std::uint32_t* integers) {
  const auto four = [&](int n) __attribute__((always_inline)) {
    const auto one = [&](int k) __attribute__((always_inline)) { return table[integers[n + k] >> kShift & 7]; };
    return _mm256_setr_pd(one(0), one(1), one(2), one(3));
  };
  return {four(0), four(4)};
}

/// A mask of the lanes whose bit is set.
STANDOFF_INLINE DoubleMask double_mask_from_bits(std::uint32_t bits) {
  const auto four = [&](__m256i bit) __attribute__((always_inline)) {
    const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(bits), bit);
    return _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, bit));
  };
  return {four(_mm256_setr_epi64x(1, 2, 4, 8)), four(_mm256_setr_epi64x(16, 32, 64, 128))};
}

/// Stores the lanes rounded towards zero. Requires values within the range of int.
STANDOFF_INLINE void store_truncated(int* p, WideDouble a) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm256_cvttpd_epi32(a.lo));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p + 4), _mm256_cvttpd_epi32(a.hi));
}
/// Stores the lanes rounded to float.
STANDOFF_INLINE void store_rounded(float* out, WideDouble a) {
  _mm_storeu_ps(out, _mm256_cvtpd_ps(a.lo));
  _mm_storeu_ps(out + 4, _mm256_cvtpd_ps(a.hi));
}
/// Stores pairs of lanes of a and b, rounded to float.
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
