// SPDX-License-Identifier: Apache-2.0
// The steps that whole fields (compute.cpp) and fields in slabs (slabs.cpp) have in common.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "core/threads.h"
#include "field/plan.h"
#include "sign/make_signs.h"
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

/// What users are told to do where memory runs out.
inline constexpr const char* kWithLessMemory =
    "take fewer samples or a smaller thickness, or give a memory limit to be told beforehand";

/// One computation. Mesh and options must stay where they are. All but the constructor and check() run on the threads
/// of threads(), or between them.
class Computation {
 public:
  /// Errors: as make_plan.
  Computation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense,
              std::int64_t slab_samples = 0);
  Computation(const Computation&) = delete;
  Computation& operator=(const Computation&) = delete;

  MeshView mesh() const { return mesh_; }
  const Plan& plan() const { return plan_; }
  Threads& threads() { return threads_; }
  ProgressMeter& progress() { return progress_; }
  /// Of what has been done so far.
  ComputeReport& report() { return report_; }

  /// Throws where the mesh or the memory will not do. Decides the sign's method, and with it whether slabs will do.
  void check();
  /// Applies the skip rule.
  Job job();
  /// As planned.
  SignMethod sign_method() const { return sign_plan_.report.method; }
  /// Of the planned sign, which is not that of a shell; nothing where there turns out to be no inside.
  std::unique_ptr<SampleSigns> sides(const NearestTriangles& nearest);
  /// What the report says of all computations. `hash`: the mesh's, or 0.
  void finish(std::int64_t triangles, const Counts& counts, std::uint64_t hash);

 private:
  MeshView mesh_;
  const ComputeOptions& options_;
  Plan plan_;
  SignPlan sign_plan_;
  Threads threads_;
  ProgressMeter progress_;
  std::vector<std::uint32_t> kept_;
  ComputeReport report_;
};

/// Fills a field: all that follows check(). Errors: as compute_into; the field is then empty.
ComputeReport fill_field(Computation& computation, DistanceField& field, const ComputeOptions& options);

}  // namespace standoff
