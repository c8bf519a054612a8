// SPDX-License-Identifier: Apache-2.0
#include "standoff/compute.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "core/guarded.h"
#include "field/computation.h"
#include "field/options.h"
#include "sign/shell.h"
#include "sign/sign_field.h"

namespace standoff {
namespace {

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

template <class Output>
void decide_sign(Computation& computation, const ComputeOptions& options, Output& output) {
  if (computation.sign_method() == SignMethod::shell)
    return output.thicken(Shell(options.sign, computation.plan().field_thickness), computation.progress());
  if (const auto sides = computation.sides(output.nearest()))
    output.sign(*sides, options.sign.invert, computation.progress());
}

// Skip rule, backend and sign. Requires check(). With the mesh's hash where it is asked for.
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
      computation.progress().stage("hash", 1, 1, 1);
      hash = content_hash(computation.mesh());
    }
    report.seconds.compute = watch.lap();
    if (computation.sign_method() != SignMethod::none) {
      computation.progress().stage("sign", 1, 1, 1);
      decide_sign(computation, options, output);
      report.seconds.sign = watch.lap();
    }
    computation.finish(job.triangle_count(), counts, hash);
  });
  computation.progress().stage("done", 1, 1, 1);
  return report;
}

}  // namespace

ComputeReport fill_field(Computation& computation, DistanceField& field, const ComputeOptions& options) try {
  if (options.memory_limit != 0) field = {};
  const Plan& plan = computation.plan();
  field.reset(plan.grid, plan.field_thickness, plan.with_nearest);
  ComputeReport report = run(computation, options, options.hash_mesh, FieldOutput(field));
  if (!options.nearest_triangle) field.erase_nearest();
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
  // It has a grid of its own: the caller's may be the field's, which goes with the field.
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
  return run(computation, options, false, DenseOutput(grid, values, nearest));
} catch (...) {
  throw_as_error("compute", kWithLessMemory);
}

}  // namespace standoff
