// SPDX-License-Identifier: Apache-2.0
// The queries' kernels for AVX2.
#ifdef __AVX2__
#define STANDOFF_TARGET_AVX2
#include "collision/cpu/kernels.inl"
#endif
