// SPDX-License-Identifier: Apache-2.0
// The sign of a field in device memory, of a closed mesh: whether the mesh is closed (closed.cuh), the steps of winding
// numbers along rows (row_steps.cuh), and the negation of the samples inside. Launched after the field, in the same
// workspace. The bits are those of the CPU's signs, as all decisions are exact.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "gpu/mesh.cuh"
#include "gpu/platform.cuh"
#include "sign/cuda/closed.cuh"
#include "sign/cuda/row_steps.cuh"
#include "sign/cuda/sign_values.cuh"
#include "sign/plan.h"
#include "sign/signs.h"
#include "standoff/sign.h"

namespace standoff::STANDOFF_PLATFORM {

/// Which winding numbers are negative.
struct InsideRule {
  WindingRule rule;
  bool invert;
  STANDOFF_DEVICE bool is_inside(int winding) const { return standoff::is_inside(winding, rule) != invert; }
};

/// The bits of eight samples, the first one in the lowest bit, from the eight bytes of their steps. Adds the steps.
STANDOFF_DEVICE unsigned inside_bits(const std::uint32_t* words, const InsideRule& rule, int& winding) {
  unsigned bits = 0;
  for (int half = 0; half < 2; ++half) {
    const std::uint32_t word = words[half];
    if (word == RowSteps::kNoSteps) {
      if (rule.is_inside(winding)) bits |= 0xfu << 4 * half;
      continue;
    }
    for (int n = 0; n < 4; ++n) {
      winding += static_cast<int>(word >> 8 * n & 0xff) - static_cast<int>(RowSteps::kNoStep);
      if (rule.is_inside(winding)) bits |= 1u << (4 * half + n);
    }
  }
  return bits;
}

inline constexpr unsigned kRowsOfTile = static_cast<unsigned>(kTileSide * kTileSide);

/// Negates the samples inside. A thread per row of samples; 64 of them go through the tiles along x side by side.
/// Sparse output: a tile that is not stored has one sign, as the thickness is at least the spacing; it is that of its
/// first sample.
template <bool kSparse>
STANDOFF_KERNEL void __launch_bounds__(kSignThreads) sign_rows(RowTask task, DeviceOutput output, InsideRule rule) {
  if (task.outcome->stopped != 0 || task.outcome->doubts != 0) return;
  const std::int64_t n = std::int64_t{blockIdx.x} * (blockDim.x / kRowsOfTile) + threadIdx.x / kRowsOfTile;
  if (n >= task.steps.rows_of_tiles()) return;
  const std::int64_t row = threadIdx.x % kRowsOfTile, ty = n % task.steps.tiles_y,
                     tz = n / task.steps.tiles_y + task.steps.first_layer, j = kTileSide * ty + row % kTileSide,
                     k = kTileSide * tz + row / kTileSide;
  if (j >= task.y.size || k >= task.z.size) return;
  int winding = 0;
  for (std::int64_t tx = 0; tx < task.steps.tiles_x; ++tx) {
    const std::int64_t tile = task.steps.tile(tx, ty, tz);
    unsigned bits = inside_bits(task.steps.words + RowSteps::kWordsOfTile * tile + row * kTileSide / 4, rule, winding);
    const std::int64_t left = task.x.size - kTileSide * tx;
    if (left < kTileSide) bits &= (1u << left) - 1;
    if (bits == 0) continue;
    float* values;
    if constexpr (kSparse) {
      std::int32_t* const slot = &output.slots[tx + task.steps.tiles_x * (ty + task.steps.tiles_y * tz)];
      const std::int32_t at = load_relaxed(slot);
      if (at < 0) {
        if (row == 0 && (bits & 1) != 0) atomicMin(slot, std::int32_t{DistanceField::kInside});  // below kOutside
        continue;
      }
      values = output.values + kTileSamples * at + kTileSide * row;
    } else {
      values = output.values + kTileSide * tx + task.x.size * (j + task.y.size * k);
    }
    for (int x = 0; x < kTileSide; ++x)
      if ((bits >> x & 1) != 0) values[x] = negated(values[x]);
  }
}

/// Throws Error{usage} unless the device decides the task's sign.
inline void check_sign(const Task& task) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("cuda: ") + what); };
  validate(task.sign);
  if (!is_sign_on_device(task.sign))
    fail(
        "only the signs winding and automatic are decided on the device, without outer; take one of them, or "
        "compute()");
  if (!task.output.slots) return;
  if (task.method != Method::tiles && task.method != Method::thesis)
    fail("sparse output gets a sign by the methods tiles and thesis; take one of them, or dense output");
  if (task.thickness < task.grid.max_spacing())
    fail(
        "sparse output gets a sign where the thickness is at least the largest spacing; raise it, or take dense "
        "output");
}

/// The arrays of a sign.
struct SignArrays {
  /// Steps are held for some layers of tiles at a time: a byte for each sample, of 256 million samples or of one layer.
  static constexpr std::int64_t kMostStepBytes = std::int64_t{1} << 28;

  MeshParts parts;
  LongRows long_ones;
  std::uint32_t* words;
  std::int64_t layers_at_once;

  SignArrays(gpu::Workspace& memory, const Task& task, std::int64_t most_step_bytes = kMostStepBytes)
      : parts(memory, task.mesh, !task.sign.as_oriented) {
    const Size3 tiles = DistanceField::tiles_of(task.grid.size);
    if (tiles.x > (std::int64_t{1} << 40) / tiles.y)
      throw Error(ErrorCode::limit, "cuda: a layer of the grid has too many samples for a sign; take a smaller one");
    const std::int64_t layer = kTileSamples * tiles.x * tiles.y;
    layers_at_once = std::clamp<std::int64_t>(most_step_bytes / layer, 1, tiles.z);
    long_ones = {memory.take<std::uint32_t>(task.mesh.triangle_count), memory.take<Counter>(1)};
    words = memory.take<std::uint32_t>(layer * layers_at_once / 4);
  }

  /// Launches all of it, after the field.
  void enqueue(const Task& task, Stream stream) const {
    enqueue_closed(task.mesh, parts, task.sign.as_oriented, task.outcome, stream);
    const Size3 tiles = DistanceField::tiles_of(task.grid.size);
    RowTask rows{
        task.mesh, axis_of(task.grid, 0), axis_of(task.grid, 1), axis_of(task.grid, 2), {words, tiles.x, tiles.y, 0, 0},
        long_ones, task.outcome};
    const std::int64_t of_triangles = (task.mesh.triangle_count + kRowThreads - 1) / kRowThreads;
    for (std::int64_t first = 0; first < tiles.z; first += layers_at_once) {
      rows.steps.first_layer = first;
      rows.steps.end_layer = std::min(tiles.z, first + layers_at_once);
      fill_bytes(stream, words, static_cast<int>(RowSteps::kNoStep), 4 * rows.steps.word_count());
      fill_bytes(stream, long_ones.count, 0, sizeof(Counter));
      launch(stream, "scan rows", scan_rows, of_triangles, kRowThreads, rows);
      launch(stream, "scan long rows", scan_long_rows, kManyBlocks, kRowThreads, rows);
      const std::int64_t at_once = kSignThreads / kRowsOfTile,
                         blocks = (rows.steps.rows_of_tiles() + at_once - 1) / at_once;
      launch(stream, "sign rows", task.output.slots ? sign_rows<true> : sign_rows<false>, blocks, kSignThreads, rows,
             task.output, InsideRule{task.sign.rule, task.sign.invert});
    }
  }
};

}  // namespace standoff::STANDOFF_PLATFORM
