// SPDX-License-Identifier: Apache-2.0
// The instruction set that a file of kernels is compiled for, with its wide types, which have the same names in every
// set.
//
// Kernels are written once, in fragments (.inl), and compiled once per set: kernels_<set>.cpp, which CMake makes out of
// cmake/kernels.cpp.in, defines its set before it includes them. If no set is defined, as when an editor opens a
// fragment alone, it is the portable one. All functions of a fragment lie in an unnamed namespace within
// STANDOFF_TARGET, because a function compiled for one processor must never serve the code for others
// (script/check_weak_symbols).
#pragma once

#if defined(STANDOFF_TARGET_AVX512)
#define STANDOFF_TARGET avx512
#include "simd/wide_avx512.h"
#elif defined(STANDOFF_TARGET_AVX2)
#define STANDOFF_TARGET avx2
#include "simd/wide_avx2.h"
#else
#define STANDOFF_TARGET portable
#include "simd/wide_portable.h"
#endif

#define STANDOFF_QUOTED(name) #name
#define STANDOFF_NAME_OF(name) STANDOFF_QUOTED(name)
/// "avx512", "avx2" or "portable".
#define STANDOFF_TARGET_NAME STANDOFF_NAME_OF(STANDOFF_TARGET)
