// SPDX-License-Identifier: Apache-2.0
// Partitions a workspace, and enqueues the kernels of a field there.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "field/cuda/capacity.h"
#include "field/cuda/pipeline.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Calls use.template operator()<Pipeline>() with the pipeline of the method `tiles` for a thickness.
template <class Use>
auto with_tiles_pipeline(const Grid& grid, double thickness, Use use) {
  return is_thin(grid, thickness) ? use.template operator()<ThinBand>() : use.template operator()<ThickBand>();
}

// What cutting the memory into arrays may lose to their alignment.
inline constexpr std::int64_t kAlignmentLoss = 4096;

/// Bytes of a workspace for `entries` list entries, and one for each triangle.
template <class Pipeline>
std::int64_t needed_bytes(std::int64_t triangles, const Lattice& l, std::int64_t entries) {
  gpu::Workspace memory(nullptr);
  const Pipeline arrays(memory, triangles, l, 0);
  return memory.used() + std::max(entries, triangles) * Pipeline::kBytesPerEntry + kAlignmentLoss;
}

/// Throws Error{usage} where a task cannot be enqueued, whatever its method.
inline void check_task(const Task& task) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "cuda: " + what); };
  validate(task.grid);
  if (!(task.thickness > 0)) fail("the thickness must be positive; infinity gives a full field");
  check_count(task.mesh);
  if (!task.mesh.vertices || !task.mesh.triangles || !task.output.values || !task.outcome)
    fail("vertices, triangles, values and outcome must point to device memory; one is null");
  if (task.output.slots && task.output.slot_capacity < 0)
    fail("the output has room for " + std::to_string(task.output.slot_capacity) + " tiles; give it 0 or more");
}

/// Throws Error{usage} where a workspace is null, not aligned or smaller than `least`.
inline void check_workspace(const void* workspace, std::int64_t bytes, std::int64_t least) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "cuda: " + what); };
  if (reinterpret_cast<std::uintptr_t>(workspace) % gpu::Workspace::kAlignment != 0)
    fail("the workspace must be aligned to " + std::to_string(gpu::Workspace::kAlignment) +
         " bytes, as what cudaMalloc gives is");
  if (!workspace || bytes < least)
    fail("the workspace has " + std::to_string(bytes) + " bytes, this field wants " + std::to_string(least) +
         " at least; ask workspace_bytes()");
}

/// A pipeline in a workspace, whose remaining memory all goes to its lists. Requires a checked task and workspace.
template <class Pipeline>
Pipeline in_workspace(const Task& task, const Lattice& l, void* workspace, std::int64_t bytes) {
  const std::int64_t triangles = task.mesh.used_count();
  gpu::Workspace measure(nullptr), memory(workspace);
  const Pipeline empty(measure, triangles, l, 0);
  const std::int64_t entries = (bytes - measure.used() - kAlignmentLoss) / Pipeline::kBytesPerEntry;
  return Pipeline(memory, triangles, l, entries);
}

}  // namespace standoff::STANDOFF_PLATFORM
