// SPDX-License-Identifier: Apache-2.0
// Checks a distance field against its mesh.
#pragma once

#include <cstdint>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff {

struct VerifyOptions {
  std::int64_t samples =
      1000;                  ///< how many samples to test, at least 1; every one when the grid has no more than these
  std::uint64_t seed = 1;    ///< chooses the samples; the same seed takes the same ones
  Execution execution = {};  ///< on the CPU: other backends are Error{usage}
  ProgressCallback progress = {};
};

/// One sample, and what was found there. All distances are in world units.
struct SampleCheck {
  std::int64_t i = 0, j = 0, k = 0;
  Vec3 position;
  double stored = 0;    ///< the field's value
  double expected = 0;  ///< min(distance, thickness), the distance in double precision
  double error = 0;     ///< |stored - expected|; infinite where the field holds no number
  double allowed = 0;   ///< the bound that compute() promises there
};

struct VerifyResult {
  std::int64_t samples = 0;        ///< samples tested
  std::int64_t samples_band = 0;   ///< of those, the ones no farther than the thickness
  std::int64_t samples_wrong = 0;  ///< of those, the ones whose error is above the bound
  std::int64_t nearest_wrong = 0;  ///< samples whose stored nearest triangle is farther than the distance allows
  SampleCheck largest;             ///< the sample with the largest error
  SampleCheck worst;               ///< the sample with the largest error in terms of what is allowed there
  bool mesh_differs = false;       ///< the field says that it was computed from another mesh

  bool ok() const { return samples_wrong == 0 && nearest_wrong == 0; }
};

/// The error allowed where the distance, clamped to the thickness, is `distance`:
/// 1e-6 * (distance + 16 * max spacing), and what a double cannot resolve at the sample's coordinates.
STANDOFF_API double allowed_error(const Grid& grid, double distance);

/// Compares the field at random samples with distances computed in double precision: every triangle counts, and only
/// those are passed over whose boxes lie farther away than a distance already found. Half of the samples are drawn from
/// the stored tiles, so that a narrow band in a wide grid is tested too. Nothing of compute() is used.
/// A field with wrong values is a result, not an error. Errors: input (mesh), usage (options), interrupted.
STANDOFF_API VerifyResult verify(const DistanceField& field, MeshView mesh, const VerifyOptions& options = {});

}  // namespace standoff
