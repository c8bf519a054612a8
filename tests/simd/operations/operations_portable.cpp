// The wide types of every processor.
#include "simd/wide_portable.h"
#include "tests/simd/operations/operations.h"

namespace standoff::testing {
namespace {

using namespace standoff::portable;
#include "tests/simd/operations/operations.inl"

}  // namespace

extern const SimdOperations kPortableOperations = operations_of_this_target("portable");

}  // namespace standoff::testing
