// SPDX-License-Identifier: Apache-2.0
// The instruction set that a file of kernels is compiled for: its wide types, under the same names for every set.
//
// Kernels are written once, in fragments (.inl), and compiled once per set, by a kernels_<set>.cpp that says its set
// before it includes them. Where none was said, as when a fragment is opened by itself in an editor, the set is the
// portable one. All functions of a fragment lie in a namespace without a name within one called STANDOFF_TARGET: no
// copy of a function compiled for one processor may serve the code for others (script/check_weak_symbols).
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
