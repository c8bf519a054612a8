// Collision queries on CUDA.
#include "cuda/collide.cuh"
#include "cuda/collision.h"
#include "cuda/device_scope.cuh"
#include "cuda/sweep.cuh"

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
