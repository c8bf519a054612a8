// SPDX-License-Identifier: Apache-2.0
// Marks functions that run on the host and, under nvcc, on the device. No other file here knows about CUDA.
#pragma once

#ifdef __CUDACC__
#define STANDOFF_HD __host__ __device__
#else
#define STANDOFF_HD
#endif

// Small functions of inner loops are always inlined, so that no copy compiled for one instruction set is ever linked
// into code for another.
#if defined(__CUDACC__)
#define STANDOFF_INLINE STANDOFF_HD __forceinline__
#else
#define STANDOFF_INLINE inline __attribute__((always_inline))
#endif

// The larger of two floats that are not NaN: one instruction of a GPU, where a comparison that says what becomes of NaN
// takes two.
#if defined(__CUDA_ARCH__)
#define STANDOFF_LARGER(a, b) fmaxf(a, b)
#else
#define STANDOFF_LARGER(a, b) ((a) > (b) ? (a) : (b))
#endif
