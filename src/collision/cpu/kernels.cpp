// SPDX-License-Identifier: Apache-2.0
// The choice of the queries' kernels.
#include "collision/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::collision {

const Kernels& kernels_for(Simd simd, const char* where) { return dispatch_of<Kernels>().of(simd, where); }
const Kernels& best_kernels() { return dispatch_of<Kernels>().best(); }
std::span<const Kernels* const> all_kernels() { return dispatch_of<Kernels>().all(); }

}  // namespace standoff::collision
