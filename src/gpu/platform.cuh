// SPDX-License-Identifier: Apache-2.0
// What the kernels and the code that launches them run on: CUDA, or its emulation on the CPU. All that ends
// in .cuh is compiled for both, each in a namespace of its own.
#pragma once

#ifdef __CUDACC__
#define STANDOFF_PLATFORM cuda
#include "gpu/platform_cuda.cuh"
#else
#define STANDOFF_PLATFORM emulated
#include "gpu/platform_emulated.h"
#endif

// A kernel: every file that launches it has one of its own.
#define STANDOFF_KERNEL [[maybe_unused]] static __global__
// A function that kernels call.
#define STANDOFF_DEVICE __device__ __forceinline__
