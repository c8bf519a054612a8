// SPDX-License-Identifier: Apache-2.0
// What a field may carry beside its distances: arrays with some numbers for each stored sample (docs/sidecars.md).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/feature.h"
#include "standoff/field.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"

namespace standoff {

/// An array beside a field. The numbers of sample n (x fastest, below DistanceField::kTileSamples) of the tile in slot
/// s are values[(512 * s + n) * components] and those after it; slots are those of DistanceField::slots(). Samples
/// without an answer, beyond the band or the grid, have 0, as all samples of tiles that are not stored.
struct Sidecar {
  std::string name;    ///< "closest_point", also the name of the array in files; letters, digits and underscores
  int components = 1;  ///< numbers per sample
  std::variant<std::vector<float>, std::vector<std::uint8_t>> values;
};

/// What is known of the point of the mesh that is closest to a sample: it lies on the sample's nearest triangle.
enum class SidecarKind : std::uint8_t {
  closest_point,  ///< the point, world units, rounded to float
  barycentric,    ///< its barycentric coordinates, in the order of the triangle's corners
  feature,        ///< one byte: the number of the Feature that it lies on
  /// The unit vector along which the value grows fastest. Where several triangles are nearest it is that of the stored
  /// one. Within 1e-9 of that triangle's longest side from the surface it is the triangle's unit normal: in the
  /// orientation of the sign; of a field without sign, on the sample's side. (0, 0, 1) there if the triangle has no
  /// area.
  gradient,
};

/// The name of a kind's array: "closest_point", "barycentric", "feature", "gradient"; empty for none of these.
STANDOFF_API std::string name_of(SidecarKind kind);
/// The bytes of a kind per sample of a stored tile: 12, or 1 for a feature. Errors: usage (no such kind).
STANDOFF_API std::int64_t bytes_per_sample(SidecarKind kind);

struct SidecarOptions {
  Execution execution = {};  ///< the backend must be automatic or cpu
  ProgressCallback progress = {};
};

/// The sidecars of a field that has nearest triangles and was computed from `mesh`, one for each of `kinds`, in this
/// order. All follow in double precision from the stored nearest triangle, which is nearest within the error that
/// compute() promises; they have the same bits for any number of threads and any instruction set. Takes
/// 512 * stored_tiles() * bytes_per_sample() for each. Runs on the CPU.
/// Errors: usage (a field without nearest triangles, kinds that do not exist, execution), input (mesh; a nearest
/// triangle that the mesh does not have), limit (a coordinate that is beyond 2^100 spacings from the grid; memory),
/// interrupted.
STANDOFF_API std::vector<Sidecar> sidecars(MeshView mesh, const DistanceField& field,
                                           std::span<const SidecarKind> kinds, const SidecarOptions& options = {});

/// The same in place of what `into` holds, whose memory is reused: fresh memory can take longer than the work.
/// After an error `into` holds nothing of use.
STANDOFF_API void sidecars_into(MeshView mesh, const DistanceField& field, std::span<const SidecarKind> kinds,
                                std::vector<Sidecar>& into, const SidecarOptions& options = {});

}  // namespace standoff
