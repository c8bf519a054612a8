// SPDX-License-Identifier: Apache-2.0
// The inner loop of the sign, compiled once per instruction set (kernels_*.cpp) and chosen at run time.
#pragma once

#include "sign/cpu/row_patch.h"
#include "standoff/execution.h"

namespace standoff::cpu {

struct SignKernels {
  /// Finds the rows that cross the triangles of at most CrossedRows::kMostPatches patches, in any order.
  void (*cross_rows)(const RowPatch* patches, int count, CrossedRows&);
};

/// The kernels for an instruction set; the best one there is for Simd::automatic. Throws Error{usage} where the
/// processor does not have the set.
const SignKernels& sign_kernels_for(Simd simd);

}  // namespace standoff::cpu
