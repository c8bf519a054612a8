// SPDX-License-Identifier: Apache-2.0
// Algorithm 1 of the 2008 thesis: a warp per triangle visits the samples in its grown box, and each sample keeps the
// least distance by an atomic minimum that is written only if smaller, which alone gave the thesis a factor of 2 to 3.
//
// A sample's distance so far and its triangle are one 64-bit number: the high half holds the distance's bits, which
// ascend with it, the low half the triangle's index, so that the lowest index wins ties.
#pragma once

#include <cstdint>
#include <type_traits>

#include "field/cuda/counted_run.cuh"
#include "field/cuda/pipeline.cuh"
#include "thesis/thesis_distance.h"

namespace standoff {

// Ablation: a measured kernel stops after some step. Table 5.4 of the thesis shows the differences of two such times,
// which are the costs of single steps.

/// The last step of a kernel; each value goes farther than the one before. A step that a method lacks costs it nothing.
enum class StopAfter {
  lists,     ///< tiles: lists made and walked through; thesis: samples walked through, with their positions
  set_up,    ///< triangles set up in shared memory
  rows,      ///< the samples found that a triangle must be measured from
  distance,  ///< distances, and the least of them
  read,      ///< thesis: the sample's distance so far is read
  write,     ///< nothing is left out: the field
  always,    ///< thesis: the field, written without reading the sample first
};

/// The bits of a float that no arithmetic gives. A step that is left out would happen at these bits only: so the
/// compiler must compute everything before it.
inline constexpr std::uint32_t kNeverBits = 0x7fa00001u;

}  // namespace standoff

namespace standoff::STANDOFF_PLATFORM {

STANDOFF_KERNEL void clear_samples(Counter* nearest, std::int64_t samples) {
  const Counter infinite = Counter{__float_as_uint(__builtin_inff())} << 32 | kNoTriangle;
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < samples;
       n += std::int64_t{blockDim.x} * gridDim.x)
    nearest[n] = infinite;
}

/// Visits the samples of a brick in a triangle's range.
template <StopAfter kLast>
STANDOFF_DEVICE void lower_brick(const Lattice& l, const Corners& c, std::uint32_t triangle, const SampleRange& range,
                                 const Size3& brick, Counter* nearest) {
  const SampleRange all = samples_of_brick(brick), here = intersection(range, all);
  const Size3& first = all.begin;
  const ThesisTriangle<float> t =
      thesis_triangle<float>(l, c.at, cell_center<kBrickSide>(l, brick.x, brick.y, brick.z));
  const std::int64_t nx = here.end.x - here.begin.x, ny = here.end.y - here.begin.y, count = here.count();
  for (std::int64_t n = threadIdx.x % 32; n < count; n += 32) {
    const std::int64_t x = here.begin.x + n % nx, y = here.begin.y + n / nx % ny, z = here.begin.z + n / (nx * ny);
    const Triple<float> p{l.coordinate[0][x - first.x], l.coordinate[1][y - first.y], l.coordinate[2][z - first.z]};
    if (kLast < StopAfter::distance) {
      if (__float_as_uint(p.x + p.y + p.z) == kNeverBits) *nearest = triangle;
      continue;
    }
    const Counter mine = Counter{__float_as_uint(distance_sq(t, p))} << 32 | triangle;
    Counter* const sample = nearest + x + l.size[0] * (y + l.size[1] * z);
    // The plain read may be out of date, but is never too small; the atomic minimum decides.
    const bool lower = (kLast != StopAfter::read && kLast != StopAfter::write) || mine < load_relaxed(sample);
    const bool writes = kLast >= StopAfter::write || mine >> 32 == kNeverBits;
    if (lower && writes) atomicMin(sample, mine);
  }
}

/// Warps stride over the triangles.
template <StopAfter kLast>
STANDOFF_KERNEL void lower_samples(Lattice l, DeviceMesh mesh, Grid grid, double thickness, Counter* nearest,
                                   Outcome* outcome) {
  const std::int64_t warps = std::int64_t{gridDim.x} * (blockDim.x / 32);
  Counter examined = 0;
  for (std::int64_t n = std::int64_t{blockIdx.x} * (blockDim.x / 32) + threadIdx.x / 32; n < mesh.used_count();
       n += warps) {
    const std::uint32_t triangle = used_triangle(mesh, n);
    if (!is_valid(mesh, triangle, outcome)) continue;
    const Corners c = corners_of(mesh, triangle);
    const SampleRange range = visited_samples(c.at, grid, thickness);
    if (range.empty()) continue;
    examined += static_cast<Counter>(range.count());
    const SampleRange bricks = bricks_of(range);
    for (std::int64_t z = bricks.begin.z; z < bricks.end.z; ++z)
      for (std::int64_t y = bricks.begin.y; y < bricks.end.y; ++y)
        for (std::int64_t x = bricks.begin.x; x < bricks.end.x; ++x)
          lower_brick<kLast>(l, c, triangle, range, {x, y, z}, nearest);
  }
  if (threadIdx.x % 32 == 0) atomicAdd(&outcome->samples_examined, examined);
}

/// A block has a thread for each sample of a tile, x fastest.
inline constexpr int kTileThreads = kTileSamples;
STANDOFF_DEVICE SampleAt sample_of_thread() {
  const int thread = static_cast<int>(threadIdx.x);
  return {thread % 8, thread / 8 % 8, thread / 64};
}

/// For sparse output: writes 1 for each tile with a band sample, 0 for the others, and 0 behind the last. Blocks of 512
/// threads stride over the tiles.
STANDOFF_KERNEL void __launch_bounds__(kTileThreads)
    mark_near_tiles(Lattice l, const Counter* nearest, std::uint32_t* used, Outcome* outcome) {
  if (outcome->stopped) return;
  const SampleAt at = sample_of_thread();
  for (std::int64_t index = blockIdx.x; index < l.tile_count(); index += gridDim.x) {
    std::int64_t tile[3];
    tile_at(l, index, tile);
    if (at.x >= inside<kTileSide>(l, tile, 0) || at.y >= inside<kTileSide>(l, tile, 1) ||
        at.z >= inside<kTileSide>(l, tile, 2))
      continue;
    const std::int64_t sample =
        tile[0] * 8 + at.x + l.size[0] * (tile[1] * 8 + at.y + l.size[1] * (tile[2] * 8 + at.z));
    const float d = __uint_as_float(static_cast<std::uint32_t>(nearest[sample] >> 32));
    if (sqrt(d) * l.unscale <= l.thickness_world) atomicOr(&used[index], 1u);
  }
}

/// Makes the field from least squared distances. A sparse field does not store a tile without a band sample. Blocks
/// stride over the tiles.
STANDOFF_KERNEL void __launch_bounds__(kTileThreads)
    write_samples(Lattice l, const Counter* nearest, DeviceOutput output, Outcome* outcome) {
  __shared__ TileView view;
  __shared__ unsigned band;  // samples of the tile in the band
  if (outcome->stopped) return;
  const int thread = static_cast<int>(threadIdx.x);
  const SampleAt at = sample_of_thread();
  for (std::int64_t index = blockIdx.x; index < l.tile_count(); index += gridDim.x) {
    if (thread < 32) {  // saves the other warps the division
      std::int64_t tile[3];
      tile_at(l, index, tile);
      view_tile(l, tile, thread, view);
    }
    if (thread == 0) band = 0;
    __syncthreads();
    const bool in_grid = at.x < view.inside[0] && at.y < view.inside[1] && at.z < view.inside[2];
    const std::int64_t sample =
        view.tile[0] * 8 + at.x + l.size[0] * (view.tile[1] * 8 + at.y + l.size[1] * (view.tile[2] * 8 + at.z));
    float value = __builtin_inff();
    std::uint32_t triangle = kNoTriangle;
    if (in_grid) {
      value = sqrt(__uint_as_float(static_cast<std::uint32_t>(nearest[sample] >> 32))) * l.unscale;
      triangle = static_cast<std::uint32_t>(nearest[sample]);
    }
    const bool in_band = triangle != kNoTriangle && value <= l.thickness_world;
    const std::uint32_t votes = __ballot_sync(0xffffffffu, in_band);
    if (thread % 32 == 0) atomicAdd(&band, static_cast<unsigned>(__popc(votes)));
    __syncthreads();
    const unsigned all = band;
    if (output.slots ? all != 0 : in_grid) {
      const std::int64_t to = output.slots ? std::int64_t{output.slots[index]} * kTileSamples + thread : sample;
      output.values[to] = min(value, l.thickness_world);
      if (output.nearest) output.nearest[to] = in_band ? triangle : kNoTriangle;
    }
    if (thread == 0) atomicAdd(&outcome->samples_band, Counter{all});
    __syncthreads();
    if (thread == 0 && output.slots && all == 0) output.slots[index] = -1;
  }
}

/// The pipeline of Algorithm 1 (pipeline.cuh defines pipelines). It keeps a number per sample.
struct Algorithm1 {
  static constexpr std::int64_t kBytesPerEntry = 1;  // it has no lists
  TileArrays tiles;
  Counter* nearest;

  Algorithm1(gpu::Workspace& memory, std::int64_t, const Lattice& l, std::int64_t)
      : tiles(memory, l.tile_count()), nearest(memory.take<Counter>(l.size[0] * l.size[1] * l.size[2])) {}

  /// Finds the least distance of each sample.
  template <StopAfter kLast = StopAfter::write>
  void clear_and_lower(const Lattice& l, const Task& task, Stream stream) const {
    const std::int64_t samples = task.grid.sample_count(), warps = blocks_for(32 * task.mesh.used_count());
    launch(stream, "clear", clear_outcome, 1, 1, task.outcome, static_cast<Counter*>(nullptr), 0);
    launch(stream, "clear samples", clear_samples, kManyBlocks, kThreads, nearest, samples);
    launch(stream, "Algorithm 1", lower_samples<kLast>, warps < kManyBlocks * 8 ? warps : kManyBlocks * 8, kThreads, l,
           task.mesh, task.grid, task.thickness, nearest, task.outcome);
  }
  /// Gives tiles their slots, if the output is sparse.
  void mark(const Lattice& l, const Task& task, Stream stream) const {
    if (!task.output.slots) return;
    fill_bytes(stream, tiles.used, 0, (l.tile_count() + 1) * static_cast<std::int64_t>(sizeof(std::uint32_t)));
    launch(stream, "mark tiles", mark_near_tiles, tile_blocks(l), kTileThreads, l, nearest, tiles.used, task.outcome);
    tiles.give(l, task, stream);
  }
  /// First half: both.
  template <StopAfter kLast = StopAfter::write>
  void lower(const Lattice& l, const Task& task, Stream stream) const {
    clear_and_lower<kLast>(l, task, stream);
    mark(l, task, stream);
  }

  /// Second half: makes the field from them.
  void write(const Lattice& l, const Task& task, Stream stream) const {
    launch(stream, "write", write_samples, tile_blocks(l), kTileThreads, l, nearest, task.output, task.outcome);
  }

  void enqueue(const Lattice& l, const Task& task, Stream stream) const {
    lower(l, task, stream);
    write(l, task, stream);
  }
  void run(CountedRun& run) {
    lower(run.lattice, run.task, nullptr);
    finish(run);
  }
  /// The second half after the host has made room for the values.
  void finish(CountedRun& run) const {
    run.wait();
    require_free_memory(run.value_bytes());
    run.make_values();
    write(run.lattice, run.task, nullptr);
  }
};

// Fields without some steps, to measure the cost of these (Table 5.4 of the thesis): the product's kernels run with
// other steps.

/// Computes the field, but does not write it.
struct StepsToDistance : AllSteps {
  static constexpr bool kWrites = false;
  static STANDOFF_DEVICE bool uses(float value) { return __float_as_uint(value) == kNeverBits; }
};
/// Finds the samples to measure from, and counts them.
struct StepsToRows : StepsToDistance {
  static constexpr bool kMeasures = false;
};
/// Sets up triangles, and reads a number of each.
struct StepsToSetUp : StepsToRows {
  static constexpr bool kFindsRows = false;
};
/// Walks through the lists.
struct StepsToLists : StepsToSetUp {
  static constexpr bool kSetsUp = false;
};

template <StopAfter kLast>
using StepsTo = std::conditional_t<
    kLast == StopAfter::lists, StepsToLists,
    std::conditional_t<
        kLast == StopAfter::set_up, StepsToSetUp,
        std::conditional_t<kLast == StopAfter::rows, StepsToRows,
                           std::conditional_t<kLast == StopAfter::distance, StepsToDistance, AllSteps>>>>;

/// Does enqueue() without the steps after kLast, for thin bands and for Algorithm 1; it computes other fields whole.
/// Requires a task that enqueue() accepts.
template <StopAfter kLast>
void enqueue_until(const Task& task, void* workspace, std::int64_t bytes, Stream stream) {
  const Lattice l = make_lattice(task.grid, task.thickness);
  if (task.method == Method::thesis) {
    const auto algorithm = in_workspace<Algorithm1>(task, l, workspace, bytes);
    algorithm.template lower<kLast>(l, task, stream);
    algorithm.write(l, task, stream);
  } else if (is_thin(task.grid, task.thickness)) {
    const auto band = in_workspace<ThinBand>(task, l, workspace, bytes);
    band.count(l, task, stream);
    band.template fill<StepsTo<kLast>>(l, task, stream);
  } else {
    in_workspace<ThickBand>(task, l, workspace, bytes).enqueue(l, task, stream);
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
