// SPDX-License-Identifier: Apache-2.0
// Single meshes in device memory: what standoff/cuda_compute.h does for many.
#pragma once

#include "standoff/cuda_compute.h"

namespace standoff::testing {

inline ComputeReport compute_one(const MeshView& mesh, const Grid& grid, double thickness, float* values, Method method,
                                 const cuda::OnStream& on) {
  const cuda::FieldRequest request{mesh, grid, thickness, values, method};
  return cuda::value_or_throw(cuda::compute_each({&request, 1}, on)[0]);
}

inline Box bounds_of_one(const MeshView& mesh, const cuda::OnStream& on) {
  return cuda::value_or_throw(cuda::bounds_of_each({&mesh, 1}, on)[0]);
}

}  // namespace standoff::testing
