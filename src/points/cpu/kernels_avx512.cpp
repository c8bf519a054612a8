// SPDX-License-Identifier: Apache-2.0
// The kernels of queries at points for AVX-512.
#ifdef __AVX512F__
#define STANDOFF_TARGET_AVX512
#include "points/cpu/kernels/table.inl"
#endif
