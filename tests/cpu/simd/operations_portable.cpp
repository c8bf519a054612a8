// The wide types of every processor.
#include "cpu/simd/wide_portable.h"
#include "tests/cpu/simd/operations.h"

namespace standoff::testing {
namespace {

using namespace standoff::portable;
#include "tests/cpu/simd/operations_body.h"

}  // namespace

extern const SimdOperations kPortableOperations = operations_of_this_target("portable");

}  // namespace standoff::testing
