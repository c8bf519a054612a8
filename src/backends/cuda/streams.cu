// SPDX-License-Identifier: Apache-2.0
// Fields in device memory with workspace and waiting taken care of (standoff/cuda_compute.h). nvcc compiles this file
// for CUDA; streams_emulated.cpp compiles it for the emulation.
#include "backends/cuda/streams.h"

#include "backends/cuda/emulated.h"
#include "field/cuda/any_mesh.cuh"
#include "field/float_range.h"
#include "gpu/device_scope.cuh"

namespace standoff::STANDOFF_PLATFORM {
namespace {

using cuda::OnStream;

// Makes the device the current one, and waits for what others still write.
struct Begun : DeviceScope {
  explicit Begun(const OnStream& on) : DeviceScope(on.device) {
    for (const Stream other : on.after) wait_for(other);
  }
};

}  // namespace

Box bounds_on_stream(const MeshView& mesh, const OnStream& on) {
  const Begun begun(on);
  return bounds_of(PackedMesh(mesh, on.stream).mesh(), on.stream);
}

Outcome compute_on_stream(const MeshView& mesh, Task task, const OnStream& on) {
  const Begun begun(on);
  const PackedMesh packed(mesh, on.stream);
  const Memory outcome(sizeof(Outcome));
  task.mesh = packed.mesh();
  task.outcome = outcome.as<Outcome>();
  check_domain(bounds_of(task.mesh, on.stream), task.grid);
  const std::int64_t triangles = task.mesh.triangle_count;
  for (std::int64_t entries = cuda::likely_entries(triangles, task.grid, task.thickness, task.method);;) {
    const std::int64_t bytes =
        STANDOFF_PLATFORM::workspace_bytes(triangles, task.grid, task.thickness, task.method, entries);
    const Memory workspace(bytes);
    STANDOFF_PLATFORM::enqueue(task, workspace.as<void>(), bytes, on.stream);
    wait_for(on.stream);
    Outcome seen;
    copy_out(&seen, task.outcome, sizeof seen);
    const bool is_short = seen.stopped != 0 && seen.bad_triangle == Outcome::kNone &&
                          seen.needed_entries != Outcome::kNone &&
                          seen.needed_entries > static_cast<unsigned long long>(entries);
    if (!is_short) {
      cuda::check(seen, task);
      return seen;
    }
    entries = static_cast<std::int64_t>(seen.needed_entries + seen.needed_entries / 2);  // what is needed at least
  }
}

void copy_from_stream(const float* values, std::span<float> to, const OnStream& on) {
  const Begun begun(on);
  wait_for(on.stream);
  copy_out(to.data(), values, static_cast<std::int64_t>(to.size_bytes()));
}

}  // namespace standoff::STANDOFF_PLATFORM
