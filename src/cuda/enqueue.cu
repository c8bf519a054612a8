// The public functions for device memory (difi/cuda.h).
#include "cuda/enqueue.cuh"

namespace difi::cuda {

std::int64_t workspace_bytes(std::int64_t triangles, const Grid& grid, double thickness, Method method,
                             std::int64_t entries) {
  validate(grid);
  gpu::check_counts(triangles, thickness, entries);
  return needed_bytes(triangles, grid, thickness, method, entries);
}

void enqueue(const Task& task, void* workspace, std::int64_t bytes, Stream stream) {
  enqueue_tasks({&task, 1}, workspace, bytes, stream);
}

void enqueue(std::span<const Task> tasks, void* workspace, std::int64_t bytes, Stream stream) {
  enqueue_tasks(tasks, workspace, bytes, stream);
}

}  // namespace difi::cuda
