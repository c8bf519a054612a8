// SPDX-License-Identifier: Apache-2.0
// The sign's kernels for AVX2.
#ifdef __AVX2__
#define STANDOFF_TARGET_AVX2
#include "sign/cpu/kernels.inl"
#endif
