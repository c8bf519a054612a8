// SPDX-License-Identifier: Apache-2.0
// Surfaces out of fields and meshes: watertight, oriented triangle meshes (docs/surface.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "standoff/compute.h"
#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"
#include "standoff/slice_reader.h"

namespace standoff {

enum class SurfaceMethod {
  marching_cubes,  ///< vertices on the grid's edges: smooth, and as fine as the grid
  dual,            ///< vertices in the grid's cells, by dual contouring: keeps sharp edges and corners of meshes
};

/// The numbers of a surface's vertices. With either no two vertices coincide.
enum class Coordinates {
  automatic,  ///< single where vertices are moved by no more than 1/1024 of the spacing, else full
  single,     ///< each is a 32-bit float, as .stl files hold them
  full,       ///< 64-bit numbers
};

struct SurfaceOptions {
  /// The value on the surface, world units. Inside is where values are less; negative: the solid shrinks, positive: it
  /// grows by rounding.
  double at = 0;
  /// If positive: a second surface at `at - wall`, which faces inwards: the solid becomes hollow, with walls that are
  /// this thick, world units. At least the largest spacing.
  double wall = 0;
  SurfaceMethod method = SurfaceMethod::marching_cubes;
  Coordinates coordinates = Coordinates::automatic;
  /// Of a mesh alone: how inside is decided. Without an inside `at` must be positive.
  SignOptions sign = {};
  /// Bytes that the surface and its making may take, and from a mesh also the field. 0: default_memory_limit();
  /// negative: no limit. What `examine` takes comes later and is not limited, nor a field that the caller gives.
  std::int64_t memory_limit = 0;
  bool examine = false;      ///< also count components and self-intersections of the result
  Execution execution = {};  ///< the backend must be automatic or cpu, but for the field that a mesh needs
  ProgressCallback progress = {};
};

struct SurfaceReport {
  std::int64_t triangles = 0, vertices = 0;
  std::int64_t ambiguous_faces = 0;  ///< faces whose corners can be joined in two ways (docs/surface_methods.md)
  /// Crossed edges with an end whose value is clamped to the thickness: their vertices are less accurate.
  std::int64_t clamped = 0;
  std::int64_t capped = 0;      ///< crossed edges that leave the grid: the surface is closed there by a flat cap
  bool floats = false;          ///< whether all coordinates are 32-bit floats
  double clearance = 0;         ///< the clearance: vertices keep so far from samples, in spacings
  bool examined = false;        ///< SurfaceOptions::examine
  std::int64_t components = 0;  ///< if examined
  std::int64_t self_intersections = 0;  ///< if examined: pairs of triangles without a common vertex that intersect
  bool intersections_known = true;      ///< if examined. false: the search was stopped, and there may be more
  SignReport sign;                      ///< of a mesh: how its sign was decided
  // Of a mesh, for levels that are not negative: what the surface shows nothing of, because no sample is inside there.
  double lost_share = 0;        ///< the part of the mesh's area that is outside, and farther than a spacing from it
  std::int64_t parts = 0;       ///< of the mesh: triangles that share positions, directly or through others
  std::int64_t lost_parts = 0;  ///< those that are lost as a whole
  double lost_thickness = 0;    ///< about the thickness of the thinnest of them, world units; 0: none has a volume
  std::string lost;             ///< one sentence with a way to keep them; empty if nothing to speak of is lost
};

struct SurfaceResult {
  Mesh mesh;  ///< empty if no value, or each value, is less than `at`
  SurfaceReport report;
};

/// The surface on which the trilinear interpolation of a field has the value options.at. It is closed, oriented
/// outwards, and a manifold: each edge belongs to two triangles, the triangles at a vertex form one fan, and no two
/// vertices have the same position. All beyond the grid is outside. A sample of exactly options.at is outside, but -0
/// is less than 0. The result has the same bits for any number of threads. Takes memory in proportion to the surface,
/// and 64 bytes per stored tile: at most options.memory_limit. `dual` takes normals from the gradient of the field.
/// Errors: usage (options; a value that is not within the field's thickness), input (a value that is not a number),
/// limit (memory; more than 2^32 - 2 vertices; coordinates), interrupted.
STANDOFF_API SurfaceResult surface(const DistanceField& field, const SurfaceOptions& options = {});

/// The same of a field that is read some slices at a time, so that it may be larger than memory: by marching cubes
/// without a wall, with the same bits. Memory is that of the slices read at a time, which are of about `slice_samples`
/// samples and 16 slices more, and of the surface. Errors: as above, what `read` throws, and usage where it returns
/// other slices.
STANDOFF_API SurfaceResult surface(const Grid& grid, double thickness, const SliceReader& read,
                                   const SurfaceOptions& options = {}, std::int64_t slice_samples = kSlabSamples);

/// The same from a mesh: computes the field that is needed, of the mesh on this grid. `dual` takes its normals from the
/// mesh: sharp edges and corners come back.
/// Errors: as above, and those of compute().
STANDOFF_API SurfaceResult surface(MeshView mesh, const Grid& grid, const SurfaceOptions& options = {});

}  // namespace standoff
