// Collision queries on CUDA.
#include "cuda/collide.cuh"
#include "cuda/collision.h"
#include "cuda/device_scope.cuh"

namespace difi::cuda {

void collide(const collision::CollideJob& job) {
  const DeviceScope scope(job.device);
  run_collide(job, Backend::cuda);
}

}  // namespace difi::cuda
