// Collision queries on CUDA.
#include "collision/cuda/collide.cuh"
#include "collision/cuda/queries.h"
#include "collision/cuda/sweep.cuh"
#include "gpu/device_scope.cuh"

namespace standoff::cuda {

void collide(const collision::CollideJob& job) {
  const DeviceScope scope(job.device);
  run_collide(job, Backend::cuda);
}

void sweep(const collision::SweepJob& job) {
  const DeviceScope scope(job.device);
  run_sweep(job, Backend::cuda);
}

}  // namespace standoff::cuda
