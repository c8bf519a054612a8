// What the processor has, asked in one place: kernels are compiled for sets of instructions (cmake/simd.cmake), and a
// processor that lacks one of a set's would crash in its kernels.
#pragma once

namespace standoff {

/// All that the AVX2 kernels are compiled with.
inline bool has_avx2() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

/// All that the AVX-512 kernels are compiled with.
inline bool has_avx512() {
#ifdef __x86_64__
  return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

}  // namespace standoff
