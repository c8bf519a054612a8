// From a task and a piece of memory to the launches of the way that fits it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "field/cuda/capacity.h"
#include "field/cuda/pipeline.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Parts can be left out of the ways for thin bands and of Algorithm 1. Calls use.template operator()<Arrays>(enqueue
/// function) with those of the method's way.
template <Through kThrough = Through::write, class Use>
auto with_way(Method method, const Grid& grid, double thickness, Use use) {
  if (method == Method::thesis) return use.template operator()<ThesisArrays>(enqueue_thesis<kThrough>);
  if (is_thin(grid, thickness)) return use.template operator()<ThinArrays>(enqueue_thin<kThrough>);
  return use.template operator()<ThickArrays>(enqueue_thick);
}

// What cutting the memory into arrays may lose to their alignment.
inline constexpr std::int64_t kAlignmentLoss = 4096;

inline std::int64_t needed_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                                 std::int64_t entries) {
  const Lattice l = make_lattice(grid, thickness);
  return with_way(method, grid, thickness, [&]<class Arrays>(auto) {
    gpu::Workspace memory(nullptr);
    const Arrays arrays(memory, triangles, l, 0);
    return memory.used() + std::max(entries, triangles) * Arrays::kBytesPerEntry + kAlignmentLoss;
  });
}

/// Throws Error{usage} where there is no triangle, or one whose index is kNoTriangle.
inline void check_count(const DeviceMesh& mesh) {
  if (mesh.used_count() < 1 || mesh.triangle_count >= kNoTriangle)
    throw Error(ErrorCode::usage, "cuda: the mesh has " + std::to_string(mesh.used_count()) +
                                      " triangles to use; give it 1 to 4294967294");
}

/// Throws Error{usage} where a task cannot be enqueued.
inline void check_task(const Task& task, const void* workspace, std::int64_t bytes) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "cuda: " + what); };
  validate(task.grid);
  if (!(task.thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  const std::int64_t triangles = task.mesh.used_count();
  check_count(task.mesh);
  if (!task.mesh.vertices || !task.mesh.triangles || !task.output.values || !task.outcome)
    fail("vertices, triangles, values and outcome must point to device memory; one is null");
  if (task.output.slots && task.output.slot_capacity < 0)
    fail("the output has room for " + std::to_string(task.output.slot_capacity) + " tiles; give it 0 or more");
  if (reinterpret_cast<std::uintptr_t>(workspace) % gpu::Workspace::kAlignment != 0)
    fail("the workspace must be aligned to " + std::to_string(gpu::Workspace::kAlignment) +
         " bytes, as what cudaMalloc gives is");
  const std::int64_t least = needed_bytes(triangles, task.grid, task.thickness, task.method, 0);
  if (!workspace || bytes < least)
    fail("the workspace has " + std::to_string(bytes) + " bytes, this field wants " + std::to_string(least) +
         " at least; ask workspace_bytes()");
}

/// Requires a task that was checked.
template <Through kThrough = Through::write>
void enqueue_task(const Task& task, void* workspace, std::int64_t bytes, Stream stream) {
  const std::int64_t triangles = task.mesh.used_count();
  const Lattice l = make_lattice(task.grid, task.thickness);
  with_way<kThrough>(task.method, task.grid, task.thickness, [&]<class Arrays>(auto enqueue_way) {
    gpu::Workspace measure(nullptr), memory(workspace);
    const Arrays empty(measure, triangles, l, 0);
    const std::int64_t entries = (bytes - measure.used() - kAlignmentLoss) / Arrays::kBytesPerEntry;
    enqueue_way(l, task, Arrays(memory, triangles, l, entries), stream);
  });
}

/// Checks all tasks before the first one is put on the stream.
inline void enqueue_tasks(std::span<const Task> tasks, void* workspace, std::int64_t bytes, Stream stream) {
  for (const Task& task : tasks) check_task(task, workspace, bytes);
  for (const Task& task : tasks) enqueue_task(task, workspace, bytes, stream);
}

}  // namespace standoff::STANDOFF_PLATFORM
