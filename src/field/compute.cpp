#include "difi/compute.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <thread>

#include "difi/version.h"
#include "field/backend.h"
#include "field/domain.h"
#include "field/progress.h"
#include "field/skip.h"

namespace difi {
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

void check(const Options& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  if (!(options.thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  if (options.threads < 0) fail("the number of threads must be zero (all) or more");
  if (options.memory_limit < 0) fail("the memory limit must be zero (none) or more");
  if (options.skip.kind == SkipRule::Kind::neighbour && !(options.skip.fraction > 0 && options.skip.fraction <= 1))
    fail("the neighbour rule's fraction must be above 0 and at most 1");
}

int thread_count(const Options& options) {
  if (options.threads > 0) return options.threads;
  return std::max(1, tbb::this_task_arena::max_concurrency());
}

SkipRule effective_rule(const Options& options) {
  if (options.skip.kind != SkipRule::Kind::automatic) return options.skip;
  return {options.method == Method::thesis ? SkipRule::Kind::neighbour : SkipRule::Kind::none, 1};
}

std::string mebibytes(std::int64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f MiB", std::ceil(static_cast<double>(bytes) / (1 << 20)));
  return text;
}

void check_memory(std::int64_t triangles, const Grid& grid, const Options& options, bool dense) {
  if (options.memory_limit == 0) return;
  const std::int64_t needed = memory_needed(triangles, grid, options, dense);
  if (needed <= options.memory_limit) return;
  const double shrink = std::cbrt(static_cast<double>(options.memory_limit) / static_cast<double>(needed));
  const auto side =
      static_cast<std::int64_t>(shrink * static_cast<double>(std::max({grid.size.x, grid.size.y, grid.size.z})));
  throw Error(ErrorCode::limit, "compute: the field may need " + mebibytes(needed) + ", more than the limit of " +
                                    mebibytes(options.memory_limit) + "; take at most about " +
                                    std::to_string(std::max<std::int64_t>(side, 1)) +
                                    " samples on the longest side, a smaller thickness, or a higher limit");
}

// Everything but the output's own memory, which differs between compute and compute_into.
Report fill(MeshView mesh, const Grid& grid, const Options& options, Sink& sink) {
  const BackendRow& backend =
      find_backend(options.backend, options.method, static_cast<std::int64_t>(mesh.triangles.size()), grid);
  const int threads = thread_count(options);
  Report report;
  ProgressMeter progress(options);
  tbb::task_arena arena(threads);
  arena.execute([&] {
    Stopwatch watch;
    progress.stage("prepare", 1, 0, 0.1);
    validate(mesh);
    check_domain(mesh, grid);
    const SkipRule rule = effective_rule(options);
    std::vector<std::uint32_t> kept;
    if (rule.kind != SkipRule::Kind::none) {
      kept = kept_triangles(mesh, grid, options.thickness, rule, threads);
      // To a Job an empty list means all triangles.
      if (kept.empty()) throw std::logic_error("the skip rule left no triangle");
      if (kept.size() == mesh.triangles.size()) kept.clear();
    }
    report.seconds.prepare = watch.lap();

    progress.stage("bin", 1, 0.1, 0.2);
    const Job job{mesh, kept, grid, options.thickness, threads, options.simd, progress, options.device};
    const Counts counts = backend.run(job, sink);
    report.seconds.compute = watch.lap();
    report.triangles = static_cast<std::int64_t>(mesh.triangles.size());
    report.skipped = report.triangles - job.triangle_count();
    report.samples_examined = counts.samples_examined;
    report.samples_band = counts.samples_band;
  });
  progress.stage("done", 1, 1, 1);
  report.method = backend.method_name;
  report.backend = backend.backend_name;
  report.device = backend.device(options.simd, options.device);
  report.threads = threads;
  report.samples = grid.sample_count();
  constexpr std::int64_t side = DistanceField::kTileSide;
  report.tiles =
      ((grid.size.x + side - 1) / side) * ((grid.size.y + side - 1) / side) * ((grid.size.z + side - 1) / side);
  return report;
}

}  // namespace

std::int64_t memory_needed(std::int64_t triangles, const Grid& grid, const Options& options, bool dense) {
  validate(grid);
  const BackendRow& backend = find_backend(options.backend, options.method, triangles, grid);
  constexpr double side = DistanceField::kTileSide, tile_bytes = DistanceField::kTileSamples * sizeof(float);
  const double tiles = std::ceil(static_cast<double>(grid.size.x) / side) *
                       std::ceil(static_cast<double>(grid.size.y) / side) *
                       std::ceil(static_cast<double>(grid.size.z) / side);
  const double per_value = options.nearest_triangle ? 2 : 1;
  double output = 4.0 * static_cast<double>(grid.sample_count()) * per_value;
  if (!dense) output = tiles * (tile_bytes * per_value + sizeof(std::int32_t));
  const double scratch =
      static_cast<double>(backend.scratch_bytes(triangles, grid, options.thickness, thread_count(options)));
  const SkipRule rule = effective_rule(options);
  const double kept = rule.kind == SkipRule::Kind::none ? 0 : static_cast<double>(skip_bytes(triangles, rule));
  const double total = output + scratch + kept;
  return total < 0x1p62 ? static_cast<std::int64_t>(total) : std::int64_t{1} << 62;
}

Computed compute(MeshView mesh, const Grid& grid, const Options& options) {
  check(options);
  validate(grid);
  check_memory(static_cast<std::int64_t>(mesh.triangles.size()), grid, options, false);
  Computed computed{DistanceField(grid, options.thickness, options.nearest_triangle), {}};
  Sink sink(computed.field);
  computed.report = fill(mesh, grid, options, sink);
  computed.report.tiles_stored = computed.field.stored_tiles();
  tbb::task_arena(computed.report.threads).execute([&] { computed.field.provenance.mesh_hash = content_hash(mesh); });
  computed.field.provenance.method = computed.report.method;
  computed.field.provenance.version = version();
  return computed;
}

Report compute_into(MeshView mesh, const Grid& grid, std::span<float> values, std::span<std::uint32_t> nearest,
                    const Options& options) {
  check(options);
  validate(grid);
  const auto samples = static_cast<std::size_t>(grid.sample_count());
  if (values.size() != samples || (!nearest.empty() && nearest.size() != samples) ||
      (options.nearest_triangle && nearest.empty()))
    throw Error(ErrorCode::usage, "compute: the memory given does not hold " + std::to_string(samples) +
                                      " values (and as many nearest triangles where they are asked for)");
  check_memory(static_cast<std::int64_t>(mesh.triangles.size()), grid, options, true);
  tbb::task_arena arena(thread_count(options));
  arena.execute([&] {
    constexpr std::size_t kGrain = std::size_t{1} << 18;
    const auto far = static_cast<float>(options.thickness);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples, kGrain), [&](const auto& range) {
      std::fill(values.begin() + range.begin(), values.begin() + range.end(), far);
      if (!nearest.empty()) std::fill(nearest.begin() + range.begin(), nearest.begin() + range.end(), kNoTriangle);
    });
  });
  Sink sink(grid, values, nearest);
  return fill(mesh, grid, options, sink);
}

}  // namespace difi
