// SPDX-License-Identifier: Apache-2.0
// Checks a distance field against its mesh.
#pragma once

#include <cstdint>
#include <string>

#include "standoff/compute.h"
#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/slice_reader.h"

namespace standoff {

struct VerifyOptions {
  std::int64_t samples = 1000;  ///< the number of samples to test, at least 1; all if the grid has no more
  std::uint64_t seed = 1;       ///< chooses the samples; the same seed chooses the same samples
  Execution execution = {};     ///< runs on the CPU; any other backend is Error{usage}
  ProgressCallback progress = {};
};

/// One tested sample. All distances are in world units.
struct SampleCheck {
  std::int64_t i = 0, j = 0, k = 0;
  Vec3 position;
  double stored = 0;    ///< the field's value
  double expected = 0;  ///< min(distance, thickness), computed in double precision; negative if found to be inside
  double error = 0;     ///< the difference of their magnitudes (of a shell, of the values); infinite for a NaN
  double allowed = 0;   ///< the bound that compute() guarantees there
};

/// The check of a field's sign (docs/sign_methods.md, "Check").
struct SignCheck {
  std::string method;         ///< how the sign was decided, by the field's provenance; empty: it does not say
  bool can_check = false;     ///< whether verify can check any sign that was decided that way
  std::int64_t checked = 0;   ///< tested samples whose side was compared
  std::int64_t wrong = 0;     ///< of these, how many are on the other side
  std::int64_t unknown = 0;   ///< tested samples whose side cannot be told
  std::int64_t negative = 0;  ///< tested samples with a negative value
  SampleCheck worst;          ///< if any is wrong: the one farthest from the surface
  double worst_winding = 0;   ///< the winding number there; not a number if another check found it
};

struct VerifyResult {
  std::int64_t samples = 0;        ///< samples tested
  std::int64_t samples_band = 0;   ///< tested samples no farther than the thickness
  std::int64_t samples_wrong = 0;  ///< tested samples whose error is above the bound
  std::int64_t nearest_wrong = 0;  ///< tested samples whose stored nearest triangle is farther than is allowed
  SampleCheck largest;             ///< the sample with the largest error
  SampleCheck worst;               ///< the sample with the largest ratio of error to allowed error
  SignCheck sign;                  ///< whether negative values are inside
  bool mesh_differs = false;       ///< the field's provenance names another mesh

  bool ok() const { return samples_wrong == 0 && nearest_wrong == 0 && sign.wrong == 0; }
};

/// The allowed error of a value if the distance, clamped to the thickness, is `distance`:
/// 1e-6 * (distance + 16 * max spacing) + 4 * 2^-52 * (the grid's largest coordinate in magnitude). World units.
STANDOFF_API double allowed_error(const Grid& grid, double distance);

/// Compares the field at random samples with distances computed in double precision over all triangles; a triangle is
/// skipped only if its box is farther away than a distance that was already found. Half of the samples are drawn from
/// the stored tiles, so that a narrow band in a large grid is tested too. This search shares no code with compute().
///
/// If the field's provenance says how its sign was decided, the sign is checked as well, by other means than
/// compute()'s. `winding` and `parity` of closed meshes: every sample, exactly, by the crossings of a ray along +y.
/// `winding` of open meshes: by the sum of all solid angles in double precision, which takes time in proportion to
/// samples times triangles (some 25 ns each); samples within 1e-9 and its rounding error of the threshold count as
/// unknown. `flood`: samples outside of the mesh's box. `normal`: samples in the band, on the same side of all
/// triangles that may be the nearest. `facet` of closed meshes: as `winding`, which `facet` only approximates. `shell`:
/// expected values are distance - shell / 2. With `outer`, distances are those to the exposed triangles
/// (standoff/exposed.h), which are found again.
///
/// If the field has wrong values, the result says so; that is not an error. Errors: input (mesh), usage (options),
/// interrupted.
STANDOFF_API VerifyResult verify(const DistanceField& field, MeshView mesh, const VerifyOptions& options = {});

/// The same of a field that is read some slices at a time, twice: first to count its stored tiles. The same samples are
/// chosen, and the result is the same. Memory is that of the slices read at a time, of about `slice_samples` samples,
/// and 200 bytes for each sample tested. Errors: as above, what `read` throws, and usage where it returns other slices.
STANDOFF_API VerifyResult verify(const Grid& grid, double thickness, const SliceReader& read, MeshView mesh,
                                 const VerifyOptions& options = {}, std::int64_t slice_samples = kSlabSamples);

}  // namespace standoff
