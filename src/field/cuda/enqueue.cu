// The public functions for device memory (standoff/cuda.h).
#include "core/guarded.h"
#include "field/cuda/enqueue.cuh"

namespace standoff::cuda {

std::int64_t workspace_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                             std::int64_t entries) try {
  validate(grid);
  gpu::check_counts(triangles, thickness, entries);
  return needed_bytes(triangles, grid, thickness, method, entries);
} catch (...) {
  throw_as_error("cuda");
}

void enqueue(const Task& task, void* workspace, std::int64_t bytes, Stream stream) try {
  enqueue_tasks({&task, 1}, workspace, bytes, stream);
} catch (...) {
  throw_as_error("cuda");
}

void enqueue(std::span<const Task> tasks, void* workspace, std::int64_t bytes, Stream stream) try {
  enqueue_tasks(tasks, workspace, bytes, stream);
} catch (...) {
  throw_as_error("cuda");
}

}  // namespace standoff::cuda
