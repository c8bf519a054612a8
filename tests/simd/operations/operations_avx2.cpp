// SPDX-License-Identifier: Apache-2.0
// The wide types of AVX2.
#ifdef __AVX2__
#define STANDOFF_TARGET_AVX2
#include "tests/simd/operations/operations.inl"

namespace standoff::testing {

extern const SimdOperations kAvx2Operations = operations_of_this_target();

}  // namespace standoff::testing
#endif
