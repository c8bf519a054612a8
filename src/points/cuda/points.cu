// SPDX-License-Identifier: Apache-2.0
// Queries at points on a GPU. nvcc compiles this file for CUDA; points_emulated.cpp compiles it for the emulation.
#include "gpu/platform.cuh"
#include "points/cuda/nearest.cuh"
#include "points/cuda/points.h"

namespace standoff::STANDOFF_PLATFORM {

void find_nearest(const NearestJob& job) {
  const DeviceScope scope(job.device);
  run_nearest(job, kBackend);
}

}  // namespace standoff::STANDOFF_PLATFORM
