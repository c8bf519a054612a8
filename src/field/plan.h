// SPDX-License-Identifier: Apache-2.0
// What is computed and how, and the memory that it may need: decided before any distance.
#pragma once

#include "field/backend.h"
#include "standoff/compute.h"

namespace standoff {

// The options of a computation, and what they mean where they leave something open.

/// Throws Error{usage} for an invalid thickness or invalid options.
void validate(double thickness, const ComputeOptions& options);
/// The skip rule of the method where none is named; never automatic.
SkipRule effective_rule(const ComputeOptions& options);

struct Plan {
  const BackendRow* row;  ///< backend and method
  SkipRule rule;          ///< never automatic
  bool drops_copies;      ///< whether many copies of triangles are left out (skip.h): they change nothing
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

// How much memory a computation may need, before it starts.

/// Output and scratch, where so many tiles hold band samples; dense output takes no notice of them. `diagnosed`:
/// whether the mesh is diagnosed before, for its sign. At most 2^62.
std::int64_t bytes_needed(const Plan& plan, double tiles, bool diagnosed);
/// The same for whatever triangles: all tiles of the grid.
std::int64_t bytes_needed(const Plan& plan);
/// The same for these triangles. Uses the caller's arena. Errors: as validate(mesh).
std::int64_t bytes_needed(MeshView mesh, const Plan& plan, const ComputeOptions& options);

/// What crossings may take while the sign is decided: of a whole grid what the backend took before, if that is enough.
std::int64_t crossing_bytes(const Plan& plan);

/// Throws Error{limit} where the computation may need more than
/// options.memory_limit, with what would fit. `tiles`: those that the mesh's triangles reach (prepare.h). Requires a
/// valid mesh.
void check_memory(MeshView mesh, const Plan& plan, double tiles, const ComputeOptions& options);

}  // namespace standoff
