// The wide types of AVX512.
#ifdef __AVX512F__

#include "simd/wide_avx512.h"
#include "tests/simd/operations/operations.h"

namespace standoff::testing {
namespace {

using namespace standoff::avx512;
#include "tests/simd/operations/operations.inl"

}  // namespace

extern const SimdOperations kAvx512Operations = operations_of_this_target("avx512");

}  // namespace standoff::testing

#endif
