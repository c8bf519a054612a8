// SPDX-License-Identifier: Apache-2.0
// The table of the methods' pipelines on a GPU.
#pragma once

#include "approximate/spread.cuh"
#include "field/cuda/pipeline.cuh"
#include "thesis/algorithm_1.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Calls use.template operator()<Pipeline>() with the pipeline of a method; for `tiles`, the thickness decides too.
/// Throws Error{usage} if the method has none.
template <class Use>
auto with_pipeline(Method method, const Grid& grid, double thickness, Use use) {
  switch (method) {
    case Method::tiles:
      return with_tiles_pipeline(grid, thickness, use);
    case Method::thesis:
      return use.template operator()<Algorithm1>();
    case Method::propagate:
      return use.template operator()<Spreading<Propagation>>();
    case Method::jumpflood:
      return use.template operator()<Spreading<Jumps<0>>>();
    case Method::jumpflood_1:
      return use.template operator()<Spreading<Jumps<1>>>();
    case Method::fuhrmann:
      break;
  }
  throw Error(ErrorCode::usage, "cuda: this method runs on the CPU alone; take another method, or compute()");
}

}  // namespace standoff::STANDOFF_PLATFORM
