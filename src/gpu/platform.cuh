// SPDX-License-Identifier: Apache-2.0
// The platform of kernels and of the code that launches them: CUDA, or its emulation on the CPU. Every .cuh file is
// compiled for both, each in its own namespace.
#pragma once

#ifdef __CUDACC__
#define STANDOFF_PLATFORM cuda
#include "gpu/platform_cuda.cuh"
#else
#define STANDOFF_PLATFORM emulated
#include "gpu/platform_emulated.h"
#endif

// Marks a kernel; every file that launches it has its own copy.
#define STANDOFF_KERNEL [[maybe_unused]] static __global__
// Marks a function that kernels call.
#define STANDOFF_DEVICE __device__ __forceinline__
