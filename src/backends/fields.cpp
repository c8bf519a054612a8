// SPDX-License-Identifier: Apache-2.0
// The tables of backends and methods, of skip rules, and of devices for queries at points.
#include <array>

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
[[maybe_unused]] constexpr auto kEmulatedDevice = [](Simd, int) { return std::string("emulated on the CPU"); };
constexpr auto kGpuName = [](Simd, int device) { return cuda::device_name(device); };

constexpr std::array kFieldRows{
    BackendRow{Backend::cuda, Method::tiles, cuda::available, kGpuName, cuda::run_tiles, cuda::scratch_bytes},
    BackendRow{Backend::cuda, Method::thesis, cuda::available, kGpuName, cuda::run_thesis, cuda::scratch_bytes},
    BackendRow{Backend::cpu, Method::tiles, kAlways, [](Simd simd, int) { return cpu::tiles_device(simd); },
               cpu::run_tiles, cpu::tiles_scratch_bytes, cpu::tiles_in_layers},
    BackendRow{Backend::cpu, Method::thesis, kAlways, [](Simd simd, int) { return cpu::thesis_device(simd); },
               cpu::run_thesis, cpu::thesis_scratch_bytes},
#ifdef STANDOFF_HAVE_EMULATION
    BackendRow{testing::kEmulated, Method::tiles, kAlways, kEmulatedDevice, emulated::run_tiles,
               emulated::scratch_bytes},
    BackendRow{testing::kEmulated, Method::thesis, kAlways, kEmulatedDevice, emulated::run_thesis,
               emulated::scratch_bytes},
#endif
};

// Starting CUDA takes longer than the CPU takes for a small field. The value is a guess: it was not measured.
constexpr std::int64_t kSmallJob = std::int64_t{1} << 22;

}  // namespace

const BackendRow& find_backend(Backend backend, Method method, std::int64_t triangles, const Grid& grid) {
  const bool is_small = triangles + grid.sample_count() < kSmallJob;
  const Backend wanted = backend == Backend::automatic && is_small ? Backend::cpu : backend;
  for (const BackendRow& row : kFieldRows)
    if (row.method == method && (wanted == Backend::automatic || row.backend == wanted) && row.available()) return row;
  throw_if_missing(backend, "compute");
  // The CPU has a row for every method, and options are checked before.
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

// Fewer points are not worth a copy to the GPU and back. The value is a guess: it was not measured.
constexpr std::size_t kLeastForDevice = 100'000;

}  // namespace

const PointDevice* find_point_device(Backend backend, std::size_t points) {
  const bool automatic = backend == Backend::automatic;
  if (automatic && points < kLeastForDevice) return nullptr;
  for (const PointDevice& row : kPointRows)
    if (row.backend == (automatic ? kAutomaticGpu : backend) && row.available()) return &row;
  throw_if_missing(backend, "points");
  return nullptr;
}

}  // namespace standoff
