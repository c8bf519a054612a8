// SPDX-License-Identifier: Apache-2.0
// Vector propagation and jump flooding on a GPU. Seeds come from Algorithm 1, and the field is written as it does.
#pragma once

#include <cstdint>
#include <utility>

#include "approximate/jumpflood.h"
#include "approximate/propagate.h"
#include "approximate/spread.h"
#include "field/cuda/counted_run.cuh"
#include "thesis/algorithm_1.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Corners by index, without a check: only triangles that Algorithm 1 has found valid are handed on.
struct DeviceCorners {
  DeviceMesh mesh;
  STANDOFF_HD void operator()(std::uint32_t triangle, Triple<double> (&corner)[3]) const {
    for (int which = 0; which < 3; ++which) {
      const double* const v = mesh.vertices + 3 * std::int64_t{mesh.triangles[3 * std::int64_t{triangle} + which]};
      corner[which] = {v[0], v[1], v[2]};
    }
  }
};
using DeviceSpace = SpreadSpace<DeviceCorners>;

/// Measures the seeds anew, as all other distances of this method, and forgets what is not within `thickness` of a
/// triangle. Counts the seeds in Outcome::needed_entries. Threads stride over the samples.
STANDOFF_KERNEL void measure_seeds(DeviceSpace space, float thickness, Counter* found, Outcome* outcome) {
  if (outcome->stopped) return;
  const Lattice& l = space.lattice;
  Counter seeds = 0;
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < l.size[0] * l.size[1] * l.size[2];
       n += std::int64_t{blockDim.x} * gridDim.x) {
    const bool is_seed =
        triangle_of(found[n]) != kNoTriangle && sqrt(distance_sq_of(found[n])) * l.unscale <= thickness;
    found[n] = is_seed ? space.measured(n % l.size[0], n / l.size[0] % l.size[1], n / (l.size[0] * l.size[1]),
                                        triangle_of(found[n]))
                       : kNothingFound;
    seeds += is_seed;
  }
  atomicAdd(&outcome->samples_examined, seeds);
  atomicAdd(&outcome->needed_entries, seeds);
}

/// Stops all later kernels if there are no seeds.
STANDOFF_KERNEL void check_seeds(Outcome* outcome) {
  if (outcome->stopped) return;
  const bool some = outcome->needed_entries > 0;
  outcome->needed_entries = some ? 0 : Outcome::kNoSeeds;
  if (!some) stop(outcome);
}

/// The rows of a front with at least `first` steps along z, a thread for each.
STANDOFF_KERNEL void sweep_front(DeviceSpace space, int sweep, std::int64_t front, FrontSteps steps, Counter* found,
                                 Outcome* outcome) {
  const std::int64_t step = steps.first + std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (outcome->stopped || step >= steps.past) return;
  const SweptRow row = swept_row(space.lattice, sweep, front, step);
  atomicAdd(&outcome->samples_examined, static_cast<Counter>(sweep_row(space, sweep, row.y, row.z, found)));
}

/// A pass of jump flooding. Threads stride over the samples.
STANDOFF_KERNEL void jump_all(DeviceSpace space, std::int64_t step, const Counter* before, Counter* after,
                              Outcome* outcome) {
  if (outcome->stopped) return;
  const std::int64_t* const size = space.lattice.size;
  std::int64_t measured = 0;
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < size[0] * size[1] * size[2];
       n += std::int64_t{blockDim.x} * gridDim.x)
    after[n] = jump(space, step, n % size[0], n / size[0] % size[1], n / (size[0] * size[1]), before, measured);
  atomicAdd(&outcome->samples_examined, static_cast<Counter>(measured));
}

/// The pipeline of a method that begins with Algorithm 1's seeds. `Way` hands triangles on: Propagation or Jumps.
template <class Way>
struct Spreading : Algorithm1 {
  Way way;

  Spreading(gpu::Workspace& memory, std::int64_t triangles, const Lattice& l, std::int64_t entries)
      : Algorithm1(memory, triangles, l, entries), way(memory, l) {}

  /// First half. Calls after_pass() after each pass over the grid.
  template <class AfterPass>
  void lower(const Lattice& l, const Task& task, Stream stream, const AfterPass& after_pass) {
    Task seeds = task;
    seeds.thickness = seed_thickness(task.grid);
    clear_and_lower(make_lattice(task.grid, seeds.thickness), seeds, stream);
    const DeviceSpace space{l, {task.mesh}};
    launch(stream, "measure seeds", measure_seeds, kManyBlocks, kThreads, space, static_cast<float>(seeds.thickness),
           nearest, task.outcome);
    launch(stream, "check seeds", check_seeds, 1, 1, task.outcome);
    nearest = way.run(space, nearest, task.outcome, stream, after_pass);
    mark(l, task, stream);
  }
  void enqueue(const Lattice& l, const Task& task, Stream stream) {
    lower(l, task, stream, [] {});
    write(l, task, stream);
  }
  void run(CountedRun& run) {
    lower(run.lattice, run.task, nullptr, [&] { run.wait(); });
    finish(run);
  }
};

struct Propagation {
  Propagation(gpu::Workspace&, const Lattice&) {}

  template <class AfterPass>
  Counter* run(const DeviceSpace& space, Counter* found, Outcome* outcome, Stream stream,
               const AfterPass& after_pass) const {
    for (int sweep = 0; sweep < kPropagationSweeps; ++sweep) {
      for (std::int64_t front = 0; front < row_fronts(space.lattice); ++front) {
        const FrontSteps steps = steps_of_front(space.lattice, front);
        launch(stream, "sweep front", sweep_front, blocks_for(steps.past - steps.first), kThreads, space, sweep, front,
               steps, found, outcome);
      }
      after_pass();
    }
    return found;
  }
};

template <int kMore>
struct Jumps {
  Counter* other;

  Jumps(gpu::Workspace& memory, const Lattice& l) : other(memory.take<Counter>(l.size[0] * l.size[1] * l.size[2])) {}

  template <class AfterPass>
  Counter* run(const DeviceSpace& space, Counter* found, Outcome* outcome, Stream stream,
               const AfterPass& after_pass) const {
    Counter *before = found, *after = other;
    for_each_jump(space.lattice, kMore, [&](std::int64_t step) {
      launch(stream, "jump", jump_all, kManyBlocks, kThreads, space, step, before, after, outcome);
      std::swap(before, after);
      after_pass();
    });
    return before;
  }
};

}  // namespace standoff::STANDOFF_PLATFORM
