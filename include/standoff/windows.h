// SPDX-License-Identifier: Apache-2.0
// Fields in windows: parts of a grid, each computed without the rest, for fields that are larger than memory or are
// shared among processes and machines.
#pragma once

#include <cstdint>
#include <memory>

#include "standoff/compute.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/sign_decision.h"

namespace standoff {

/// An upper bound of what WindowComputation takes besides the mesh, bytes, at most 2^62, which it compares with the
/// memory limit. Takes a pass over the triangles. Errors: as estimate(); usage for a window without samples.
STANDOFF_API std::int64_t estimate_window(MeshView mesh, const Grid& grid, double thickness, const Size3& largest,
                                          const ComputeOptions& options = {});

/// Computes windows of a grid, with the values that compute() gives the whole grid, bit for bit:
///
///     WindowComputation windows(mesh, grid, thickness, {256, 256, 256}, options);
///     DistanceField field;
///     windows.compute({1024, 0, 512}, {256, 256, 256}, field);
///
/// The mesh is prepared once. A window looks only at triangles that reach it; one that no triangle reaches takes
/// microseconds. Which tiles of clamped values are stored may differ from the whole field.
///
/// Where something needs the whole field first, it is computed by the constructor, with the memory that compute()
/// takes, and windows are cut out of it: SignMethod::normal and ::facet, and methods with MethodInfo::spreads.
/// SignMethod::flood is decided on the whole grid by the constructor, in some bits for each tile. One call at a time.
class STANDOFF_API WindowComputation {
 public:
  /// Checks and prepares. `largest`: the size of the largest window that will be asked for, which the memory limit
  /// counts. The mesh must stay where it is. Errors: as compute(); usage also for a size below 1.
  WindowComputation(MeshView mesh, const Grid& grid, double thickness, const Size3& largest,
                    const ComputeOptions& options = {});
  /// A mesh that nobody keeps would be gone before the first window.
  WindowComputation(Mesh&& mesh, const Grid& grid, double thickness, const Size3& largest,
                    const ComputeOptions& options = {}) = delete;
  WindowComputation(WindowComputation&&) noexcept;
  WindowComputation& operator=(WindowComputation&&) noexcept;
  ~WindowComputation();

  /// Of the whole field.
  const Grid& grid() const;
  /// Half-width of the band, world units.
  double thickness() const;
  bool has_nearest() const;
  /// Whether the whole field was computed by the constructor.
  bool is_whole() const;

  /// Fills `field` with the samples from `first` on, as many as `size`; its grid is grid().window(first, size). The
  /// fastest windows begin and end at multiples of 16 samples, or at the grid's end. Errors: usage (a window that is
  /// not in the grid, or is larger than the largest), limit, device, interrupted. After an error the field is empty.
  void compute(const Size3& first, const Size3& size, DistanceField& field);
  /// Whether some triangle may be within the thickness of the window. If not, all its values are clamped, and equal
  /// where the mesh is closed. Errors: usage.
  bool is_reached(const Size3& first, const Size3& size) const;

  /// Whether no triangle reaches the window and all of it is outside, so that all its values are the thickness. Takes
  /// microseconds where the mesh is closed. Errors: as compute().
  bool is_empty(const Size3& first, const Size3& size);

  /// How the sign was decided, for ComputeOptions::decision of others that compute windows of this field: they take no
  /// time for it. Errors: limit.
  SignDecision decision() const;
  /// What was done for all windows so far.
  const ComputeReport& report() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace standoff
