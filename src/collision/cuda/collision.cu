// SPDX-License-Identifier: Apache-2.0
// Collision queries on a GPU. nvcc compiles this file for CUDA; collision_emulated.cpp compiles it for the emulation.
#include "collision/cuda/collide.cuh"
#include "collision/cuda/distance.cuh"
#include "collision/cuda/sweep.cuh"
#include "collision/device.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

void collide(const collision::CollideJob& job) {
  const DeviceScope scope(job.device);
  run_collide(job, kBackend);
}

void sweep(const collision::SweepJob& job) {
  const DeviceScope scope(job.device);
  run_sweep(job, kBackend);
}

void distance(const collision::DistanceJob& job) {
  const DeviceScope scope(job.device);
  run_distance(job, kBackend);
}

}  // namespace standoff::STANDOFF_PLATFORM
