// SPDX-License-Identifier: Apache-2.0
// A field in windows: what windows of a grid share, and the work of one of them. Fields in slabs (slabs.cpp) are
// windows of whole slices.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "field/backend.h"
#include "field/computation.h"
#include "field/mesh_parts.h"
#include "field/plan.h"

namespace standoff {

/// The work of WindowComputation (standoff/windows.h).
class FieldInWindows {
 public:
  /// Requires valid options and a valid grid, `largest` within it.
  FieldInWindows(MeshView mesh, const Grid& grid, double thickness, const Size3& largest,
                 const ComputeOptions& options);
  FieldInWindows(const FieldInWindows&) = delete;
  FieldInWindows& operator=(const FieldInWindows&) = delete;
  ~FieldInWindows();

  const Plan& plan() const { return computation_.plan(); }
  ProgressMeter& progress() { return computation_.progress(); }
  const ComputeReport& report() const { return report_; }
  bool has_nearest() const { return options_.nearest; }
  SignDecision decision() {
    return computation_.threads().run([&] { return computation_.decision(); });
  }

  void compute(const Size3& first, const Size3& size, DistanceField& field);
  bool is_reached(const Size3& first, const Size3& size);
  bool is_empty(const Size3& first, const Size3& size);
  /// Gives away the whole field, where the plan is not in windows.
  DistanceField take_whole() { return std::exchange(whole_, {}); }

 private:
  void prepare();
  void tell();
  Grid checked(const Size3& first, const Size3& size) const;
  void fill(const Grid& window, DistanceField& field);
  void sign(const Grid& window, DistanceField& field);
  MeshPart crossed_by(const Grid& window);
  bool is_of_one_sign(const Grid& window);
  bool is_inside(const Grid& window);
  SampleSigns* signs_of_rows(const Grid& window);
  const MeshParts& parts();
  const MeshParts& all_parts();
  std::unique_ptr<SampleSigns> signs_of_all_rows();

  const ComputeOptions options_;
  Computation computation_;
  std::uint64_t hash_ = 0;
  std::optional<Job> job_;
  // Made when they are needed: of the job's triangles; of all, if these are others, for signs.
  std::optional<MeshParts> parts_, all_parts_;
  std::unique_ptr<WindowGather> gather_;
  std::unique_ptr<SampleSigns> signs_of_grid_;  // of SignScope::grid; or by few crossings, which all windows share

  // The signs of all samples of a window's rows, along the whole grid: the next window may have these rows, too.
  struct RowSigns {
    Grid grid;
    MeshPart part;
    std::unique_ptr<SampleSigns> signs;
  };
  std::optional<RowSigns> rows_;
  Counts counts_;
  std::int64_t samples_ = 0, tiles_ = 0;  // of all windows so far
  ComputeReport report_;
  DistanceField whole_;  // if the plan is not in windows
};

}  // namespace standoff
