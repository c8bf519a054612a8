// SPDX-License-Identifier: Apache-2.0
// The queries' kernels for each instruction set, and the choice among them.
#include "collision/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::collision {

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

const Dispatch<Kernels>& dispatch() {
  static const Dispatch<Kernels> kernels({
#ifdef __x86_64__
      {Simd::avx512, &avx512::kKernels},
      {Simd::avx2, &avx2::kKernels},
#endif
      {Simd::portable, &portable::kKernels},
  });
  return kernels;
}

}  // namespace

const Kernels& kernels_for(Simd simd, const char* where) { return dispatch().of(simd, where); }
const Kernels& best_kernels() { return dispatch().best(); }
std::span<const Kernels* const> all_kernels() { return dispatch().all(); }

}  // namespace standoff::collision
