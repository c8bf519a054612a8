// Chooses the kernels at run time.
#include "collision/cpu/kernels.h"

#include "simd/instruction_sets.h"

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

struct Available {
  const Kernels* rows[4] = {};
  Available() {
    int n = 0;
#ifdef __x86_64__
    if (has_avx512()) rows[n++] = &avx512::kKernels;
    if (has_avx2()) rows[n++] = &avx2::kKernels;
#endif
    rows[n] = &portable::kKernels;
  }
};

const Available& available() {
  static const Available rows;
  return rows;
}

}  // namespace

const Kernels& kernels() { return *available().rows[0]; }
const Kernels* const* all_kernels() { return available().rows; }

}  // namespace standoff::collision
