// SPDX-License-Identifier: Apache-2.0
// The plan of a computation: backend, method and parts, and the memory that it may need, decided before any distance.
#pragma once

#include <limits>
#include <vector>

#include "core/tile_count.h"
#include "field/backend.h"
#include "standoff/compute.h"

namespace standoff {

struct SignMemory;

/// Throws Error{usage} for an invalid thickness or invalid options.
void validate(double thickness, const ComputeOptions& options);
/// The size of slabs of about so many samples: whole layers of bricks. Requires a valid grid. Throws Error{usage} for
/// slabs of less than a sample.
Size3 slab_size(const Grid& grid, std::int64_t samples);
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
  /// The backend gets the sign to decide. It is planned only where the backend has doubts: then after the distances.
  bool sign_by_backend;
  bool is_dense;             ///< into the caller's memory, not into tiles
  bool in_windows;           ///< computed window by window; if not, the whole grid at once
  Size3 part;                ///< the largest window, in samples; the grid's size if there are none
  std::vector<int> devices;  ///< at least one
};

/// Requires a valid grid, thickness and options. `window`: the size of the largest window that will be asked for,
/// nothing where there are none; it has no effect if the method or the sign needs the whole grid. Throws Error{device}
/// if no backend fits, Error{limit} for a shell that is too thick.
Plan make_plan(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense,
               const Size3& window = {});

/// Plans the whole grid at once.
void take_whole(Plan& plan);

/// Upper bounds of what a mesh reaches; infinite where it was not counted.
struct ReachCounts {
  double tiles = std::numeric_limits<double>::infinity();       ///< with samples within the thickness of a triangle
  double brick_refs = std::numeric_limits<double>::infinity();  ///< as in MeshLoad
  double crossings = std::numeric_limits<double>::infinity();   ///< of the grid's rows, for signs
};

/// Bytes of output and scratch memory that a computation may need, at most 2^62. Dense output does not depend on tiles.
std::int64_t bytes_needed(const Plan& plan, const ReachCounts& counts, const SignMemory& sign);
/// The same for any triangles: all tiles of the grid may hold band samples.
std::int64_t bytes_needed(const Plan& plan, const ComputeOptions& options);
/// The same for the triangles of a mesh. Uses the caller's arena. Throws the errors of validate(mesh).
std::int64_t bytes_needed(MeshView mesh, const Plan& plan, const ComputeOptions& options);

/// Whether windows may share the crossings of all rows of the grid, if these are few: it has at most 65,536 rows of
/// tiles.
inline bool may_share_rows(const Grid& grid) { return tiles_along(grid.size.y) <= 65536 / tiles_along(grid.size.z); }

/// What crossings may take while the sign is decided: of a whole grid what the backend took before, if that is enough,
/// and no more than what so many crossings take.
std::int64_t crossing_bytes(const Plan& plan, double crossings = std::numeric_limits<double>::infinity());

/// The limit that the options set, bytes; 0 where there is none.
std::int64_t memory_limit_of(const ComputeOptions& options);

/// Throws Error{limit} where the computation may need more than the options' limit, with what would fit. `counts`:
/// those of the mesh (prepare.h). Requires a valid mesh.
void check_memory(MeshView mesh, const Plan& plan, const ReachCounts& counts, const ComputeOptions& options);

}  // namespace standoff
