// SPDX-License-Identifier: Apache-2.0
// What the processor has, asked in one place: kernels are compiled for sets of instructions (cmake/simd.cmake), and a
// processor that lacks one of a set's would crash in its kernels.
#pragma once

#include "standoff/execution.h"

namespace standoff {

/// Whether this processor has all that the kernels of a set are compiled with. Every one has `portable`.
inline bool processor_has(Simd set) {
#ifdef __x86_64__
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (set == Simd::avx2) return avx2;
  if (set == Simd::avx512)
    return avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#endif
  return set == Simd::portable;
}

}  // namespace standoff
