// SPDX-License-Identifier: Apache-2.0
// Hermite data: where the edges of a grid cross the triangles of a mesh, with normals (docs/voxels.md). Isosurfaces
// that keep sharp edges (dual contouring) are made of these.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "standoff/execution.h"
#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"
#include "standoff/vec.h"

namespace standoff {

/// A triangle crosses an edge of a grid: the segment from a sample to the next one along an axis.
struct EdgeCrossing {
  std::array<std::int64_t, 3> sample{};  ///< (i, j, k), where the edge begins
  double place = 0;                      ///< along the edge, from 0 at the sample to 1 at the next one
  Vec3 normal;                           ///< unit normal of the triangle, in the orientation that was asked for
  std::uint32_t triangle = kNoTriangle;
  std::uint8_t axis = 0;  ///< 0 to 2 for x to z
  bool enters = false;    ///< the edge passes from the triangle's front, where the normal points to, to its back

  /// The place in world units: on the edge, and on the triangle within rounding.
  Vec3 position(const Grid& grid) const {
    Vec3 at = grid.position(sample[0], sample[1], sample[2]);
    at[axis] += grid.spacing[axis] * place;
    return at;
  }
};

struct EdgeCrossingOptions {
  /// Which triangles count, and how they are oriented: as compute() takes them for this sign. none: all, as they
  /// are. winding, normal and automatic orient them and leave out what the sign leaves out (copies, inner walls; with
  /// `outer` triangles inside); parity and flood take them as they are; `invert` turns all. shell is an error: its
  /// surface is not the mesh.
  SignOptions sign = {};
  Execution execution = {};  ///< runs on the CPU
  /// Bytes for the crossings while they are found. 0: default_memory_limit(); negative: no limit.
  std::int64_t memory_limit = 0;
  ProgressCallback progress = {};
};

/// All crossings of the grid's edges with the mesh, sorted by sample (x fastest), axis, place and triangle; the same
/// for any number of threads.
///
/// Which edges a triangle crosses is decided exactly, and every sample counts as a point beside itself
/// (docs/voxels.md): so an edge that passes through an edge or a corner of a mesh crosses each of the sheets there
/// once, one along a triangle does not cross it, and none ends on a triangle. A closed mesh is crossed an even number
/// of times by each closed path along edges. `place` is within 1e-12 of the exact one, and `normal` within 1e-14.
/// Coordinates must be zero or of magnitude 1e-90 to 1e100.
///
/// Takes 64 bytes for each crossing, and up to three times that while they are found. Errors: usage (grid, sign,
/// execution), input (mesh; a sign that does not fit it), doubt (`strict`), limit (memory, coordinates), interrupted.
STANDOFF_API std::vector<EdgeCrossing> edge_crossings(MeshView mesh, const Grid& grid,
                                                      const EdgeCrossingOptions& options = {});

/// Writes crossings as .npz, a column each (`sample` n x 3 int64, `axis` uint8, `place` float64, `triangle` uint32,
/// `normal` n x 3 float32, `enters` bool; and the grid: `size`, `origin`, `spacing`), or as .csv, with their positions;
/// the file appears whole or not at all. Errors: output, usage (another extension).
STANDOFF_API void write_crossings(const std::filesystem::path& path, std::span<const EdgeCrossing> crossings,
                                  const Grid& grid, Existing existing = Existing::replace);

}  // namespace standoff
