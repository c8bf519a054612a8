// SPDX-License-Identifier: Apache-2.0
// The wide types of AVX-512.
#ifdef __AVX512F__
#define STANDOFF_TARGET_AVX512
#include "tests/simd/operations/operations.inl"

namespace standoff::testing {

extern const SimdOperations kAvx512Operations = operations_of_this_target();

}  // namespace standoff::testing
#endif
