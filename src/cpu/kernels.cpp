// Chooses the kernels at run time.
#include "cpu/kernels.h"

#include "difi/error.h"

namespace difi::cpu {

namespace portable {
extern const Kernels kKernels;
}
#ifdef __x86_64__
namespace avx2 {
extern const Kernels kKernels;
}
namespace avx512 {
extern const Kernels kKernels;
}
#endif

namespace {

bool supports(Simd simd) {
#ifdef __x86_64__
  if (simd == Simd::avx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (simd == Simd::avx512)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#endif
  return simd == Simd::portable;
}

const Kernels& kernels_of(Simd simd) {
#ifdef __x86_64__
  if (simd == Simd::avx512) return avx512::kKernels;
  if (simd == Simd::avx2) return avx2::kKernels;
#endif
  static_cast<void>(simd);
  return portable::kKernels;
}

}  // namespace

const Kernels& kernels_for(Simd simd) {
  if (simd == Simd::automatic) {
    for (const Simd best : {Simd::avx512, Simd::avx2})
      if (supports(best)) return kernels_of(best);
    return kernels_of(Simd::portable);
  }
  if (!supports(simd))
    throw Error(ErrorCode::usage, "compute: this processor lacks the instruction set asked for; use automatic");
  return kernels_of(simd);
}

}  // namespace difi::cpu
