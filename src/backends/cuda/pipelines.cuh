// SPDX-License-Identifier: Apache-2.0
// Which pipeline computes a field: by the method, and for `tiles` by the thickness.
#pragma once

#include "field/cuda/pipeline.cuh"
#include "thesis/algorithm_1.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Calls use.template operator()<Pipeline>().
template <class Use>
auto with_pipeline(Method method, const Grid& grid, double thickness, Use use) {
  if (method == Method::thesis) return use.template operator()<Algorithm1>();
  return with_tiles_pipeline(grid, thickness, use);
}

}  // namespace standoff::STANDOFF_PLATFORM
