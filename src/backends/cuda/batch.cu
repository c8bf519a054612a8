// SPDX-License-Identifier: Apache-2.0
// Fields of many meshes on a GPU in one sequence of launches: the public functions of standoff/cuda_batch.h. nvcc
// compiles this file for CUDA; batch_emulated.cpp compiles it for the emulation.
#include "field/cuda/batch.cuh"

#include "backends/cuda/fields.h"
#include "core/guarded.h"
#include "field/cuda/capacity.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

std::int64_t workspace_bytes(const BatchTask& task, std::int64_t entries) try {
  check_sizes(task);
  check_counts(task.triangle_count, 1, entries);
  return bytes_beside_entries<ManyBands>(task) + entries * ManyBands::kBytesPerEntry;
} catch (...) {
  throw_as_error("cuda");
}

void enqueue(const BatchTask& task, void* workspace, std::int64_t bytes, Stream stream) try {
  check_task(task);
  check_workspace(workspace, bytes, bytes_beside_entries<ManyBands>(task));
  filling<ManyBands>(workspace, bytes, task).enqueue(task, stream);
} catch (...) {
  throw_as_error("cuda");
}

}  // namespace standoff::STANDOFF_PLATFORM
