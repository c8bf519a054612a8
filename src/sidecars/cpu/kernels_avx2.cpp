// SPDX-License-Identifier: Apache-2.0
// The kernels of sidecars for AVX2.
#ifdef __AVX2__
#define STANDOFF_TARGET_AVX2
#include "sidecars/cpu/kernels/sidecars.inl"
#endif
