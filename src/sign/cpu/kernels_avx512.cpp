// SPDX-License-Identifier: Apache-2.0
// The sign's kernels for AVX-512.
#ifdef __AVX512F__
#define STANDOFF_TARGET_AVX512
#include "sign/cpu/kernels.inl"
#endif
