// SPDX-License-Identifier: Apache-2.0
// Surface voxels, and files of voxels (docs/voxels.md). A voxel is the box around a sample of a grid that reaches half
// a spacing to each side. Solid voxels are those whose sample is inside: standoff/occupancy.h.
#pragma once

#include <filesystem>

#include "standoff/execution.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/occupancy.h"
#include "standoff/progress.h"

namespace standoff {

struct SurfaceVoxelOptions {
  Execution execution = {};  ///< the backend must be automatic or cpu
  ProgressCallback progress = {};
};

/// The voxels that have a point in common with a triangle, faces, edges and corners included. No such voxel is missed.
/// Rounding may add voxels that a triangle misses by less than 1e-12 of the triangle's size and the spacing together.
/// Takes a bit per sample. The same bits for any number of threads. Runs on the CPU.
/// Errors: usage (grid, execution), input (mesh), limit (memory; coordinates beyond 1e100), interrupted.
STANDOFF_API Occupancy surface_voxels(MeshView mesh, const Grid& grid, const SurfaceVoxelOptions& options = {});

/// Adds the voxels of another grid of the same samples: those of the surface to solid ones, for example. The sign's
/// report stays. Errors: usage (the grids, or the lengths of the bits, differ).
STANDOFF_API void add_voxels(Occupancy& to, const Occupancy& more);

/// Writes voxels as bytes, 0 or 1, in .npz (`voxels`, `origin`, `spacing`), .nrrd or .vti (`voxels`), x fastest, or as
/// .binvox, which packs runs. A .binvox file has equal sides: it is filled up with empty voxels along the shorter ones,
/// and its voxels must be cubes. The file appears whole or not at all; the bytes are never all in memory.
/// Errors: usage (another extension; bits that are not the grid's; a .binvox of voxels that are no cubes), output.
STANDOFF_API void write_voxels(const std::filesystem::path& path, const Occupancy& voxels,
                               Existing existing = Existing::replace);

}  // namespace standoff
