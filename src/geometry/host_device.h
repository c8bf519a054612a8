// SPDX-License-Identifier: Apache-2.0
// Marks functions that run on the host and, under nvcc, on the device: the one file here that knows about CUDA.
#pragma once

#ifdef __CUDACC__
#define STANDOFF_HD __host__ __device__
#else
#define STANDOFF_HD
#endif

// Small functions of the inner loops: always inlined, so that a copy compiled for one instruction set can never be
// linked into code for another.
#if defined(__CUDACC__)
#define STANDOFF_INLINE STANDOFF_HD __forceinline__
#else
#define STANDOFF_INLINE inline __attribute__((always_inline))
#endif
