// The wide types of AVX2.
#ifdef __AVX2__

#include "simd/wide_avx2.h"
#include "tests/simd/operations/operations.h"

namespace standoff::testing {
namespace {

using namespace standoff::avx2;
#include "tests/simd/operations/operations.inl"

}  // namespace

extern const SimdOperations kAvx2Operations = operations_of_this_target("avx2");

}  // namespace standoff::testing

#endif
