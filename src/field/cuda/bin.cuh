// SPDX-License-Identifier: Apache-2.0
// Thin bands: which triangles each tile has to look at, by counting. A triangle goes into the tiles that its box grown
// by the thickness touches. One that touches more than two in a row is compared with their centres, exactly, by a block
// of threads of its own.
#pragma once

#include "field/binning.h"
#include "field/cuda/corners.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Threads of a block, unless a kernel needs another number.
inline constexpr unsigned kThreads = 256;

/// The tiles with samples in the triangle's grown box.
STANDOFF_DEVICE CellRange tiles_of(const Lattice& l, const Corners& c) {
  return reached_cells<kTileSide>(l, box_of(c.at[0], c.at[1], c.at[2]));
}

/// The triangles of each tile: entries[start[tile]] to entries[start[tile + 1] - 1].
struct TileLists {
  std::uint32_t* counts;   // per tile, and a zero behind the last
  Counter* start;          // as long
  std::uint32_t* entries;  // triangles
  Counter capacity;        // of entries
};

/// Triangles that touch many tiles.
struct LongList {
  std::uint32_t* triangles;
  Counter* count;
};

/// No list is this long: a count from here on has wrapped below zero.
inline constexpr std::uint32_t kNoCount = 0xf0000000u;

/// First pass: counts. Second pass: fills the lists from their ends, taking the counts back down to zero. False where
/// it would go beyond, to what is in front of the list.
template <bool kPlace>
STANDOFF_DEVICE bool use_tile(const TileLists& lists, std::int64_t tile, std::uint32_t triangle) {
  if (!kPlace) {
    atomicAdd(&lists.counts[tile], 1u);
    return true;
  }
  const std::uint32_t place = atomicSub(&lists.counts[tile], 1u) - 1;
  const bool fits = place < kNoCount;
  if (fits) lists.entries[lists.start[tile] + place] = triangle;
  return fits;
}

// bin_small waits for memory most of the time: six blocks to a multiprocessor, so at most 40 registers; four fill one
// of compute capability 7.5.
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 800
inline constexpr int kBinBlocks = 4;
#else
inline constexpr int kBinBlocks = 6;
#endif

/// A thread a triangle. Lists the long ones in the first pass.
template <bool kPlace>
STANDOFF_KERNEL void __launch_bounds__(kThreads, kBinBlocks)
    bin_small(Lattice l, DeviceMesh mesh, TileLists lists, LongList long_ones, Outcome* outcome) {
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (n >= mesh.used_count()) return;
  if (kPlace && outcome->stopped) return;
  const std::uint32_t triangle = used_triangle(mesh, n);
  if (!kPlace && !is_valid(mesh, triangle, outcome)) return;
  const CellRange r = tiles_of(l, corners_of(mesh, triangle));
  if (r.empty()) return;
  if (!r.is_small()) {
    if (!kPlace) long_ones.triangles[atomicAdd(long_ones.count, Counter{1})] = triangle;
    return;
  }
  bool fits = true;
  for (std::int64_t z = r.low[2]; z <= r.high[2]; ++z)
    for (std::int64_t y = r.low[1]; y <= r.high[1]; ++y)
      for (std::int64_t x = r.low[0]; x <= r.high[0]; ++x) fits &= use_tile<kPlace>(lists, l.tile(x, y, z), triangle);
  if (!fits) stop_for_miscount(outcome);
}

/// A block a long triangle, a thread a tile of its range.
template <bool kPlace>
STANDOFF_KERNEL void bin_long(Lattice l, DeviceMesh mesh, TileLists lists, LongList long_ones, Outcome* outcome) {
  if (outcome->stopped) return;
  const double reach_sq = cell_reach_sq<kTileSide>(l);
  const Counter count = *long_ones.count;
  for (Counter n = blockIdx.x; n < count; n += gridDim.x) {
    const std::uint32_t triangle = long_ones.triangles[n];
    const Corners c = corners_of(mesh, triangle);
    const CellRange r = tiles_of(l, c);
    const LongTriangle<kTileSide> long_triangle(l, r, c.at);
    const std::int64_t nx = r.high[0] - r.low[0] + 1, ny = r.high[1] - r.low[1] + 1, nz = r.high[2] - r.low[2] + 1;
    for (std::int64_t at = threadIdx.x; at < nx * ny * nz; at += blockDim.x) {
      const std::int64_t x = r.low[0] + at % nx, y = r.low[1] + at / nx % ny, z = r.low[2] + at / (nx * ny);
      if (long_triangle.reaches(l, x, y, z, reach_sq) && !use_tile<kPlace>(lists, l.tile(x, y, z), triangle))
        stop_for_miscount(outcome);
    }
  }
}

/// After the second pass: stops where it placed fewer triangles than were counted. The beginning of such a list was
/// never written, and what stands there may be no triangle. A thread a tile.
STANDOFF_KERNEL void check_lists(const std::uint32_t* counts, std::int64_t tiles, Outcome* outcome) {
  const std::int64_t tile = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (tile < tiles && !outcome->stopped && counts[tile] != 0) stop_for_miscount(outcome);
}

}  // namespace standoff::STANDOFF_PLATFORM
