// SPDX-License-Identifier: Apache-2.0
// Algorithm 2 of the 2008 thesis on a GPU: a thread per sample of the field that is visited, and one number in device
// memory that each lowers. The fields lie there with one value per sample, x fastest, as the thesis's did.
//
// The thesis's kernel returns at the first sample that decides, whichever thread finds it. Here the lowest index of
// those that decide is the answer, so that it is the CPU's; a thread whose sample comes after one that has decided has
// nothing to do.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>

#include "field/cuda/any_mesh.cuh"
#include "gpu/platform.cuh"
#include "thesis/algorithm_2.h"

namespace standoff::STANDOFF_PLATFORM {

/// The arguments of the kernel. Pointers are to device memory.
struct SumTask {
  thesis::PosedField visited, other;
  const float* visited_values;
  const float* other_values;
  double threshold;
  Counter* found;  ///< at first kNotFound
};

inline constexpr Counter kNotFound = ~Counter{0};

/// Where kLeast, lowers `found` to the least sum, ordered(); else to the first index whose sum is below the threshold.
template <bool kLeast>
STANDOFF_KERNEL void __launch_bounds__(kThreads) sum_samples(SumTask task) {
  const auto other_value = [&](std::int64_t u, std::int64_t v, std::int64_t w) {
    return task.other_values[task.other.grid.index(u, v, w)];
  };
  const Size3& size = task.visited.grid.size;
  const std::int64_t samples = size.x * size.y * size.z;
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < samples;
       n += std::int64_t{blockDim.x} * gridDim.x) {
    if (!kLeast && static_cast<Counter>(n) >= load_relaxed(task.found)) return;
    const std::int64_t i = n % size.x, j = n / size.x % size.y, k = n / (size.x * size.y);
    const double sum = thesis::sum_at(task.visited, i, j, k, task.visited_values[n], task.other, other_value);
    if (kLeast)
      lower(task.found, ordered(sum));
    else if (sum < task.threshold)
      lower(task.found, static_cast<Counter>(n));
  }
}

/// Moves vertices, three numbers each, over which the threads stride.
STANDOFF_KERNEL void move_vertices(const double* from, std::int64_t count, Pose pose, double* to) {
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < count;
       n += std::int64_t{blockDim.x} * gridDim.x) {
    const Vec3 p = apply(pose, {from[3 * n], from[3 * n + 1], from[3 * n + 2]});
    to[3 * n] = p.x, to[3 * n + 1] = p.y, to[3 * n + 2] = p.z;
  }
}

/// The number of blocks whose threads stride over `items`.
inline std::int64_t striding_blocks(std::int64_t items) {
  return std::min<std::int64_t>(kManyBlocks, (items + kThreads - 1) / kThreads);
}

/// A field in device memory.
struct FieldOnDevice final : thesis::HeldField {
  float* values = nullptr;  ///< one per sample, x fastest
  Growing memory;           ///< of the values
  Memory found{sizeof(Counter)};
  mutable std::mutex asking;  ///< of `found`: kernels of one stream come one after the other anyway
};

/// Runs the kernel on the current device.
template <bool kLeast>
Counter found_by(const thesis::Algorithm2Job& job, double threshold) {
  const auto &visited = static_cast<const FieldOnDevice&>(job.visited),
             &other = static_cast<const FieldOnDevice&>(job.other);
  const SumTask task{visited.at(job.of_visited), other.at(job.of_other), visited.values, other.values, threshold,
                     other.found.as<Counter>()};
  Counter found = kNotFound;
  const std::lock_guard lock(other.asking);
  fill_bytes(nullptr, task.found, 0xff, sizeof found);
  launch(nullptr, "Algorithm 2", sum_samples<kLeast>, striding_blocks(visited.grid.sample_count()), kThreads, task);
  copy_out(&found, task.found, sizeof found);
  return found;
}

}  // namespace standoff::STANDOFF_PLATFORM
