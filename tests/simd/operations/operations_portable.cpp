// SPDX-License-Identifier: Apache-2.0
// The wide types of every processor.
#include "tests/simd/operations/operations.inl"

namespace standoff::testing {

extern const SimdOperations kPortableOperations = operations_of_this_target();

}  // namespace standoff::testing
