// SPDX-License-Identifier: Apache-2.0
// The devices of fields in device memory (standoff/cuda_compute.h).
#include <algorithm>
#include <array>

#include "backends/cuda/streams.h"
#include "core/guarded.h"
#include "core/tile_count.h"
#include "field/backend.h"
#include "field/options.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"
#include "standoff/version.h"

namespace standoff::cuda {
namespace {

struct StreamDevice {
  Backend backend;
  Box (*bounds)(const MeshView&, const OnStream&);
  Outcome (*compute)(const MeshView&, Task, const OnStream&);
  void (*copy)(const float*, std::span<float>, const OnStream&);
};

constexpr std::array kRows{
    StreamDevice{Backend::cuda, bounds_on_stream, compute_on_stream, copy_from_stream},
#ifdef STANDOFF_HAVE_EMULATION
    StreamDevice{testing::kEmulated, emulated::bounds_on_stream, emulated::compute_on_stream,
                 emulated::copy_from_stream},
#endif
};

// Throws where there is no such device.
const BackendRow& backend_of(const OnStream& on, Method method) {
  if (on.backend != Backend::cuda && on.backend != testing::kEmulated)
    throw Error(ErrorCode::usage, "cuda: only Backend::cuda works on device memory; compute() takes what the CPU has");
  return find_backend(on.backend, method, 1, {{1, 1, 1}, {}});
}
const StreamDevice& device_of(const OnStream& on) {
  const Backend backend = backend_of(on, Method::tiles).backend;
  return *std::find_if(kRows.begin(), kRows.end(), [&](const StreamDevice& row) { return row.backend == backend; });
}

}  // namespace

Box bounds(const MeshView& mesh, const OnStream& on) try { return device_of(on).bounds(mesh, on); } catch (...) {
  throw_as_error("cuda");
}

ComputeReport compute_into(const MeshView& mesh, const Grid& grid, double thickness, float* values, Method method,
                           const OnStream& on) try {
  ComputeOptions options;
  options.method = method;
  validate(thickness, options);
  validate(grid);
  const BackendRow& row = backend_of(on, method);
  Task task;
  task.grid = grid;
  task.thickness = thickness;
  task.method = method;
  task.output.values = values;
  const Outcome outcome = device_of(on).compute(mesh, task, on);
  ComputeReport report;
  report.method = row.method_name;
  report.backend = row.backend_name;
  report.device = row.device({}, on.device);
  report.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  report.samples = grid.sample_count();
  report.samples_examined = static_cast<std::int64_t>(outcome.samples_examined);
  report.samples_band = static_cast<std::int64_t>(outcome.samples_band);
  report.tiles = tile_count(grid.size);
  report.provenance = {report.method, 0, version(), {}};
  return report;
} catch (...) {
  throw_as_error("cuda");
}

void copy_to_host(const float* values, std::span<float> to, const OnStream& on) try {
  const StreamDevice& device = device_of(on);
  if (!values || !to.data()) throw Error(ErrorCode::usage, "cuda: values are copied from null or to null; give memory");
  device.copy(values, to, on);
} catch (...) {
  throw_as_error("cuda");
}

}  // namespace standoff::cuda
