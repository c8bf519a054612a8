// SPDX-License-Identifier: Apache-2.0
// Where triangles cross the rows of a grid, on the GPU: exactly, as rows/ray_crossing.h decides it, by determinants in
// double that seldom need more digits. Each crossing is a step of the winding number at the first sample past it. Steps
// are added up in a byte for each sample, in any order; a pass along the rows then gives the winding numbers.
#pragma once

#include <array>
#include <cstdint>

#include "core/grid_axis.h"
#include "core/tile_count.h"
#include "gpu/mesh.cuh"
#include "gpu/platform.cuh"
#include "sign/rows/ray_crossing.h"
#include "sign/rows/sample_axis.h"

namespace standoff::STANDOFF_PLATFORM {

inline constexpr unsigned kRowThreads = 128;
/// A triangle with more rows is shared by warps.
inline constexpr std::int64_t kRowsOfALane = 64;

/// The steps of some layers of tiles, in device memory. Four samples to a word, the first one in its lowest byte; the
/// samples of a tile lie together, x fastest. A byte counts from kNoStep, so that it never borrows from its neighbour.
struct RowSteps {
  static constexpr std::uint32_t kNoStep = 0x80, kNoSteps = 0x80808080u;
  static constexpr std::int64_t kWordsOfTile = kTileSide * kTileSide * kTileSide / 4;

  std::uint32_t* words;
  std::int64_t tiles_x, tiles_y;
  std::int64_t first_layer, end_layer;  // tiles along z

  STANDOFF_HD std::int64_t tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return tx + tiles_x * (ty + tiles_y * (tz - first_layer));
  }
  STANDOFF_HD std::int64_t rows_of_tiles() const { return tiles_y * (end_layer - first_layer); }
  STANDOFF_HD std::int64_t word_count() const { return kWordsOfTile * tiles_x * rows_of_tiles(); }
};

/// Triangles with many rows.
struct LongRows {
  std::uint32_t* triangles;
  Counter* count;
};

/// What the scan reads and writes.
struct RowTask {
  DeviceMesh mesh;
  GridAxis x, y, z;
  RowSteps steps;
  LongRows long_ones;
  Outcome* outcome;
};

// The signs of determinants that the first stage leaves open, in three ways, each of which takes longer than the one
// before. `undecided` is set where one gives up.

/// None.
struct NoSigns {
  bool undecided = false;
  STANDOFF_DEVICE int orient2d(const Flat&, const Flat&, const Flat&) { return give_up(); }
  STANDOFF_DEVICE int orient3d(const Vec3&, const Vec3&, const Vec3&, const Vec3&) { return give_up(); }
  STANDOFF_DEVICE int give_up() {
    undecided = true;
    return 0;
  }
};

/// Those that 100 bits decide.
struct TwofoldSigns : NoSigns {
  STANDOFF_DEVICE int orient2d(const Flat& a, const Flat& b, const Flat& c) {
    return sign_of(value_of_determinant(
        rounded_determinant2d(a, b, c), kRounded2d, 1, [&] { return are_level(a, b, c); },
        [&] { return twofold_determinant2d(a, b, c); }, [&] { return give_up(); }));
  }
  STANDOFF_DEVICE int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return sign_of(value_of_determinant(
        rounded_determinant3d(a, b, c, d), kRounded3d, 1, [&] { return are_level(a, b, c, d); },
        [&] { return twofold_determinant3d(a, b, c, d); }, [&] { return give_up(); }));
  }
};

/// All, by exact sums. They take memory, which is a warp's part of shared memory: one lane works at a time.
struct SlowSigns {
  static constexpr bool undecided = false;
  double* parts;

  STANDOFF_DEVICE int orient2d(const Flat& a, const Flat& b, const Flat& c) const {
    return sign_of(determinant2d_exactly(a, b, c, parts));
  }
  STANDOFF_DEVICE int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
    return sign_of(determinant3d_exactly(a, b, c, d, parts));
  }
};

/// The rows of samples that a triangle may cross.
struct RowBlock {
  std::int64_t first_y, first_z, width, height;
  STANDOFF_DEVICE std::int64_t count() const { return width > 0 && height > 0 ? width * height : 0; }
};

/// Those beside the triangle's box. Samples are displaced upwards: a row at the box's lower side may cross it, a row at
/// its upper side does not (ray_crossing.h).
STANDOFF_DEVICE RowBlock rows_beside(const RowTask& task, const std::array<Vec3, 3>& t) {
  const double low_y = min(min(t[0].y, t[1].y), t[2].y), high_y = max(max(t[0].y, t[1].y), t[2].y),
               low_z = min(min(t[0].z, t[1].z), t[2].z), high_z = max(max(t[0].z, t[1].z), t[2].z);
  const SampleAxis y(task.y), z(task.z);
  const std::int64_t layer_begin = kTileSide * task.steps.first_layer, layer_end = kTileSide * task.steps.end_layer;
  std::int64_t first_z = z.first_from(low_z), end_z = z.first_from(high_z);
  if (first_z < layer_begin) first_z = layer_begin;
  if (end_z > layer_end) end_z = layer_end;
  const std::int64_t first_y = y.first_from(low_y);
  return {first_y, first_z, y.first_from(high_y) - first_y, end_z - first_z};
}

/// A row of the grid.
struct RowPlace {
  std::int64_t j = 0, k = 0;
};

/// What a row's crossing with a triangle does to the winding number.
struct RowStep {
  int step = 0;  ///< 0: nothing
  bool undecided = false;
  std::int64_t past = 0;  ///< the first sample with the new number
};

STANDOFF_DEVICE std::array<Vec3, 3> vecs_of(const DeviceMesh& mesh, std::uint32_t triangle) {
  const Corners c = corners_of(mesh, triangle);
  return {vec_of(c.at[0]), vec_of(c.at[1]), vec_of(c.at[2])};
}

/// Undecided unless the first stage and the rounded crossing are right, as nearly always.
STANDOFF_DEVICE RowStep quick_step(const RowTask& task, const RayTriangle& ray, const RowPlace& row) {
  const double y = task.y.at(row.j), z = task.z.at(row.k);
  NoSigns signs;
  const int crossing = ray.crossing(y, z, signs);
  if (crossing == 0) return {0, signs.undecided, 0};
  const std::int64_t size = task.x.size,
                     past = sample_at_or_above(SampleAxis(task.x).to_samples(ray.crossing_x(y, z)), size);
  bool is_first = true;
  for (int before = 0; before < 2; ++before) {
    const std::int64_t n = past - before;
    if (n >= 0 && n < size) is_first &= ray.is_past({task.x.at(n), y, z}, crossing, signs) != (before != 0);
  }
  return {past < size ? -crossing : 0, signs.undecided || !is_first, past};
}

template <class Signs>
STANDOFF_DEVICE RowStep step_by(const RowTask& task, std::uint32_t triangle, const RowPlace& row, Signs signs) {
  const RayTriangle ray(vecs_of(task.mesh, triangle));
  const double y = task.y.at(row.j), z = task.z.at(row.k);
  const int crossing = ray.crossing(y, z, signs);
  if (signs.undecided) return {0, true, 0};
  if (crossing == 0) return {};
  const std::int64_t past = first_past(ray, SampleAxis(task.x), y, z, crossing, signs);
  return {past < task.x.size ? -crossing : 0, signs.undecided, past};
}

STANDOFF_DEVICE void add_step(const RowTask& task, const RowStep& step, const RowPlace& row) {
  const std::int64_t tile = task.steps.tile(step.past / kTileSide, row.j / kTileSide, row.k / kTileSide),
                     sample = step.past % kTileSide + kTileSide * (row.j % kTileSide + kTileSide * (row.k % kTileSide));
  const auto shift = static_cast<unsigned>(8 * (sample % 4));
  const std::uint32_t one = 1u << shift,
                      before = atomicAdd(&task.steps.words[RowSteps::kWordsOfTile * tile + sample / 4],
                                         step.step > 0 ? one : 0u - one),
                      byte = before >> shift & 0xff;
  // The first step that a byte has no room for finds it full.
  if (byte == (step.step > 0 ? 0xffu : 0u)) atomicOr(&task.outcome->doubts, Counter{Outcome::kTooDeep});
}

/// The rows of a triangle that a lane looks at: first, first + apart, ... before `end`, in the order of the block.
struct RowsOfLane {
  std::uint32_t triangle;
  RowBlock block;
  std::int64_t first, apart, end;

  /// Row n of the block.
  STANDOFF_DEVICE RowPlace at(std::int64_t n) const {
    // A GPU divides numbers of 32 bits in a fifth of the time.
    const std::int64_t k =
        n >> 32 == 0 ? static_cast<std::uint32_t>(n) / static_cast<std::uint32_t>(block.width) : n / block.width;
    return {block.first_y + n - k * block.width, block.first_z + k};
  }
};

/// Adds the steps of the rows first + apart n whose bit n is set. All lanes take part. `parts`: the warp's memory for
/// SlowSigns.
STANDOFF_SELDOM void add_open_rows(const RowTask& task, const RowsOfLane& rows, std::int64_t first, std::uint64_t open,
                                   double* parts) {
  for (; __ballot_sync(0xffffffffu, open != 0) != 0; open &= open - 1) {
    RowStep step;
    RowPlace row;
    if (open != 0) {
      row = rows.at(first + rows.apart * (__ffsll(static_cast<long long>(open)) - 1));
      step = step_by(task, rows.triangle, row, TwofoldSigns());
    }
    for (std::uint32_t left = __ballot_sync(0xffffffffu, step.undecided); left != 0; left &= left - 1) {
      if (static_cast<int>(threadIdx.x % 32) == __ffs(static_cast<int>(left)) - 1)
        step = step_by(task, rows.triangle, row, SlowSigns{parts});
      __syncwarp();
    }
    if (step.step != 0) add_step(task, step, row);
  }
}

/// Adds the steps of all rows. All lanes take part, each with a triangle of its own, or several with one.
STANDOFF_DEVICE void add_rows(const RowTask& task, const RowsOfLane& rows, double* parts) {
  std::int64_t n = rows.first;
  do {
    const std::int64_t begin = n;
    std::uint64_t open = 0;  // rows that are not decided yet
    if (n < rows.end) {
      const RayTriangle ray(vecs_of(task.mesh, rows.triangle));
      for (std::uint64_t bit = 1; bit != 0 && n < rows.end; bit *= 2, n += rows.apart) {
        const RowPlace row = rows.at(n);
        const RowStep step = quick_step(task, ray, row);
        if (step.undecided)
          open |= bit;
        else if (step.step != 0)
          add_step(task, step, row);
      }
    }
    if (__ballot_sync(0xffffffffu, open != 0) != 0) add_open_rows(task, rows, begin, open, parts);
  } while (__ballot_sync(0xffffffffu, n < rows.end) != 0);
}

/// Whether there will be no sign, for a reason that no thread of the scan adds: so all answer alike.
STANDOFF_DEVICE bool is_left_out(const Outcome& outcome) {
  return outcome.stopped != 0 || (load_relaxed(&outcome.doubts) & (Outcome::kOpen | Outcome::kNotOutwards)) != 0;
}

/// A thread per triangle. Lists the triangles with many rows.
STANDOFF_KERNEL void __launch_bounds__(kRowThreads) scan_rows(STANDOFF_CONSTANT RowTask task) {
  __shared__ double parts[kRowThreads / 32][Expansion::kMostParts];
  if (is_left_out(*task.outcome)) return;
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  const auto triangle = static_cast<std::uint32_t>(n);
  RowBlock rows{};
  if (n < task.mesh.triangle_count) rows = rows_beside(task, vecs_of(task.mesh, triangle));
  const bool is_long = rows.count() > kRowsOfALane;
  const std::uint32_t long_ones = __ballot_sync(0xffffffffu, is_long), lane = threadIdx.x % 32;
  if (long_ones != 0) {
    Counter first = 0;
    if (lane == 0) first = atomicAdd(task.long_ones.count, static_cast<Counter>(__popc(long_ones)));
    first = __shfl_sync(0xffffffffu, first, 0);
    const Counter place = first + static_cast<Counter>(__popc(long_ones & ((1u << lane) - 1)));
    if (is_long) task.long_ones.triangles[place] = triangle;
  }
  add_rows(task, {triangle, rows, 0, 1, is_long ? 0 : rows.count()}, parts[threadIdx.x / 32]);
}

/// Warps share the triangles with many rows.
STANDOFF_KERNEL void __launch_bounds__(kRowThreads) scan_long_rows(STANDOFF_CONSTANT RowTask task) {
  __shared__ double parts[kRowThreads / 32][Expansion::kMostParts];
  if (is_left_out(*task.outcome)) return;
  const auto count = static_cast<std::int64_t>(*task.long_ones.count);
  if (count == 0) return;
  const std::int64_t warps = std::int64_t{gridDim.x} * (blockDim.x / 32), shares = warps > count ? warps / count : 1;
  for (std::int64_t n = (std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x) / 32; n < count * shares; n += warps) {
    const std::uint32_t triangle = task.long_ones.triangles[n / shares];
    const RowBlock rows = rows_beside(task, vecs_of(task.mesh, triangle));
    add_rows(task, {triangle, rows, 32 * (n % shares) + threadIdx.x % 32, 32 * shares, rows.count()},
             parts[threadIdx.x / 32]);
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
