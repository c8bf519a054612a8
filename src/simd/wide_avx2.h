// SPDX-License-Identifier: Apache-2.0
// Sixteen floats, and eight doubles, in two AVX2 registers, with the names and results of wide_avx512.h.
#pragma once

#include <immintrin.h>

#include <cstdint>

#include "geometry/host_device.h"

namespace standoff::avx2 {

// What the compiler's operators do not do, for a register of floats and for one of doubles.
STANDOFF_INLINE __m256 filled(float value) { return _mm256_set1_ps(value); }
STANDOFF_INLINE __m256d filled(double value) { return _mm256_set1_pd(value); }
STANDOFF_INLINE __m256 loaded(const float* p) { return _mm256_loadu_ps(p); }
STANDOFF_INLINE __m256d loaded(const double* p) { return _mm256_loadu_pd(p); }
STANDOFF_INLINE void put(float* p, __m256 a) { _mm256_storeu_ps(p, a); }
STANDOFF_INLINE void put(double* p, __m256d a) { _mm256_storeu_pd(p, a); }
STANDOFF_INLINE __m256 fma(__m256 a, __m256 b, __m256 c) { return _mm256_fmadd_ps(a, b, c); }
STANDOFF_INLINE __m256d fma(__m256d a, __m256d b, __m256d c) { return _mm256_fmadd_pd(a, b, c); }
STANDOFF_INLINE __m256 min(__m256 a, __m256 b) { return _mm256_min_ps(a, b); }
STANDOFF_INLINE __m256d min(__m256d a, __m256d b) { return _mm256_min_pd(a, b); }
STANDOFF_INLINE __m256 max(__m256 a, __m256 b) { return _mm256_max_ps(a, b); }
STANDOFF_INLINE __m256d max(__m256d a, __m256d b) { return _mm256_max_pd(a, b); }
STANDOFF_INLINE __m256 sqrt(__m256 a) { return _mm256_sqrt_ps(a); }
STANDOFF_INLINE __m256d sqrt(__m256d a) { return _mm256_sqrt_pd(a); }
STANDOFF_INLINE __m256 less(__m256 a, __m256 b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
STANDOFF_INLINE __m256d less(__m256d a, __m256d b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
STANDOFF_INLINE __m256 select(__m256 m, __m256 yes, __m256 no) { return _mm256_blendv_ps(no, yes, m); }
STANDOFF_INLINE __m256d select(__m256d m, __m256d yes, __m256d no) { return _mm256_blendv_pd(no, yes, m); }
STANDOFF_INLINE int bits_of(__m256 m) { return _mm256_movemask_ps(m); }
STANDOFF_INLINE int bits_of(__m256d m) { return _mm256_movemask_pd(m); }
STANDOFF_INLINE __m256i as_integers(__m256 m) { return _mm256_castps_si256(m); }
STANDOFF_INLINE __m256i as_integers(__m256d m) { return _mm256_castpd_si256(m); }
STANDOFF_INLINE void of_integers(__m256i from, __m256& to) { to = _mm256_castsi256_ps(from); }
STANDOFF_INLINE void of_integers(__m256i from, __m256d& to) { to = _mm256_castsi256_pd(from); }

/// All bits of a lane are set, or none.
template <class Number>
struct WideMask {
  using Half = decltype(filled(Number{}));
  Half lo, hi;

  STANDOFF_INLINE std::uint32_t to_bits() const {
    return static_cast<std::uint32_t>(bits_of(lo) | (bits_of(hi) << (32 / sizeof(Number))));
  }
  friend STANDOFF_INLINE WideMask operator&(WideMask a, WideMask b) {
    return both(as_integers(a.lo) & as_integers(b.lo), as_integers(a.hi) & as_integers(b.hi));
  }
  friend STANDOFF_INLINE WideMask operator|(WideMask a, WideMask b) {
    return both(as_integers(a.lo) | as_integers(b.lo), as_integers(a.hi) | as_integers(b.hi));
  }
  friend STANDOFF_INLINE WideMask operator^(WideMask a, WideMask b) {
    return both(as_integers(a.lo) ^ as_integers(b.lo), as_integers(a.hi) ^ as_integers(b.hi));
  }
  friend STANDOFF_INLINE WideMask operator~(WideMask a) { return both(~as_integers(a.lo), ~as_integers(a.hi)); }
  friend STANDOFF_INLINE WideMask negated(WideMask a) { return ~a; }

 private:
  static STANDOFF_INLINE WideMask both(__m256i low, __m256i high) {
    WideMask result;
    of_integers(low, result.lo), of_integers(high, result.hi);
    return result;
  }
};

template <class Number>
struct Wide {
  static constexpr int kLanes = 64 / sizeof(Number);
  static constexpr bool kIsFloat = sizeof(Number) == sizeof(float);
  using Mask = WideMask<Number>;
  using Half = typename Mask::Half;
  Half lo, hi;

  Wide() = default;
  STANDOFF_INLINE Wide(Half low, Half high) : lo(low), hi(high) {}
  STANDOFF_INLINE explicit(!kIsFloat) Wide(Number value) : lo(filled(value)), hi(lo) {}
  STANDOFF_INLINE explicit Wide(int value) : Wide(static_cast<Number>(value)) {}

  static STANDOFF_INLINE Wide load(const Number* p) { return {loaded(p), loaded(p + kLanes / 2)}; }
  static STANDOFF_INLINE Wide load(const float* p) requires(!kIsFloat) {
    return {_mm256_cvtps_pd(_mm_loadu_ps(p)), _mm256_cvtps_pd(_mm_loadu_ps(p + 4))};
  }
  STANDOFF_INLINE void store(Number* p) const { put(p, lo), put(p + kLanes / 2, hi); }

  friend STANDOFF_INLINE Wide operator+(Wide a, Wide b) { return {a.lo + b.lo, a.hi + b.hi}; }
  friend STANDOFF_INLINE Wide operator-(Wide a, Wide b) { return {a.lo - b.lo, a.hi - b.hi}; }
  friend STANDOFF_INLINE Wide operator*(Wide a, Wide b) { return {a.lo * b.lo, a.hi * b.hi}; }
  friend STANDOFF_INLINE Wide operator/(Wide a, Wide b) { return {a.lo / b.lo, a.hi / b.hi}; }
  friend STANDOFF_INLINE Wide operator-(Wide a) { return {-a.lo, -a.hi}; }
  friend STANDOFF_INLINE Wide fma(Wide a, Wide b, Wide c) { return {fma(a.lo, b.lo, c.lo), fma(a.hi, b.hi, c.hi)}; }
  friend STANDOFF_INLINE Wide min(Wide a, Wide b) { return {min(a.lo, b.lo), min(a.hi, b.hi)}; }
  friend STANDOFF_INLINE Wide max(Wide a, Wide b) { return {max(a.lo, b.lo), max(a.hi, b.hi)}; }
  friend STANDOFF_INLINE Wide sqrt(Wide a) { return {sqrt(a.lo), sqrt(a.hi)}; }
  friend STANDOFF_INLINE Mask less(Wide a, Wide b) { return {less(a.lo, b.lo), less(a.hi, b.hi)}; }
  friend STANDOFF_INLINE Wide select(Mask m, Wide yes, Wide no) {
    return {select(m.lo, yes.lo, no.lo), select(m.hi, yes.hi, no.hi)};
  }
};

using WideFloat = Wide<float>;
using WideDouble = Wide<double>;
using Mask = WideFloat::Mask;
using DoubleMask = WideDouble::Mask;

STANDOFF_INLINE WideFloat abs(WideFloat a) {
  const __m256 sign = _mm256_set1_ps(-0.0f);
  return {_mm256_andnot_ps(sign, a.lo), _mm256_andnot_ps(sign, a.hi)};
}
STANDOFF_INLINE WideDouble abs(WideDouble a) { return max(a, -a); }
STANDOFF_INLINE Mask less_equal(WideFloat a, WideFloat b) {
  return {_mm256_cmp_ps(a.lo, b.lo, _CMP_LE_OQ), _mm256_cmp_ps(a.hi, b.hi, _CMP_LE_OQ)};
}
STANDOFF_INLINE Mask equal(WideFloat a, WideFloat b) {
  return {_mm256_cmp_ps(a.lo, b.lo, _CMP_EQ_OQ), _mm256_cmp_ps(a.hi, b.hi, _CMP_EQ_OQ)};
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
