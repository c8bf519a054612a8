// SPDX-License-Identifier: Apache-2.0
// Computes distance fields of meshes.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "standoff/error.h"
#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/memory.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"
#include "standoff/sign_decision.h"

namespace standoff {

/// An algorithm that fills a field.
enum class Method {
  tiles,   ///< exact; the default (docs/tiles.md)
  thesis,  ///< Algorithm 1 of the 2008 thesis (docs/thesis.md); not exact where its skip rule drops a triangle
  // Algorithms of others, for comparison. None is exact (docs/methods.md).
  fuhrmann,     ///< prisms along the triangles' normals; on the CPU alone, no full fields
  propagate,    ///< vector propagation: exact at the surface, from there nearest triangles are handed on by sweeps
  jumpflood,    ///< jump flooding (JFA): the same by jumps that halve
  jumpflood_1,  ///< jump flooding with a pass of step 1 at the end (JFA+1)
};

/// What is said of a method.
struct MethodInfo {
  Method method;
  const char* name;         ///< in options and reports
  const char* what;         ///< for help
  bool full_fields = true;  ///< also computes fields of infinite thickness
  bool spreads = false;     ///< hands values on from sample to sample, and so needs the whole grid at once
};

/// All methods. Checks, messages, help and reports ask this table.
inline constexpr MethodInfo kComputeMethods[] = {
    {Method::tiles, "tiles", "exact"},
    {Method::thesis, "thesis", "Algorithm 1 of 2008"},
    {Method::fuhrmann, "fuhrmann", "prisms along normals, not exact", false},
    {Method::propagate, "propagate", "vector propagation, not exact", true, true},
    {Method::jumpflood, "jumpflood", "jump flooding, not exact", true, true},
    {Method::jumpflood_1, "jumpflood+1", "the same and one more step", true, true},
};

/// The row of a method; nullptr for numbers that are none.
constexpr const MethodInfo* find_info(Method method) {
  for (const MethodInfo& info : kComputeMethods)
    if (info.method == method) return &info;
  return nullptr;
}

/// A rule that decides which triangles are left out before any distance is computed (docs/skip.md).
struct SkipRule {
  enum class Kind {
    automatic,  ///< the method's default: neighbour(1) for thesis; copies alone, if they are many, for tiles
    none,       ///< keep all triangles
    neighbour,  ///< the thesis's rule: drop a triangle whose grown box lies inside its predecessor's or successor's
    exact,      ///< drop only triangles that provably change no sample
  };
  Kind kind = Kind::automatic;
  double fraction = 1;  ///< neighbour only: the share of the box that must lie inside, in (0, 1]
};

struct ComputeOptions {
  Method method = Method::tiles;
  SkipRule skip = {};
  /// By default values inside are negative, if the mesh has an inside. The memory limit counts what closed meshes need,
  /// and diagnosing others; not the holes of open meshes, floods and pseudonormals (docs/sign_methods.md, "Limits").
  SignOptions sign = {};
  /// Of WindowComputation::decision(), for this mesh and such a sign: then nothing of it is decided again, and the
  /// values are the same. Empty: it is decided. Errors: usage (it is for another mesh, sign or grid), input (damaged).
  SignDecision decision = {};
  Execution execution = {};
  /// Bytes of output and scratch memory together. 0: default_memory_limit(); negative: no limit.
  std::int64_t memory_limit = 0;
  bool nearest = false;  ///< also store the nearest triangle's index per band sample, lowest on ties
  /// Also store the mesh's hash in the field's provenance, so that verify() and readers of the field's file can detect
  /// that a mesh is not the field's. Costs one pass over the mesh. compute_into dense memory stores no provenance.
  bool hash_mesh = true;
  ProgressCallback progress = {};
  /// Several GPUs that share the field, by the method `tiles` alone: they take windows of the grid in turn. They take
  /// the place of Execution::device. The values do not depend on them.
  std::vector<int> devices = {};
  /// The mesh's axis that points up, MeshReadReport::up, for the field's provenance: pictures of the field then stand
  /// as those of the mesh do. No value depends on it.
  std::optional<Axis> up = {};
};

/// What a computation did.
struct ComputeReport {
  std::string method;   ///< a name of kComputeMethods
  std::string backend;  ///< "cpu", "cuda" or "emulated"
  std::string device;   ///< the instruction set, or the GPU's name; of several GPUs, ", " is between
  int threads = 0;
  std::int64_t triangles = 0;
  std::int64_t skipped = 0;           ///< triangles left out by the skip rule, or as copies of others
  std::int64_t samples = 0;           ///< samples of the grid
  std::int64_t samples_examined = 0;  ///< sample-triangle distances computed
  std::int64_t samples_band = 0;      ///< samples whose distance is at most the thickness
  std::int64_t tiles = 0;             ///< tiles of the grid
  SignReport sign;                    ///< how the sign was decided
  Provenance provenance;              ///< as stored in the field; without the mesh's hash for dense memory
  std::int64_t tiles_stored = 0;      ///< tiles with a band sample; 0 from compute_into, which stores none
  struct Seconds {
    double prepare = 0;  ///< validation, skip rule
    double compute = 0;  ///< the backend's work, and hashing the mesh if that is done
    double sign = 0;     ///< deciding which samples are inside, if a GPU has not done that with the distances
  } seconds;
};

struct ComputeResult {
  DistanceField field;
  ComputeReport report;
};

/// Computes the field of `mesh` on `grid`. `thickness` is half the width of the band in world units, positive: larger
/// distances are stored as the thickness. kFullField stores all distances. For every valid mesh within 2^30 spacings
/// of the grid, `tiles` guarantees |value - d| <= 1e-6 * (d + 16 * max spacing) + 4 * epsilon * C against double
/// precision, and the same bits for any number of threads. Here d is min(distance, thickness), epsilon is 2^-52, and C
/// is the largest coordinate of the grid in magnitude. allowed_error() of standoff/verify.h computes the bound. Errors:
/// usage (options, thickness or grid), input (mesh), limit (memory, sizes, distance of the mesh from the grid), device,
/// interrupted.
STANDOFF_API ComputeResult compute(MeshView mesh, const Grid& grid, double thickness,
                                   const ComputeOptions& options = {});

/// Like compute(), but into the caller's memory: one value per sample, x fastest. Every element is written. `nearest`
/// is either empty or as long as `values`. Errors: as compute; usage also for a wrong length.
STANDOFF_API ComputeReport compute_into(MeshView mesh, const Grid& grid, double thickness, std::span<float> values,
                                        std::span<std::uint32_t> nearest, const ComputeOptions& options = {});
inline ComputeReport compute_into(MeshView mesh, const Grid& grid, double thickness, std::span<float> values,
                                  const ComputeOptions& options = {}) {
  return compute_into(mesh, grid, thickness, values, {}, options);
}

/// Like compute(), but into an existing field, whose content is replaced. The memory of its tiles is reused, unless the
/// options name a memory limit. Use it when computing many fields: allocation can take a third of a thin band's time.
/// `grid` may be the field's own. Errors: as compute; the field is then unchanged or empty.
STANDOFF_API ComputeReport compute_into(MeshView mesh, const Grid& grid, double thickness, DistanceField& field,
                                        const ComputeOptions& options = {});

/// How many samples a slab of SlabComputation (standoff/slabs.h) has where the caller names no number. On grids of up
/// to 2048 x 2048 samples per slice the values of such a slab take at most 256 MiB; of a thin band, of which few tiles
/// are stored, a small part of that.
inline constexpr std::int64_t kSlabSamples = std::int64_t{1} << 26;

/// Upper bounds of what a computation takes besides the mesh, bytes, at most 2^62 each. The calls compare them with the
/// memory limit (docs/tiles.md, Memory).
struct MemoryEstimate {
  std::int64_t whole = 0;  ///< compute(), and compute_into() a field
  std::int64_t dense = 0;  ///< compute_into() the caller's memory, which is counted
  /// SlabComputation. It does not look at what the mesh is like: where SignMethod::automatic finds that only a flood
  /// tells its inside, which needs the whole grid at once, SlabComputation takes `whole`.
  std::int64_t slabs = 0;
  /// Samples of the tiles that a whole field may store. Whatever is kept for each of them beside the field, such as
  /// sidecars by bytes_per_sample(), takes this many times its bytes.
  std::int64_t stored_samples = 0;
};

/// Counts only tiles that some triangle may reach: those in its grown box, of large boxes only near its plane. Takes a
/// pass or two over the triangles.
/// `slab_samples`: as for SlabComputation. Errors: usage (grid, thickness, options, slab_samples), input (mesh), limit
/// (mesh), device.
STANDOFF_API MemoryEstimate estimate(MeshView mesh, const Grid& grid, double thickness,
                                     const ComputeOptions& options = {}, std::int64_t slab_samples = kSlabSamples);
/// The same for any mesh of `triangles` triangles, 1 to kMaxTriangles: every tile of the grid is counted.
STANDOFF_API MemoryEstimate estimate(std::int64_t triangles, const Grid& grid, double thickness,
                                     const ComputeOptions& options = {}, std::int64_t slab_samples = kSlabSamples);

}  // namespace standoff
