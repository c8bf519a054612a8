// SPDX-License-Identifier: Apache-2.0
// The choice of the queries' kernels.
#include "collision/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::collision {

namespace {

const Dispatch<Kernels>& dispatch() {
  static const Dispatch<Kernels> kernels;
  return kernels;
}

}  // namespace

const Kernels& kernels_for(Simd simd, const char* where) { return dispatch().of(simd, where); }
const Kernels& best_kernels() { return dispatch().best(); }
std::span<const Kernels* const> all_kernels() { return dispatch().all(); }

}  // namespace standoff::collision
