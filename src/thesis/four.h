// SPDX-License-Identifier: Apache-2.0
// Four floats that every processor can add at once, by the vector types of g++ and clang: for loops that need not be
// compiled once per instruction set, and that compilers will not vectorise by themselves because they choose.
#pragma once

#include "geometry/triple.h"

namespace standoff::cpu {

struct Four {
  typedef float Lanes __attribute__((vector_size(16)));
  typedef int Mask __attribute__((vector_size(16)));
  Lanes v;

  Four() = default;
  STANDOFF_INLINE Four(Lanes lanes) : v(lanes) {}
  /// The same number in all lanes.
  STANDOFF_INLINE explicit Four(float a) : v{a, a, a, a} {}
  STANDOFF_INLINE explicit Four(double a) : Four(static_cast<float>(a)) {}
  STANDOFF_INLINE explicit Four(int a) : Four(static_cast<float>(a)) {}

  static STANDOFF_INLINE Four load(const float* p) {
    Four f;
    __builtin_memcpy(&f.v, p, sizeof f.v);
    return f;
  }
  STANDOFF_INLINE void store(float* p) const { __builtin_memcpy(p, &v, sizeof v); }

  friend STANDOFF_INLINE Four operator+(const Four& a, const Four& b) { return a.v + b.v; }
  friend STANDOFF_INLINE Four operator-(const Four& a, const Four& b) { return a.v - b.v; }
  friend STANDOFF_INLINE Four operator*(const Four& a, const Four& b) { return a.v * b.v; }
};

// As those of triple.h, lane by lane.
STANDOFF_INLINE Four min(const Four& a, const Four& b) { return a.v < b.v ? a.v : b.v; }
STANDOFF_INLINE Four max(const Four& a, const Four& b) { return a.v > b.v ? a.v : b.v; }
STANDOFF_INLINE Four::Mask less(const Four& a, const Four& b) { return a.v < b.v; }
STANDOFF_INLINE Four select(Four::Mask condition, const Four& yes, const Four& no) { return condition ? yes.v : no.v; }

}  // namespace standoff::cpu
