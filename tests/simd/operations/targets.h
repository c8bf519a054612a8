// SPDX-License-Identifier: Apache-2.0
// Which SIMD targets this processor has. Not for the files that are compiled for one of them: others may get their
// copy.
#pragma once

#include <vector>

#include "simd/dispatch.h"
#include "tests/simd/operations/operations.h"

namespace standoff::testing {

inline std::vector<const SimdOperations*> targets() {
  std::vector<const SimdOperations*> found{&kPortableOperations};
#ifdef __x86_64__
  if (processor_has(Simd::avx2)) found.push_back(&kAvx2Operations);
  if (processor_has(Simd::avx512)) found.push_back(&kAvx512Operations);
#endif
  return found;
}

}  // namespace standoff::testing
