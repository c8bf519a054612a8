// SPDX-License-Identifier: Apache-2.0
// Fields on a GPU by every method: the public functions for device memory (standoff/cuda.h), and the rows of the table
// of backends. nvcc compiles this file for CUDA; fields_emulated.cpp compiles it for the emulation.
#include "backends/cuda/fields.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "backends/cuda/pipelines.cuh"
#include "core/guarded.h"
#include "field/cuda/counted_run.cuh"
#include "gpu/platform.cuh"
#include "sidecars/cuda/sidecars.cuh"
#include "sign/cuda/sign.cuh"

namespace standoff::STANDOFF_PLATFORM {
namespace {

// Of a field without a sign.
std::int64_t bytes_for(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                       std::int64_t entries) {
  const Lattice l = make_lattice(grid, thickness);
  return with_pipeline(method, grid, thickness,
                       [&]<class Pipeline>() { return needed_bytes<Pipeline>(triangles, l, entries); });
}

// Throws Error{usage} for more vertices than indices reach.
void check_vertices(const DeviceMesh& mesh) {
  if (mesh.vertex_count < 0 || mesh.vertex_count > std::int64_t{1} << 32)
    throw Error(ErrorCode::usage, "cuda: " + std::to_string(mesh.vertex_count) +
                                      " vertices are out of range; give at most 2^32, and none negative");
}

// The sign takes the workspace when the field is done with it.
std::int64_t bytes_for(const Task& task, std::int64_t entries) {
  const std::int64_t field = bytes_for(task.mesh.used_count(), task.grid, task.thickness, task.method, entries);
  if (task.sign.method == SignMethod::none) return field;
  gpu::Workspace memory(nullptr);
  const SignArrays arrays(memory, task);
  return std::max(field, memory.used());
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

std::int64_t workspace_bytes(const Task& task, std::int64_t entries) try {
  validate(task.grid);
  check_counts(task.mesh.used_count(), task.thickness, entries);
  check_counts(task.mesh.triangle_count, task.thickness, entries);
  check_vertices(task.mesh);
  return bytes_for(task, entries);
} catch (...) {
  throw_as_error("cuda");
}

void enqueue(const Task& task, void* workspace, std::int64_t bytes, Stream stream) {
  STANDOFF_PLATFORM::enqueue(std::span(&task, 1), workspace, bytes, stream);
}

void enqueue(std::span<const Task> tasks, void* workspace, std::int64_t bytes, Stream stream) try {
  for (const Task& task : tasks) {
    check_task(task);
    check_vertices(task.mesh);
    if (task.sign.method != SignMethod::none) check_sign(task);
    check_sidecars(task);
    check_workspace(workspace, bytes, bytes_for(task, 0));
  }
  for (const Task& task : tasks) {
    const Lattice l = make_lattice(task.grid, task.thickness);
    with_pipeline(task.method, task.grid, task.thickness, [&]<class Pipeline>() {
      in_workspace<Pipeline>(task, l, workspace, bytes).enqueue(l, task, stream);
    });
    const bool has_sign = task.sign.method != SignMethod::none;
    if (has_sign) {
      gpu::Workspace memory(workspace);
      SignArrays(memory, task).enqueue(task, stream);
    }
    enqueue_sidecars(task, {has_sign, task.sign.invert, nullptr}, stream);
  }
} catch (...) {
  throw_as_error("cuda");
}

namespace {

// Windows of whole layers of bricks, which devices take in turn. One device gets one window: the grid.
class Windows {
 public:
  Windows(const Grid& grid, std::size_t devices) : grid_(grid), layers_((grid.size.z + kBrickSide - 1) / kBrickSide) {
    // Two for each device, as one may take longer than another. The number is a choice: it was not measured.
    count_ = devices == 1 ? 1 : std::min<std::int64_t>(layers_, 2 * static_cast<std::int64_t>(devices));
  }

  std::int64_t count() const { return count_; }
  Grid at(std::int64_t n) const {
    const auto slice = [&](std::int64_t window) {
      return std::min(kBrickSide * (layers_ * window / count_), grid_.size.z);
    };
    return grid_.window({0, 0, slice(n)}, {grid_.size.x, grid_.size.y, slice(n + 1) - slice(n)});
  }
  /// The number of the next one; count() or more if there is none, or the work has failed.
  std::int64_t next() { return next_++; }
  void stop() { next_ = count_; }

 private:
  Grid grid_;
  std::int64_t layers_, count_;
  std::atomic<std::int64_t> next_{0};
};

// Negates the samples inside of a finished field. Returns false where the device has doubts, or no room for the sign's
// arrays; some samples may be negated then.
bool decide_sign(const SignOptions& sign, CountedRun& field) try {
  field.free_lists();
  field.task.sign = sign;
  gpu::Workspace measure(nullptr);
  const SignArrays sizes(measure, field.task);
  const Memory memory(measure.used());
  gpu::Workspace room(memory.as<void>());
  SignArrays(room, field.task).enqueue(field.task, nullptr);
  return field.look().doubts == 0;
} catch (const gpu::OutOfMemory&) {
  return false;
}

template <class Pipeline>
Counts run_on(int device, const Job& job, Windows& windows, Sink& sink) {
  const DeviceScope scope(device);
  const HostRun<Pipeline> run(job, windows.at(0));
  Counts sum;
  for (std::int64_t n = windows.next(); n < windows.count(); n = windows.next())
    sum += run.run(windows.at(n), sink, [&](CountedRun& field) { return job.sign && decide_sign(*job.sign, field); });
  return sum;
}

// A thread of the host for each device. The first error ends the work of all.
template <class Pipeline>
Counts run_on_all(const Job& job, Windows& windows, Sink& sink) {
  for (const int device : job.devices) const DeviceScope usable(device);  // throws before any work
  std::mutex finishing;
  std::exception_ptr error;
  Counts sum;
  Job each = job;  // the devices share the threads that move what they copy
  each.threads = std::max(1, job.threads / static_cast<int>(job.devices.size()));
  std::vector<std::jthread> threads;
  for (const int device : job.devices)
    threads.emplace_back([&, device] {
      try {
        const Counts counts = run_on<Pipeline>(device, each, windows, sink);
        const std::lock_guard lock(finishing);
        sum += counts;
      } catch (...) {
        windows.stop();
        const std::lock_guard lock(finishing);
        if (!error) error = std::current_exception();
      }
    });
  threads.clear();  // waits
  if (error) std::rethrow_exception(error);
  return sum;
}

}  // namespace

Counts run(Method method, const Job& job, Sink& sink) try {
  Windows windows(job.grid, std::max<std::size_t>(1, job.devices.size()));
  std::int64_t copies = 0;
  for (std::int64_t n = 0; n < windows.count(); ++n) copies += copies_of(windows.at(n));
  job.progress.stage("distances", kUnitsPerCopy * copies, 0.2, job.sign ? kDistancesDoneBeforeSign : 1);
  return with_pipeline(method, job.grid, job.thickness, [&]<class Pipeline>() {
    if (job.devices.size() > 1) return run_on_all<Pipeline>(job, windows, sink);
    return run_on<Pipeline>(job.devices.empty() ? 0 : job.devices[0], job, windows, sink);
  });
} catch (const gpu::OutOfMemory& error) {
  throw Error(error.code(), std::string(error.what()) + ", or take fewer samples or a smaller thickness",
              error.details());
}

std::int64_t scratch_bytes(Method method, const MeshLoad& mesh, const Grid& grid, double thickness) {
  const std::int64_t host = host_scratch_bytes(grid);
  if (!kIsEmulated) return host;
  constexpr std::int64_t tile_bytes = 2 * 4 * kTileSamples, mesh_bytes = 9 * 8 + 3 * 4;
  Task task;
  task.mesh.vertex_count = 3 * mesh.triangles;
  task.mesh.triangle_count = mesh.triangles;
  task.grid = grid;
  task.thickness = thickness;
  task.method = method;
  if (mesh.with_sign) task.sign = {};
  return host + tile_count(grid.size) * (tile_bytes + 4) + mesh.triangles * mesh_bytes +
         bytes_for(task, cuda::likely_entries(mesh.triangles, grid, thickness, method));
}

}  // namespace standoff::STANDOFF_PLATFORM
