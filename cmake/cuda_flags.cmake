# SPDX-License-Identifier: Apache-2.0
# How nvcc compiles the kernels: arithmetic stays the CPU's, nothing is fused that the source does not fuse.
set(STANDOFF_CUDA_FLAGS --fmad=false --expt-relaxed-constexpr -Xcompiler=-ffp-contract=off -Xcompiler=-fno-math-errno)
# CMake before 3.27 does not know how nvcc is told C++20. Once CUDA is enabled.
if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)
  set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION -std=c++20)
  set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION -std=c++20)
endif()
# Small code for the GPUs, which is more than half of a wheel otherwise. Drivers of CUDA 13 can all unpack it.
if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 13.0)
  list(APPEND STANDOFF_CUDA_FLAGS --compress-mode=size)
endif()
