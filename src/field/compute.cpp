// SPDX-License-Identifier: Apache-2.0
#include "standoff/compute.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "field/memory.h"
#include "field/options.h"
#include "field/plan.h"
#include "field/prepare.h"
#include "sign/make_sides.h"
#include "sign/outer/outer.h"
#include "sign/shell.h"
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

// Where the values go: into the tiles of a field, or into dense memory.
class FieldOutput {
 public:
  explicit FieldOutput(DistanceField& field) : field_(field) {}
  Sink sink() { return Sink(field_); }
  NearestTriangles nearest() const { return NearestTriangles(field_); }
  void sign(Sides& sides, bool invert, ProgressMeter& progress) { sign_field(sides, invert, field_, progress); }
  void thicken(const Shell& shell, ProgressMeter& progress) { apply(shell, field_, progress); }

 private:
  DistanceField& field_;
};

class DenseOutput {
 public:
  DenseOutput(const Grid& grid, std::span<float> values, std::span<std::uint32_t> nearest)
      : grid_(grid), values_(values), nearest_(nearest) {}
  Sink sink() { return {grid_, values_, nearest_}; }
  NearestTriangles nearest() const { return {grid_, nearest_}; }
  void sign(Sides& sides, bool invert, ProgressMeter& progress) {
    sign_values(sides, invert, grid_, values_, progress);
  }
  void thicken(const Shell& shell, ProgressMeter& progress) { apply(shell, values_, nearest_, progress); }

 private:
  const Grid& grid_;
  std::span<float> values_;
  std::span<std::uint32_t> nearest_;
};

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
      sign_plan_ = plan_sign(mesh_, options_.sign, progress_);
      if (options_.sign.outer) plan_outer(mesh_, options_.sign, sign_plan_);
      report_.seconds.prepare = watch.lap();
    });
  }

  /// Skip rule, backend and sign. Requires check(). The mesh's hash goes into `hash`, where there is one.
  template <class Output>
  ComputeReport run(Output output, std::uint64_t* hash = nullptr) {
    Sink sink = output.sink();
    threads_.run([&] {
      Stopwatch watch;
      const std::vector<std::uint32_t> kept = kept_by_plan(mesh_, plan_, sign_plan_.exposed);
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
        sign(output);
        report_.seconds.sign = watch.lap();
      }
      report_.triangles = plan_.triangles;
      report_.skipped = plan_.triangles - sign_plan_.report.internal - job.triangle_count();
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
    report_.provenance = {report_.method, hash ? *hash : 0, version(),
                          written(sign_text_of(options_.sign, report_.sign))};
    return report_;
  }

 private:
  template <class Output>
  void sign(Output& output) {
    if (sign_plan_.report.method == SignMethod::shell)
      return output.thicken(Shell(options_.sign, plan_.field_thickness), progress_);
    const UnsignedField field{plan_.grid, plan_.field_thickness, output.nearest(), crossing_bytes(plan_)};
    if (const auto sides = make_sides(mesh_, sign_plan_, options_.sign, field, progress_))
      output.sign(*sides, options_.sign.invert, progress_);
  }

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
    field.reset(computation.plan().grid, thickness, computation.plan().with_nearest);
    std::uint64_t mesh_hash = 0;
    ComputeReport report = computation.run(FieldOutput(field), options.hash_mesh ? &mesh_hash : nullptr);
    if (!options.nearest_triangle) field.erase_nearest();
    report.tiles_stored = field.stored_tiles();
    field.set_provenance(report.provenance);
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
  std::vector<std::uint32_t> own_nearest;  // for the sign alone
  if (computation.plan().with_nearest && nearest.empty()) {
    own_nearest.resize(samples);
    nearest = own_nearest;
  }
  Threads(options.execution.threads).run([&] {
    constexpr std::size_t kGrain = std::size_t{1} << 18;
    const auto far = static_cast<float>(computation.plan().thickness);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples, kGrain), [&](const auto& range) {
      std::fill(values.begin() + range.begin(), values.begin() + range.end(), far);
      if (!nearest.empty()) std::fill(nearest.begin() + range.begin(), nearest.begin() + range.end(), kNoTriangle);
    });
  });
  return computation.run(DenseOutput(grid, values, nearest));
} catch (...) {
  throw_as_error("compute", kWhatToDo);
}

}  // namespace standoff
