// SPDX-License-Identifier: Apache-2.0
// The kernels of queries at points for AVX2.
#ifdef __AVX2__
#define STANDOFF_TARGET_AVX2
#include "points/cpu/kernels/table.inl"
#endif
