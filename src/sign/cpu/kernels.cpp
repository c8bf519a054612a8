// SPDX-License-Identifier: Apache-2.0
// The sign's kernels for each instruction set, and the choice among them.
#include "sign/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::cpu {

const SignKernels& sign_kernels_for(Simd simd) {
  static const Dispatch<SignKernels> kernels;
  return kernels.of(simd, "sign");
}

}  // namespace standoff::cpu
