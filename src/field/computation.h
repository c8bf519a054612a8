// SPDX-License-Identifier: Apache-2.0
// The steps that whole fields (compute.cpp) and fields in windows (windows.cpp) have in common.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/progress.h"
#include "core/threads.h"
#include "field/plan.h"
#include "sign/methods.h"
#include "sign/plan.h"

namespace standoff {

class Stopwatch {
 public:
  /// Seconds since the start or the last lap.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The advice to users when memory runs out.
inline constexpr const char* kWithLessMemory =
    "take fewer samples or a smaller thickness, or give a memory limit to be told beforehand";

/// One computation. Mesh and options must outlive it. The constructor and check() run on the calling thread, all else
/// on the threads of threads().
class Computation {
 public:
  /// Throws the errors of make_plan.
  Computation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense,
              const Size3& window = {});
  Computation(const Computation&) = delete;
  Computation& operator=(const Computation&) = delete;

  MeshView mesh() const { return mesh_; }
  const Plan& plan() const { return plan_; }
  Threads& threads() { return threads_; }
  ProgressMeter& progress() { return progress_; }
  ComputeReport& report() { return report_; }

  /// Throws if the mesh is not valid or the memory does not suffice. Decides the sign's method, if that is not left to
  /// the backend, and with it whether the field can be computed in windows.
  void check();
  /// Applies the skip rule.
  Job job();
  /// Returns whether the backend has signed all samples. If it was asked to and has not, plans the sign.
  bool is_signed_after(const Counts& counts);
  SignMethod sign_method() const { return sign_plan_.report.method; }
  /// The signs by the planned method, which must not be `shell`; null if the mesh turns out to have no inside.
  std::unique_ptr<SampleSigns> signs(const NearestTriangles& nearest);
  /// The same for a window, by a part of the mesh that holds all triangles that its rows may cross.
  std::unique_ptr<SampleSigns> signs_of_window(const Grid& window, const OrientedMesh& part);
  const SignPlan& sign_plan() const { return sign_plan_; }
  /// Of the sign, once signs that need the grid or the whole field are made.
  SignDecision decision() const;
  /// content_hash() of the mesh.
  std::uint64_t mesh_hash() const;
  /// Fills the fields of the report that whole fields and windows share. `hash`: the mesh's, or 0.
  void finish(std::int64_t triangles, const Counts& counts, std::uint64_t hash);

 private:
  MeshView mesh_;
  const ComputeOptions& options_;
  Plan plan_;
  SignPlan sign_plan_;
  Threads threads_;
  ProgressMeter progress_;
  std::vector<std::uint32_t> kept_;
  mutable std::optional<std::uint64_t> mesh_hash_;  // once it was asked for
  ComputeReport report_;
};

/// Fills a field: all steps after check(). Throws the errors of compute_into; the field is then empty.
ComputeReport fill_field(Computation& computation, DistanceField& field, const ComputeOptions& options);

}  // namespace standoff
