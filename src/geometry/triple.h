// SPDX-License-Identifier: Apache-2.0
// The arithmetic of geometry for float and double: single numbers, triples, and rigid transforms. src/simd defines the
// same names for wide types: so one source serves the set-up in double precision, the SIMD kernels and the CUDA
// kernels, with the same roundings.
#pragma once

#include "geometry/host_device.h"
#include "standoff/vec.h"

namespace standoff {

// These round once, whatever the compiler and the target. Contraction is off, so no other operations are fused.
STANDOFF_INLINE float fma(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
STANDOFF_INLINE double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }

// These return the second argument if both are equal or one is NaN, as the x86 instructions do.
STANDOFF_INLINE float min(float a, float b) { return a < b ? a : b; }
STANDOFF_INLINE double min(double a, double b) { return a < b ? a : b; }
STANDOFF_INLINE float max(float a, float b) { return a > b ? a : b; }
STANDOFF_INLINE double max(double a, double b) { return a > b ? a : b; }

STANDOFF_INLINE float sqrt(float a) { return __builtin_sqrtf(a); }
STANDOFF_INLINE double sqrt(double a) { return __builtin_sqrt(a); }
STANDOFF_INLINE float abs(float a) { return __builtin_fabsf(a); }
STANDOFF_INLINE double abs(double a) { return __builtin_fabs(a); }

STANDOFF_INLINE bool less(float a, float b) { return a < b; }
STANDOFF_INLINE bool less(double a, double b) { return a < b; }
STANDOFF_INLINE float select(bool condition, float yes, float no) { return condition ? yes : no; }
STANDOFF_INLINE double select(bool condition, double yes, double no) { return condition ? yes : no; }

template <class F>
struct Triple {
  F x, y, z;

  friend STANDOFF_INLINE Triple operator+(const Triple& a, const Triple& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend STANDOFF_INLINE Triple operator-(const Triple& a, const Triple& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend STANDOFF_INLINE Triple operator*(const Triple& a, const F& s) { return {a.x * s, a.y * s, a.z * s}; }
};

template <class F>
STANDOFF_INLINE F dot(const Triple<F>& a, const Triple<F>& b) {
  return fma(a.z, b.z, fma(a.y, b.y, a.x * b.x));
}

/// a - b * s, each component with one rounding.
template <class F>
STANDOFF_INLINE Triple<F> minus_scaled(const Triple<F>& a, const Triple<F>& b, const F& s) {
  return {fma(F(-b.x), s, a.x), fma(F(-b.y), s, a.y), fma(F(-b.z), s, a.z)};
}

template <class F>
STANDOFF_INLINE Triple<F> cross(const Triple<F>& a, const Triple<F>& b) {
  return {fma(a.y, b.z, F(-(a.z * b.y))), fma(a.z, b.x, F(-(a.x * b.z))), fma(a.x, b.y, F(-(a.y * b.x)))};
}

STANDOFF_INLINE Triple<double> triple_of(const Vec3& v) { return {v.x, v.y, v.z}; }
STANDOFF_INLINE Vec3 vec_of(const Triple<double>& v) { return {v.x, v.y, v.z}; }

template <class M, class F>
STANDOFF_INLINE Triple<F> select(const M& condition, const Triple<F>& yes, const Triple<F>& no) {
  return {select(condition, yes.x, no.x), select(condition, yes.y, no.y), select(condition, yes.z, no.z)};
}

/// Coordinates of one frame in another: x -> rotation * x + translation.
struct FloatTransform {
  float rotation[9];
  float translation[3];
};
struct DoubleTransform {
  double rotation[9];
  double translation[3];
};

}  // namespace standoff
