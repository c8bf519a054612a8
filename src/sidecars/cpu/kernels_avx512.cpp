// SPDX-License-Identifier: Apache-2.0
// The kernels of sidecars for AVX-512.
#ifdef __AVX512F__
#define STANDOFF_TARGET_AVX512
#include "sidecars/cpu/kernels/sidecars.inl"
#endif
