// SPDX-License-Identifier: Apache-2.0
// Fields on a GPU by every method: the public functions for device memory (standoff/cuda.h), and the rows of the table
// of backends. nvcc compiles this file for CUDA; fields_emulated.cpp compiles it for the emulation.
#include "backends/cuda/fields.h"

#include "backends/cuda/pipelines.cuh"
#include "core/guarded.h"
#include "field/cuda/counted_run.cuh"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {
namespace {

std::int64_t bytes_for(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                       std::int64_t entries) {
  const Lattice l = make_lattice(grid, thickness);
  return with_pipeline(method, grid, thickness,
                       [&]<class Pipeline>() { return needed_bytes<Pipeline>(triangles, l, entries); });
}

}  // namespace

std::int64_t workspace_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                             std::int64_t entries) try {
  validate(grid);
  check_counts(triangles, thickness, entries);
  return bytes_for(triangles, grid, thickness, method, entries);
} catch (...) {
  throw_as_error("cuda");
}

void enqueue(const Task& task, void* workspace, std::int64_t bytes, Stream stream) {
  STANDOFF_PLATFORM::enqueue(std::span(&task, 1), workspace, bytes, stream);
}

void enqueue(std::span<const Task> tasks, void* workspace, std::int64_t bytes, Stream stream) try {
  for (const Task& task : tasks) {
    check_task(task);
    check_workspace(workspace, bytes, bytes_for(task.mesh.used_count(), task.grid, task.thickness, task.method, 0));
  }
  for (const Task& task : tasks) {
    const Lattice l = make_lattice(task.grid, task.thickness);
    with_pipeline(task.method, task.grid, task.thickness, [&]<class Pipeline>() {
      in_workspace<Pipeline>(task, l, workspace, bytes).enqueue(l, task, stream);
    });
  }
} catch (...) {
  throw_as_error("cuda");
}

Counts run(Method method, const Job& job, Sink& sink) try {
  const DeviceScope scope(job.device);
  const Counts counts = with_pipeline(method, job.grid, job.thickness,
                                      [&]<class Pipeline>() { return run_from_host<Pipeline>(job, sink); });
  check_seeds(job.thickness, counts.samples_band);
  return counts;
} catch (const gpu::OutOfMemory& error) {
  throw Error(error.code(), std::string(error.what()) + ", or take fewer samples or a smaller thickness",
              error.details());
}

std::int64_t scratch_bytes(Method method, std::int64_t triangles, const Grid& grid, double thickness) {
  const std::int64_t host = host_scratch_bytes(grid);
  if (!kIsEmulated) return host;
  const std::int64_t entries = cuda::likely_entries(triangles, grid, thickness, method);
  constexpr std::int64_t tile_bytes = 2 * 4 * kTileSamples, mesh_bytes = 9 * 8 + 3 * 4;
  return host + tile_count(grid.size) * (tile_bytes + 4) + triangles * mesh_bytes +
         bytes_for(triangles, grid, thickness, method, entries);
}

}  // namespace standoff::STANDOFF_PLATFORM
