// SPDX-License-Identifier: Apache-2.0
// The inner loops of the sign, compiled once per instruction set (kernels_*.cpp) and chosen at run time.
#pragma once

#include "sign/cpu/row_patch.h"
#include "sign/cpu/solid_angles.h"
#include "standoff/execution.h"

namespace standoff::cpu {

struct SignKernels {
  /// Finds the rows that cross the triangles of at most CrossedRows::kMostPatches patches, in any order.
  void (*cross_rows)(const RowPatch* patches, int count, CrossedRows&);
  /// Adds the solid angles of at most AngleChunk::kMost triangles, first to first + count - 1, seen from p (three
  /// floats). Those that have a corner nearer than `least_length`, and some others, are left out (AngleChunk).
  void (*add_solid_angles)(const AngleTriangles&, std::int64_t first, int count, const float* p, float least_length,
                           AngleSums&, AngleChunk&);
};

/// The kernels for an instruction set; the best one there is for Simd::automatic. Throws Error{usage} where the
/// processor does not have the set.
const SignKernels& sign_kernels_for(Simd simd);

}  // namespace standoff::cpu
