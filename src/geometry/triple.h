// SPDX-License-Identifier: Apache-2.0
// Three numbers of any arithmetic type: the vector type of these templates.
#pragma once

#include "geometry/scalar.h"
#include "standoff/vec.h"

namespace standoff {

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

}  // namespace standoff
