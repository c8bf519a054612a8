// SPDX-License-Identifier: Apache-2.0
#include "standoff/compute.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "field/options.h"
#include "field/plan.h"
#include "field/prepare.h"
#include "sign/make_sides.h"
#include "sign/sign_field.h"
#include "sign/sign_text.h"
#include "standoff/version.h"

namespace standoff {
namespace {

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

constexpr const char* kWhatToDo =
    "take fewer samples or a smaller thickness, or give a memory limit to be told beforehand";

// One computation in two steps. Between them its caller makes the output's memory.
class Computation {
 public:
  Computation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, bool is_dense)
      : mesh_(mesh),
        options_(options),
        plan_(make_plan(static_cast<std::int64_t>(mesh.triangles.size()), grid, thickness, options, is_dense)),
        threads_(options.execution.threads),
        progress_(options.progress) {}

  const Plan& plan() const { return plan_; }

  /// Throws where the mesh or the memory will not do.
  void check() {
    threads_.run([&] {
      Stopwatch watch;
      progress_.stage("prepare", 1, 0, 0.1);
      check_mesh(mesh_, plan_, options_);
      sign_plan_ = plan_sign(mesh_, options_.sign);
      report_.seconds.prepare = watch.lap();
    });
  }

  /// Skip rule, backend, and sign(sides), which gives the output its sign. Requires check(). The mesh's hash goes into
  /// `hash`, where there is one.
  template <class Sign>
  ComputeReport run(Sink& sink, const Sign& sign, std::uint64_t* hash = nullptr) {
    threads_.run([&] {
      Stopwatch watch;
      const std::vector<std::uint32_t> kept = kept_by_plan(mesh_, plan_);
      report_.seconds.prepare += watch.lap();
      progress_.stage("bin", 1, 0.1, 0.2);
      const Job job{.mesh = mesh_,
                    .kept = kept,
                    .grid = plan_.grid,
                    .thickness = plan_.thickness,
                    .threads = plan_.threads,
                    .simd = options_.execution.simd,
                    .progress = progress_,
                    .device = options_.execution.device};
      const Counts counts = plan_.row->run(job, sink);
      if (hash) {
        progress_.stage("hash", 1, 1, 1);
        *hash = content_hash(mesh_);
      }
      report_.seconds.compute = watch.lap();
      if (sign_plan_.has_sign()) {
        progress_.stage("sign", 1, 1, 1);
        if (const auto sides = make_sides(mesh_, sign_plan_, options_.sign, plan_.grid, progress_))
          sign(*sides, progress_);
        report_.seconds.sign = watch.lap();
      }
      report_.triangles = plan_.triangles;
      report_.skipped = plan_.triangles - job.triangle_count();
      report_.samples_examined = counts.samples_examined;
      report_.samples_band = counts.samples_band;
    });
    progress_.stage("done", 1, 1, 1);
    report_.method = plan_.row->method_name;
    report_.backend = plan_.row->backend_name;
    report_.sign = sign_plan_.report;
    report_.device = plan_.row->device(options_.execution.simd, options_.execution.device);
    report_.threads = plan_.threads;
    report_.samples = plan_.grid.sample_count();
    report_.tiles = tile_count(plan_.grid.size);
    return report_;
  }

 private:
  MeshView mesh_;
  const ComputeOptions& options_;
  Plan plan_;
  SignPlan sign_plan_;
  Threads threads_;
  ProgressMeter progress_;
  ComputeReport report_;
};

}  // namespace

ComputeResult compute(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options) {
  ComputeResult computed;
  computed.report = compute_into(mesh, grid, thickness, computed.field, options);
  return computed;
}

ComputeReport compute_into(MeshView mesh, const Grid& grid, double thickness, DistanceField& field,
                           const ComputeOptions& options) try {
  validate(thickness, options);
  validate(grid);
  // It has a grid of its own: the caller's may be the field's, which goes with the field.
  Computation computation(mesh, grid, thickness, options, false);
  computation.check();
  try {
    if (options.memory_limit != 0) field = {};
    field.reset(computation.plan().grid, thickness, options.nearest_triangle);
    Sink sink(field);
    std::uint64_t mesh_hash = 0;
    ComputeReport report = computation.run(
        sink,
        [&](const Sides& sides, ProgressMeter& progress) { sign_field(sides, options.sign.invert, field, progress); },
        options.hash_mesh ? &mesh_hash : nullptr);
    report.tiles_stored = field.stored_tiles();
    field.set_provenance({report.method, mesh_hash, version(), written(sign_text_of(options.sign, report.sign))});
    return report;
  } catch (...) {
    field = {};
    throw;
  }
} catch (...) {
  throw_as_error("compute", kWhatToDo);
}

ComputeReport compute_into(MeshView mesh, const Grid& grid, double thickness, std::span<float> values,
                           std::span<std::uint32_t> nearest, const ComputeOptions& options) try {
  validate(thickness, options);
  validate(grid);
  const auto samples = static_cast<std::size_t>(grid.sample_count());
  if (values.size() != samples || (!nearest.empty() && nearest.size() != samples) ||
      (options.nearest_triangle && nearest.empty()))
    throw Error(ErrorCode::usage,
                "compute: the memory given does not hold " + std::to_string(samples) +
                    " values (and as many nearest triangles where they are asked for); give one for each sample");
  Computation computation(mesh, grid, thickness, options, true);
  computation.check();
  Threads(options.execution.threads).run([&] {
    constexpr std::size_t kGrain = std::size_t{1} << 18;
    const auto far = static_cast<float>(thickness);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples, kGrain), [&](const auto& range) {
      std::fill(values.begin() + range.begin(), values.begin() + range.end(), far);
      if (!nearest.empty()) std::fill(nearest.begin() + range.begin(), nearest.begin() + range.end(), kNoTriangle);
    });
  });
  Sink sink(grid, values, nearest);
  return computation.run(sink, [&](const Sides& sides, ProgressMeter& progress) {
    sign_values(sides, options.sign.invert, computation.plan().grid, values, progress);
  });
} catch (...) {
  throw_as_error("compute", kWhatToDo);
}

}  // namespace standoff
