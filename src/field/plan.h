// SPDX-License-Identifier: Apache-2.0
// What is computed and how: decided once, before any triangle is read.
#pragma once

#include "field/backend.h"
#include "standoff/compute.h"

namespace standoff {

struct Plan {
  const BackendRow* row;  ///< backend and method
  SkipRule rule;          ///< never automatic
  bool drops_copies;      ///< whether many copies of triangles are left out (copies.h): they change nothing
  std::int64_t triangles;
  Grid grid;
  double thickness;        ///< distances are computed up to it
  double field_thickness;  ///< the field's; that of a shell is smaller
  int threads;
  bool with_nearest;  ///< for the caller or for the sign
  bool with_sign;
  bool is_dense;              ///< into the caller's memory, not into tiles
  std::int64_t bytes_beside;  ///< for each stored sample, held by the caller
  std::int64_t slab_samples;  ///< asked for; 0: no slabs
  std::int64_t slab_layers;   ///< layers of bricks of a slab; 0: the whole grid at once
};

/// Requires a valid grid, thickness and options. `slab_samples`: about how many a slab may have, where the field is
/// computed slab by slab. It is not where its method or sign needs the whole grid. Throws Error{device} where no
/// backend fits, Error{limit} for a shell that is too thick.
Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense,
               std::int64_t slab_samples = 0);

/// Whether a sign can be decided slab by slab: not one whose sides spread from sample to sample.
bool is_decided_in_slabs(SignMethod method);

}  // namespace standoff
