// What the kernels and the code that launches them run on: CUDA, or its emulation on the CPU. All of src/cuda that ends
// in .cuh is compiled for both, each in a namespace of its own.
#pragma once

#ifdef __CUDACC__
#define DIFI_PLATFORM cuda
#include "cuda/platform_cuda.cuh"
#else
#define DIFI_PLATFORM emulated
#include "cuda/platform_emulated.h"
#endif

// A kernel: every file that launches it has one of its own.
#define DIFI_KERNEL [[maybe_unused]] static __global__
// A function that kernels call.
#define DIFI_DEVICE __device__ __forceinline__
