// SPDX-License-Identifier: Apache-2.0
// How sure the sign of a field is (docs/sign.md, "Confidence").
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"

namespace standoff {

/// Three questions about the samples in a field's band, as shares of them, from 0 to 1. All are 0 for a closed mesh of
/// solids without cavities.
struct SignConfidence {
  std::int64_t samples = 0;    ///< in the band; of a full field all
  double doubtful = 0;         ///< the winding number is within 0.05 of a threshold
  double axes_disagree = 0;    ///< the parities of crossings along the three axes are not the same
  double flood_disagrees = 0;  ///< a flood from outside says otherwise than the field; cavities count too
};

struct ConfidenceOptions {
  /// How inside is decided; of all that it says only `as_oriented` matters, and only to winding_margins(): margins are
  /// those of SignMethod::winding.
  SignOptions sign = {};
  Execution execution = {};  ///< the backend must be automatic or cpu
  ProgressCallback progress = {};
};

/// The distance of each sample's winding number from the next threshold, an odd half, x fastest: 0.5 where it is an
/// integer, as everywhere around a closed mesh; 0 where the sides cannot be told apart. Off by 1e-3 at most. The mesh
/// is oriented as for SignMethod::winding. Takes a float per sample; in open meshes the time of a search in the tree of
/// holes per sample. Runs on the CPU. Errors: input (mesh), usage (grid, execution), limit, interrupted.
STANDOFF_API std::vector<float> winding_margins(MeshView mesh, const Grid& grid, const ConfidenceOptions& options = {});

/// Examines the sign of a field of this mesh. `margins` are winding_margins() of its grid. Takes 2 bits per sample and
/// what a flood takes. Runs on the CPU. Errors: as winding_margins; usage also for margins of another length.
STANDOFF_API SignConfidence sign_confidence(MeshView mesh, const DistanceField& field,
                                            const std::vector<float>& margins, const ConfidenceOptions& options = {});

}  // namespace standoff
