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
  double thickness;        ///< distances are computed up to it
  double field_thickness;  ///< the field's; that of a shell is smaller
  int threads;
  bool with_nearest;  ///< for the caller or for the sign
  bool with_sign;
  bool is_dense;              ///< into the caller's memory, not into tiles
  std::int64_t bytes_beside;  ///< for each stored sample, held by the caller
};

/// Requires a valid grid, thickness and options. Throws Error{device} where no backend fits,
/// Error{limit} for a shell that is too thick.
Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options,
               bool is_dense);

}  // namespace standoff
