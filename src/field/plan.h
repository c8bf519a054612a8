// SPDX-License-Identifier: Apache-2.0
// What is computed and how: decided once, before any triangle is read.
#pragma once

#include "field/backend.h"
#include "standoff/compute.h"

namespace standoff {

struct Plan {
  const BackendRow* row;  ///< backend and method
  SkipRule rule;          ///< never automatic
  std::int64_t triangles;
  Grid grid;
  double thickness;
  int threads;
  bool with_nearest;
  bool with_sign;
  bool is_dense;  ///< into the caller's memory, not into tiles
};

/// Requires a valid grid, thickness and options. Throws Error{device} where no backend fits.
Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options,
               bool is_dense);

}  // namespace standoff
