// Chooses the kernels at run time.
#include "field/cpu/kernels.h"

#include "simd/instruction_sets.h"
#include "standoff/error.h"

namespace standoff::cpu {

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
  if (simd == Simd::avx2) return has_avx2();
  if (simd == Simd::avx512) return has_avx512();
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

}  // namespace standoff::cpu
