// SPDX-License-Identifier: Apache-2.0
// The tables of backends and methods, of skip rules, and of devices for queries at points.
#include <algorithm>
#include <array>

#include "approximate/approximate.h"
#include "backends/cuda/fields.h"
#include "backends/missing.h"
#include "field/backend.h"
#include "field/cpu/tiles.h"
#include "field/skip.h"
#include "gpu/devices.h"
#include "points/cuda/points.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"
#include "thesis/thesis.h"

namespace standoff {

namespace {

constexpr auto kAlways = [] { return true; };

// The row of a method on a GPU.
template <Method kMethod>
constexpr BackendRow on_cuda() {
  return {Backend::cuda,
          kMethod,
          cuda::available,
          [](Simd, int device) { return cuda::device_name(device); },
          [](const Job& job, Sink& sink) { return cuda::run(kMethod, job, sink); },
          [](const MeshLoad& mesh, const Grid& grid, double thickness, int) {
            return cuda::scratch_bytes(kMethod, mesh, grid, thickness);
          },
          nullptr,
          kMethod == Method::tiles,
          kMethod == Method::tiles};
}

#ifdef STANDOFF_HAVE_EMULATION
template <Method kMethod>
constexpr BackendRow on_emulated() {
  return {testing::kEmulated,
          kMethod,
          kAlways,
          [](Simd, int) { return std::string("emulated on the CPU"); },
          [](const Job& job, Sink& sink) { return emulated::run(kMethod, job, sink); },
          [](const MeshLoad& mesh, const Grid& grid, double thickness, int) {
            return emulated::scratch_bytes(kMethod, mesh, grid, thickness);
          },
          nullptr,
          kMethod == Method::tiles,
          kMethod == Method::tiles};
}
#endif

// The row of an algorithm for comparison on the CPU, which is compiled for any processor.
constexpr BackendRow plain_on_cpu(Method method, Counts (*run)(const Job&, Sink&),
                                  std::int64_t (*scratch_bytes)(const MeshLoad&, const Grid&, double, int)) {
  return {Backend::cpu, method, kAlways, [](Simd, int) { return std::string("portable"); }, run, scratch_bytes};
}

constexpr std::array kFieldRows{
    on_cuda<Method::tiles>(),
    on_cuda<Method::thesis>(),
    on_cuda<Method::propagate>(),
    on_cuda<Method::jumpflood>(),
    on_cuda<Method::jumpflood_1>(),
    BackendRow{Backend::cpu, Method::tiles, kAlways, [](Simd simd, int) { return cpu::tiles_device(simd); },
               cpu::run_tiles, cpu::tiles_scratch_bytes, cpu::tiles_in_windows, false, false, cpu::tiles_prepare_whole},
    plain_on_cpu(Method::thesis, cpu::run_thesis, cpu::thesis_scratch_bytes),
    plain_on_cpu(Method::fuhrmann, cpu::run_fuhrmann, cpu::thesis_scratch_bytes),
    plain_on_cpu(Method::propagate, cpu::run_propagate, cpu::spread_scratch_bytes),
    plain_on_cpu(Method::jumpflood, cpu::run_jumpflood, cpu::spread_scratch_bytes),
    plain_on_cpu(Method::jumpflood_1, cpu::run_jumpflood_1, cpu::spread_scratch_bytes),
#ifdef STANDOFF_HAVE_EMULATION
    on_emulated<Method::tiles>(),
    on_emulated<Method::thesis>(),
    on_emulated<Method::propagate>(),
    on_emulated<Method::jumpflood>(),
    on_emulated<Method::jumpflood_1>(),
#endif
};

// Starting CUDA takes 0.3 s, and the CPU less for a field that is small. (Once started, an H200 was faster than 16
// cores from 20,000 triangles and 16^3 samples on: docs/cuda.md.)
constexpr std::int64_t kSmallJob = std::int64_t{1} << 22;

}  // namespace

const BackendRow& find_backend(Backend backend, Method method, std::int64_t triangles, const Grid& grid) {
  const bool is_small = triangles + grid.sample_count() < kSmallJob;
  const Backend wanted = backend == Backend::automatic && is_small ? Backend::cpu : backend;
  for (const BackendRow& row : kFieldRows)
    if (row.method == method && (wanted == Backend::automatic || row.backend == wanted) && row.available()) return row;
  // The CPU has a row for every method.
  const auto fits = [&](const BackendRow& row) { return row.method == method && row.backend == backend; };
  const bool is_for_others =
      std::ranges::any_of(kFieldRows, [&](const BackendRow& row) { return row.backend == backend; });
  if (is_for_others && std::ranges::none_of(kFieldRows, fits))
    throw Error(ErrorCode::usage, std::string("compute: the method ") + find_info(method)->name +
                                      " runs on the CPU alone; take the device cpu, or the method tiles");
  throw_if_missing(backend, "compute");
  throw Error(ErrorCode::internal, "compute: no row for this method; this is a bug in standoff, please report it");
}

namespace {

constexpr std::array kSkipRows{
    SkipRow{SkipRule::Kind::neighbour,
            [](MeshView mesh, const Grid&, double thickness, double fraction) {
              return kept_by_neighbour_rule(mesh, thickness, fraction);
            },
            sizeof(std::uint32_t)},
    SkipRow{SkipRule::Kind::exact,
            [](MeshView mesh, const Grid& grid, double thickness, double) {
              return kept_by_exact_rule(mesh, grid, thickness);
            },
            kExactRuleBytes},
};

}  // namespace

const SkipRow* find_skip_rule(SkipRule::Kind kind) {
  for (const SkipRow& row : kSkipRows)
    if (row.kind == kind) return &row;
  return nullptr;
}

namespace {

constexpr std::array kPointRows{
    PointDevice{Backend::cuda, cuda::available, cuda::find_nearest},
#ifdef STANDOFF_HAVE_EMULATION
    PointDevice{testing::kEmulated, [] { return true; }, emulated::find_nearest},
#endif
};

// Fewer points are not worth starting CUDA. (Once started, an H200 was 0.8 to 2.9
// times as fast as 16 cores, from 1,000 points on: docs/cuda.md.)
constexpr std::size_t kLeastForDevice = 100'000;

}  // namespace

const PointDevice* find_point_device(Backend backend, std::size_t points) {
  return find_device_row(kPointRows, backend, points < kLeastForDevice, "points");
}

}  // namespace standoff
