// SPDX-License-Identifier: Apache-2.0
// The platform of kernels and of the code that launches them: CUDA, or its emulation on the CPU. Every .cuh file is
// compiled for both, each in its own namespace.
#pragma once

#include <cstdint>

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
// Marks a function that kernels call and that is seldom needed: what it takes is not added to the kernel's registers.
// Parameters of the kernel that it is given by reference are marked STANDOFF_CONSTANT there; else they would be copied.
#ifdef __CUDACC__
#define STANDOFF_SELDOM [[maybe_unused]] static __device__ __noinline__
#define STANDOFF_CONSTANT const __grid_constant__
#else
#define STANDOFF_SELDOM [[maybe_unused]] static
#define STANDOFF_CONSTANT const
#endif
// Before a loop: nvcc does not unroll it. For loops that take little of a kernel's time, but much of the instruction
// cache if they are unrolled.
#ifdef __CUDACC__
#define STANDOFF_ROLLED _Pragma("unroll 1")
#else
#define STANDOFF_ROLLED
#endif

namespace standoff::STANDOFF_PLATFORM {

/// Device memory that is replaced if it is too small; then its content is lost.
class Growing {
 public:
  /// Returns room for `count` elements. Throws Error{limit}.
  template <class T>
  T* room_for(std::int64_t count) {
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    if (bytes > bytes_) {
      memory_ = Memory();  // free the old memory first; cudaFree waits for kernels that still read it
      bytes_ = 0;
      memory_ = Memory(bytes);
      bytes_ = bytes;
    }
    return memory_.as<T>();
  }
  /// How much there is; as much or more than was asked for.
  std::int64_t bytes() const { return bytes_; }

 private:
  Memory memory_;
  std::int64_t bytes_ = 0;
};

}  // namespace standoff::STANDOFF_PLATFORM
