#include "standoff/compute.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "field/backend.h"
#include "field/float_range.h"
#include "field/memory.h"
#include "field/options.h"
#include "field/skip.h"
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

// Everything but the output's own memory, which differs between compute and compute_into. The mesh's hash goes into
// `hash`, where there is one.
ComputeReport fill(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, Sink& sink,
                   std::uint64_t* hash = nullptr) {
  const BackendRow& backend =
      find_backend(options.execution.backend, options.method, static_cast<std::int64_t>(mesh.triangles.size()), grid);
  Threads threads(options.execution.threads);
  ComputeReport report;
  ProgressMeter progress(options.progress);
  threads.run([&] {
    Stopwatch watch;
    progress.stage("prepare", 1, 0, 0.1);
    validate(mesh);
    check_domain(mesh, grid);
    const SkipRule rule = effective_rule(options);
    std::vector<std::uint32_t> kept;
    if (rule.kind != SkipRule::Kind::none) {
      kept = kept_triangles(mesh, grid, thickness, rule);
      // To a Job an empty list means all triangles.
      if (kept.empty()) throw std::logic_error("the skip rule left no triangle");
      if (kept.size() == mesh.triangles.size()) kept.clear();
    }
    report.seconds.prepare = watch.lap();

    progress.stage("bin", 1, 0.1, 0.2);
    const Job job{
        mesh, kept, grid, thickness, threads.count(), options.execution.simd, progress, options.execution.device};
    const Counts counts = backend.run(job, sink);
    if (hash) {
      progress.stage("hash", 1, 1, 1);
      *hash = content_hash(mesh);
    }
    report.seconds.compute = watch.lap();
    report.triangles = static_cast<std::int64_t>(mesh.triangles.size());
    report.skipped = report.triangles - job.triangle_count();
    report.samples_examined = counts.samples_examined;
    report.samples_band = counts.samples_band;
  });
  progress.stage("done", 1, 1, 1);
  report.method = backend.method_name;
  report.backend = backend.backend_name;
  report.device = backend.device(options.execution.simd, options.execution.device);
  report.threads = threads.count();
  report.samples = grid.sample_count();
  constexpr std::int64_t side = DistanceField::kTileSide;
  report.tiles =
      ((grid.size.x + side - 1) / side) * ((grid.size.y + side - 1) / side) * ((grid.size.z + side - 1) / side);
  return report;
}

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
  check_memory(mesh, grid, thickness, options, false);
  const Grid where = grid;  // it may be the field's own, which goes with the field
  try {
    if (options.memory_limit != 0) field = {};
    field.reset(where, thickness, options.nearest_triangle);
    Sink sink(field);
    ComputeReport report =
        fill(mesh, where, thickness, options, sink, options.hash_mesh ? &field.provenance.mesh_hash : nullptr);
    report.tiles_stored = field.stored_tiles();
    field.provenance.method = report.method;
    field.provenance.version = version();
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
  check_memory(mesh, grid, thickness, options, true);
  Threads(options.execution.threads).run([&] {
    constexpr std::size_t kGrain = std::size_t{1} << 18;
    const auto far = static_cast<float>(thickness);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples, kGrain), [&](const auto& range) {
      std::fill(values.begin() + range.begin(), values.begin() + range.end(), far);
      if (!nearest.empty()) std::fill(nearest.begin() + range.begin(), nearest.begin() + range.end(), kNoTriangle);
    });
  });
  Sink sink(grid, values, nearest);
  return fill(mesh, grid, thickness, options, sink);
} catch (...) {
  throw_as_error("compute", kWhatToDo);
}

}  // namespace standoff
