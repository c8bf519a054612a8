// SPDX-License-Identifier: Apache-2.0
// The arithmetic that geometry is written in, for float and double. src/simd gives the same names for wide types,
// so that one source serves the double-precision set-up, the SIMD kernels and the CUDA kernels, with the same
// roundings.
#pragma once

#include "geometry/host_device.h"

namespace standoff {

// One rounding, whatever the compiler and the target: contraction is off, so only these are fused.
STANDOFF_INLINE float fma(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
STANDOFF_INLINE double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }

// As the x86 instructions: the second argument when the two are equal or one is NaN.
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

}  // namespace standoff
