// Chooses the kernels at run time.
#include "collision/kernels.h"

namespace difi::collision {

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
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl"))
      rows[n++] = &avx512::kKernels;
    if (__builtin_cpu_supports("avx2")) rows[n++] = &avx2::kKernels;
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

}  // namespace difi::collision
