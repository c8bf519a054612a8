// SPDX-License-Identifier: Apache-2.0
// Whole fields, and the steps that they share with fields in windows (windows.cpp).
#include "field/computation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "core/guarded.h"
#include "core/tile_count.h"
#include "field/plan.h"
#include "field/prepare.h"
#include "sign/decision.h"
#include "sign/outer/outer.h"
#include "sign/sign_field.h"
#include "sign/sign_text.h"
#include "standoff/compute.h"
#include "standoff/version.h"

namespace standoff {

Computation::Computation(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                         bool is_dense, const Size3& window)
    : mesh_(mesh),
      options_(options),
      plan_(make_plan(static_cast<std::int64_t>(mesh.triangles.size()), grid, thickness, options, is_dense, window)),
      threads_(options.execution.threads),
      progress_(options.progress) {}

void Computation::check() {
  threads_.run([&] {
    Stopwatch watch;
    progress_.stage("preparing the mesh", 1, 0, 0.1);
    check_mesh(mesh_, plan_, options_);
    if (!options_.decision.empty()) {
      sign_plan_ = plan_of(options_.decision, mesh_, mesh_hash(), options_.sign, plan_.grid);
    } else if (!plan_.sign_by_backend) {
      sign_plan_ = plan_sign(mesh_, options_.sign, progress_);
      if (options_.sign.outer) plan_outer(mesh_, options_.sign, sign_plan_, progress_);
    }
    if (plan_.in_windows && steps_of(sign_plan_.report.method).scope == SignScope::field) {
      take_whole(plan_);
      check_mesh(mesh_, plan_, options_);
    }
    report_.seconds.prepare = watch.lap();
  });
}

Job Computation::job() {
  Stopwatch watch;
  kept_ = kept_by_plan(mesh_, plan_, sign_plan_.exposed, progress_);
  report_.seconds.prepare += watch.lap();
  progress_.stage("sorting the triangles", 1, 0.1, 0.2);
  return {.mesh = mesh_,
          .kept = kept_,
          .grid = plan_.grid,
          .thickness = plan_.thickness,
          .threads = plan_.threads,
          .simd = options_.execution.simd,
          .progress = progress_,
          .devices = plan_.devices,
          .sign = plan_.sign_by_backend ? &options_.sign : nullptr};
}

bool Computation::is_signed_after(const Counts& counts) {
  const bool all = counts.samples_signed == plan_.grid.sample_count();
  if (!plan_.sign_by_backend) return all;
  if (!all) progress_.stage("preparing the mesh", 1, kDistancesDoneBeforeSign, 1);
  sign_plan_ = all ? plan_of_closed(SignMethod::winding) : plan_sign(mesh_, options_.sign, progress_);
  return all;
}

SignDecision Computation::decision() const {
  return decision_of(sign_plan_, mesh_, mesh_hash(), options_.sign, plan_.grid);
}

std::uint64_t Computation::mesh_hash() const {
  if (!mesh_hash_) mesh_hash_ = content_hash(mesh_);
  return *mesh_hash_;
}

std::unique_ptr<SampleSigns> Computation::signs(const NearestTriangles& nearest) {
  // Other methods may miss samples of the band.
  const double complete = plan_.row->method == Method::tiles ? plan_.field_thickness : 0;
  const UnsignedField field{plan_.grid, complete, nearest, crossing_bytes(plan_)};
  return make_signs(mesh_, sign_plan_, options_.sign, field, progress_);
}

std::unique_ptr<SampleSigns> Computation::signs_of_window(const Grid& window, const OrientedMesh& part) {
  const UnsignedField field{window, plan_.field_thickness, {}, crossing_bytes(plan_)};
  return make_signs_of_window(part, sign_plan_, options_.sign, field, progress_);
}

void Computation::finish(std::int64_t triangles, const Counts& counts, std::uint64_t hash) {
  report_.triangles = plan_.triangles;
  report_.skipped = plan_.triangles - sign_plan_.report.internal - triangles;
  report_.samples_examined = counts.samples_examined;
  report_.samples_band = counts.samples_band;
  report_.method = find_info(plan_.row->method)->name;
  report_.backend = name_of(plan_.row->backend);
  report_.sign = sign_plan_.report;
  report_.device.clear();
  for (const int device : plan_.devices)
    report_.device += (report_.device.empty() ? "" : ", ") + plan_.row->device(options_.execution.simd, device);
  report_.threads = plan_.threads;
  report_.samples = plan_.grid.sample_count();
  report_.tiles = tile_count(plan_.grid.size);
  report_.provenance = {report_.method, hash, version(), written(sign_text_of(options_.sign, report_.sign)),
                        options_.up};
}

namespace {

// The destination of the values: the tiles of a field, or dense memory.
class FieldOutput {
 public:
  explicit FieldOutput(DistanceField& field) : field_(field) {}
  Sink sink() { return Sink(field_); }
  NearestTriangles nearest() const { return NearestTriangles(field_); }
  void sign(SampleSigns& signs, bool invert, ProgressMeter& progress) {
    sign_field(signs, invert, field_.grid(), field_, progress);
  }
  void drop_signs() { standoff::drop_signs(field_); }
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
  void sign(SampleSigns& signs, bool invert, ProgressMeter& progress) {
    sign_values(signs, invert, grid_, values_, progress);
  }
  void drop_signs() { standoff::drop_signs(values_); }
  void thicken(const Shell& shell, ProgressMeter& progress) { apply(shell, values_, nearest_, progress); }

 private:
  const Grid& grid_;
  std::span<float> values_;
  std::span<std::uint32_t> nearest_;
};

template <class Output>
void decide_sign(Computation& computation, const ComputeOptions& options, Output& output) {
  if (computation.sign_method() == SignMethod::shell)
    return output.thicken(Shell(options.sign, computation.plan().field_thickness), computation.progress());
  if (const auto signs = computation.signs(output.nearest()))
    output.sign(*signs, options.sign.invert, computation.progress());
}

// Runs skip rule, backend and sign. Requires check(). Hashes the mesh if the options ask for it.
template <class Output>
ComputeReport run(Computation& computation, const ComputeOptions& options, bool with_hash, Output output) {
  Sink sink = output.sink();
  ComputeReport& report = computation.report();
  computation.threads().run([&] {
    const Job job = computation.job();
    Stopwatch watch;
    const Counts counts = computation.plan().row->run(job, sink);
    std::uint64_t hash = 0;
    if (with_hash) {
      computation.progress().stage("checksum", 1, 1, 1);
      hash = computation.mesh_hash();
    }
    report.seconds.compute = watch.lap();
    const bool is_signed = computation.is_signed_after(counts);
    if (!is_signed && counts.samples_signed > 0) output.drop_signs();
    if (computation.sign_method() != SignMethod::none) {
      computation.progress().stage("sign", 1, 1, 1);
      if (!is_signed) decide_sign(computation, options, output);
      report.seconds.sign = watch.lap();
    }
    computation.finish(job.triangle_count(), counts, hash);
  });
  computation.progress().stage("done", 1, 1, 1);
  return report;
}

}  // namespace

ComputeReport fill_field(Computation& computation, DistanceField& field, const ComputeOptions& options) try {
  if (options.memory_limit > 0) field = {};
  const Plan& plan = computation.plan();
  field.reset(plan.grid, plan.field_thickness, plan.with_nearest);
  ComputeReport report = run(computation, options, options.hash_mesh, FieldOutput(field));
  if (!options.nearest) field.erase_nearest();
  report.tiles_stored = field.stored_tiles();
  field.set_provenance(report.provenance);
  return report;
} catch (...) {
  field = {};
  throw;
}

ComputeResult compute(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options) {
  ComputeResult computed;
  computed.report = compute_into(mesh, grid, thickness, computed.field, options);
  return computed;
}

ComputeReport compute_into(MeshView mesh, const Grid& grid, double thickness, DistanceField& field,
                           const ComputeOptions& options) try {
  validate(thickness, options);
  validate(grid);
  // The computation copies the grid: the caller's may be the field's own, which clearing the field destroys.
  Computation computation(mesh, grid, thickness, options, false);
  computation.check();
  return fill_field(computation, field, options);
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

ComputeReport compute_into(MeshView mesh, const Grid& grid, double thickness, std::span<float> values,
                           std::span<std::uint32_t> nearest, const ComputeOptions& options) try {
  validate(thickness, options);
  validate(grid);
  const auto samples = static_cast<std::size_t>(grid.sample_count());
  if (values.size() != samples || (!nearest.empty() && nearest.size() != samples) ||
      (options.nearest && nearest.empty()))
    throw Error(ErrorCode::usage,
                "compute: the memory given does not hold " + std::to_string(samples) +
                    " values (and as many nearest triangles where they are asked for); give one for each sample");
  Computation computation(mesh, grid, thickness, options, true);
  computation.check();
  std::vector<std::uint32_t> own_nearest;  // only the sign needs them
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
  return run(computation, options, false, DenseOutput(grid, values, nearest));
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

}  // namespace standoff
