// SPDX-License-Identifier: Apache-2.0
// The plan of a computation: backend, method and slabs, and the memory that it may need, decided before any distance.
#pragma once

#include <vector>

#include "field/backend.h"
#include "standoff/compute.h"

namespace standoff {

/// Throws Error{usage} for an invalid thickness or invalid options.
void validate(double thickness, const ComputeOptions& options);
/// Throws Error{usage} for slabs of less than a sample.
void check_slab_samples(std::int64_t samples);
/// The skip rule of the method where none is named; never automatic.
SkipRule effective_rule(const ComputeOptions& options);

struct Plan {
  const BackendRow* row;  ///< backend and method
  SkipRule rule;          ///< never automatic
  bool drops_copies;      ///< whether copies of triangles are left out if they are many (skip.h): this changes no bit
  std::int64_t triangles;
  Grid grid;
  double thickness;        ///< distances are computed up to this
  double field_thickness;  ///< the field's thickness, which is smaller if the sign is a shell
  int threads;
  bool with_nearest;  ///< the caller or the sign needs nearest triangles
  bool with_sign;
  bool is_dense;              ///< into the caller's memory, not into tiles
  std::int64_t slab_samples;  ///< asked for; 0: no slabs
  std::int64_t slab_layers;   ///< layers of bricks of a slab; 0: the whole grid at once
  std::vector<int> devices;   ///< at least one
};

/// Requires a valid grid, thickness and options. `slab_samples`: the approximate size of a slab; it has no effect if
/// the method or the sign needs the whole grid. Throws Error{device} if no backend fits, Error{limit} for a shell that
/// is too thick.
Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense,
               std::int64_t slab_samples = 0);

/// Whether a sign can be decided slab by slab: methods that spread signs from sample to sample cannot.
bool is_decided_in_slabs(SignMethod method);

/// Bytes of output and scratch memory that a computation may need, at most 2^62. `tiles`: how many hold band samples;
/// dense output does not depend on it. `diagnosed`: whether the mesh is diagnosed before, for its sign.
std::int64_t bytes_needed(const Plan& plan, double tiles, bool diagnosed);
/// The same for any triangles: all tiles of the grid may hold band samples.
std::int64_t bytes_needed(const Plan& plan);
/// The same for the triangles of a mesh. Uses the caller's arena. Throws the errors of validate(mesh).
std::int64_t bytes_needed(MeshView mesh, const Plan& plan, const ComputeOptions& options);

/// How a computation in slabs of so many samples runs. On a GPU there are no slabs: if the caller does not mind, the
/// CPU makes some where the whole field would be beyond the memory limit, or there is none.
/// `mesh`: null where any mesh of so many triangles is meant.
ComputeOptions with_slabs(std::int64_t triangles, const MeshView* mesh, const Grid& grid, double thickness,
                          const ComputeOptions& options, std::int64_t slab_samples);

/// What crossings may take while the sign is decided: of a whole grid what the backend took before, if that is enough.
std::int64_t crossing_bytes(const Plan& plan);

/// The limit that the options set, bytes; 0 where there is none.
std::int64_t memory_limit_of(const ComputeOptions& options);

/// Throws Error{limit} where the computation may need more than the options' limit, with what would fit. `tiles`: those
/// that the mesh's triangles reach (prepare.h). Requires a valid mesh.
void check_memory(MeshView mesh, const Plan& plan, double tiles, const ComputeOptions& options);

}  // namespace standoff
