// SPDX-License-Identifier: Apache-2.0
// For thin bands, lists the triangles of each tile. Small kernels record the outcome and give tiles their slots.
#pragma once

#include "field/cuda/field_set.cuh"
#include "field/lattice.h"
#include "geometry/triangle_box.h"
#include "geometry/triangle_frame.h"
#include "gpu/mesh.cuh"
#include "gpu/platform.cuh"
#include "gpu/scan.h"

namespace standoff::STANDOFF_PLATFORM {

/// Called if the second pass over the triangles needs more or fewer entries than the first one counted. Both compute
/// the same, so the mesh was written meanwhile.
STANDOFF_DEVICE void stop_for_miscount(Outcome* outcome) {
  atomicOr(&outcome->needed_entries, Counter{Outcome::kNone});  // many threads may write it
  stop(outcome);
}

// Thin bands: lists the triangles of each tile, by counting. A triangle belongs to the tiles that its box, grown by the
// thickness, touches. If it touches more than two tiles along an axis, it is measured from their centres, exactly: by
// one lane or several, by a warp if it touches many tiles, by several warps if it touches very many.

/// Threads of a block, unless a kernel needs another number.
inline constexpr unsigned kThreads = 256;

/// The tiles with samples in the triangle's grown box.
STANDOFF_DEVICE CellRange tiles_of(const Lattice& l, const Corners& c) {
  return reached_cells<kTileSide>(l, box_of(c.at[0], c.at[1], c.at[2]));
}

/// The triangles of each tile: entries[start[tile]] to entries[start[tile + 1] - 1].
struct TileLists {
  std::uint32_t* counts;   // per tile, and a zero behind the last
  Counter* start;          // has the same length
  std::uint32_t* entries;  // triangles
  Counter capacity;        // the number of entries that fit
};

/// The numbers, among the triangles of all fields, of those that touch many tiles, from the front of the array; of
/// those that touch very many, from its back.
struct LongList {
  std::uint32_t* numbers;
  Counter* count;  // two numbers, one for each kind
  std::int64_t capacity;
};

/// If a triangle's box holds more tiles than this, kWarpsPerHuge warps share it. Decides no bit. Every warp sets up its
/// triangle, which takes as long as some 200 tiles. Smaller: the shares cost more than they save. Larger: a triangle
/// across a fine grid keeps one warp busy while all others are done.
inline constexpr std::int64_t kHugeRange = 1024;
inline constexpr int kWarpsPerHuge = 32;

/// The number of tiles of a range.
STANDOFF_DEVICE std::int64_t tiles_in(const CellRange& r) {
  return (r.high[0] - r.low[0] + 1) * (r.high[1] - r.low[1] + 1) * (r.high[2] - r.low[2] + 1);
}
/// Lists the triangles that touch many tiles. All lanes take part, each with its own triangle, or with none.
STANDOFF_DEVICE void list_long(const LongList& list, const CellRange& r, bool has_one, std::int64_t n) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const bool is_huge = has_one && tiles_in(r) > kHugeRange;
  for (int huge_ones = 0; huge_ones < 2; ++huge_ones) {
    const bool mine = has_one && is_huge == (huge_ones != 0);
    const std::uint32_t all = __ballot_sync(0xffffffffu, mine);
    if (all == 0) continue;
    Counter first = 0;
    if (lane == 0) first = atomicAdd(&list.count[huge_ones], static_cast<Counter>(__popc(all)));
    const auto place = static_cast<std::int64_t>(__shfl_sync(0xffffffffu, first, 0)) + __popc(all & ((1u << lane) - 1));
    if (mine) list.numbers[huge_ones ? list.capacity - 1 - place : place] = static_cast<std::uint32_t>(n);
  }
}

/// No list is this long: a count from here on has wrapped below zero.
inline constexpr std::uint32_t kNoCount = 0xf0000000u;

/// First pass: counts. Second pass: fills the lists from their ends, and takes the counts back down to zero. False if
/// the entry would lie in front of the list.
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

/// The same for all lanes of a warp at once, each with its own tile, or -1 for none. Neighbouring triangles often lie
/// in the same tile: then one atomic operation serves all of them.
template <bool kPlace>
STANDOFF_DEVICE bool use_tiles(const TileLists& lists, std::int64_t tile, std::uint32_t triangle) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const std::uint32_t same = __match_any_sync(0xffffffffu, static_cast<Counter>(tile));
  const int leader = __ffs(static_cast<int>(same)) - 1;
  const auto wanted = static_cast<std::uint32_t>(__popc(same));
  std::uint32_t before = 0;
  if (lane == leader && tile >= 0) {
    if (kPlace)
      before = atomicSub(&lists.counts[tile], wanted);
    else
      atomicAdd(&lists.counts[tile], wanted);
  }
  if (!kPlace) return true;
  before = __shfl_sync(0xffffffffu, before, leader);
  if (tile < 0) return true;
  const std::uint32_t place = before - 1 - static_cast<std::uint32_t>(__popc(same & ((1u << lane) - 1)));
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

/// Bins short triangles, a thread per triangle. The first pass also lists the long ones.
template <bool kPlace, class Fields>
STANDOFF_KERNEL void __launch_bounds__(kThreads, kBinBlocks)
    bin_small(typename Fields::Lattices lattices, Fields fields, TileLists lists, LongList long_ones) {
  if (kPlace && __ballot_sync(0xffffffffu, fields.total()->stopped != 0) != 0) return;  // the warp must stay together
  const std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  CellRange r{{0, 0, 0}, {-1, -1, -1}};
  std::uint32_t triangle = 0;
  const std::int64_t number = fields.warp_field_of(n < fields.triangle_count() ? n : 0);
  if (n < fields.triangle_count()) {
    const auto& f = fields.field(number);
    triangle = fields.triangle(number, n);
    // The first pass looks at all triangles of a mesh, even if it has stopped: the first bad one is to be named.
    if (kPlace ? !fields.has_stopped_alone(number) : fields.has_place(number) && is_valid(f.mesh, triangle, f.outcome))
      r = tiles_of(fields.lattice(lattices, number), corners_of(f.mesh, triangle));
  }
  const bool places = !r.empty() && r.is_small();
  if (!kPlace) list_long(long_ones, r, !r.empty() && !r.is_small(), n);
  bool fits = true;
  for (int corner = 0; corner < 8; ++corner) {  // all lanes of the warp, whatever their ranges
    const std::int64_t x = r.low[0] + (corner & 1), y = r.low[1] + (corner >> 1 & 1), z = r.low[2] + (corner >> 2);
    const bool mine = places && x <= r.high[0] && y <= r.high[1] && z <= r.high[2];
    if (__ballot_sync(0xffffffffu, mine) != 0)
      fits &= use_tiles<kPlace>(lists, mine ? fields.tile(number, x, y, z) : -1, triangle);
  }
  if (!fits) stop_for_miscount(fields.field(number).outcome);
}

/// Bins a listed long triangle into the tiles of its range that it reaches: tile `share`, and each `shares`-th one on.
template <bool kPlace, class Fields>
STANDOFF_DEVICE void bin_share(const typename Fields::Lattices& lattices, const Fields& fields, const TileLists& lists,
                               std::uint32_t listed, int share, int shares) {
  const std::int64_t number = fields.field_of(listed);
  if (fields.has_stopped_alone(number)) return;
  const Lattice& l = fields.lattice(lattices, number);
  const auto& f = fields.field(number);
  const std::uint32_t triangle = fields.triangle(number, listed);
  const Corners c = corners_of(f.mesh, triangle);
  const CellRange r = tiles_of(l, c);
  if (r.empty()) return;
  const LongTriangle<kTileSide> long_triangle(l, r, c.at);
  const double reach_sq = cell_reach_sq<kTileSide>(l);
  const std::int64_t nx = r.high[0] - r.low[0] + 1, ny = r.high[1] - r.low[1] + 1, all = tiles_in(r);
  for (std::int64_t at = share; at < all; at += shares) {
    const std::int64_t x = r.low[0] + at % nx, y = r.low[1] + at / nx % ny, z = r.low[2] + at / (nx * ny);
    if (long_triangle.reaches(l, x, y, z, reach_sq) && !use_tile<kPlace>(lists, fields.tile(number, x, y, z), triangle))
      stop_for_miscount(f.outcome);
  }
}

/// A lane tests at most so many tiles of a triangle that it does not share with its whole warp. Decides no bit.
inline constexpr int kTilesPerLane = 16;

/// The number of lanes that share a long triangle, a power of two: all of a warp if there are few triangles, or else
/// only so many that a quarter of the warps have work. For each lane sets the triangle up anew.
STANDOFF_DEVICE int lanes_per_long(Counter triangles, Counter warps) {
  int lanes = 32;
  while (lanes > 1 && 4 * triangles >= warps * static_cast<Counter>(64 / lanes)) lanes /= 2;
  return lanes;
}

/// Bins long triangles: warps stride over the shares of the huge ones, which take longest, and then over all others.
template <bool kPlace, class Fields>
STANDOFF_KERNEL void __launch_bounds__(kThreads)
    bin_long(typename Fields::Lattices lattices, Fields fields, TileLists lists, LongList long_ones) {
  if (__ballot_sync(0xffffffffu, fields.total()->stopped != 0) != 0) return;  // the warp must stay together
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const Counter first = std::int64_t{blockIdx.x} * (blockDim.x / 32) + threadIdx.x / 32,
                step = std::int64_t{gridDim.x} * (blockDim.x / 32);
  const Counter count = long_ones.count[0], huge_shares = long_ones.count[1] * kWarpsPerHuge;
  const int lanes = lanes_per_long(count, step);
  const auto each = static_cast<Counter>(32 / lanes);  // triangles of a warp
  for (Counter n = first; n < huge_shares + (count + each - 1) / each; n += step) {
    const bool is_huge = n < huge_shares;
    const Counter mine = is_huge ? n / kWarpsPerHuge : (n - huge_shares) * each + static_cast<Counter>(lane / lanes);
    const bool exists = is_huge || mine < count;
    const std::uint32_t own = long_ones.numbers[is_huge  ? long_ones.capacity - 1 - static_cast<std::int64_t>(mine)
                                                : exists ? mine
                                                         : 0];
    std::uint32_t listed = own;
    int share = is_huge ? static_cast<int>(n % kWarpsPerHuge) * 32 + lane : lane % lanes;
    int shares = is_huge ? kWarpsPerHuge * 32 : lanes;
    // A triangle with too many tiles for its lanes is the whole warp's, once the lanes have binned their own.
    const std::int64_t number = fields.field_of(own);
    const Corners c = corners_of(fields.field(number).mesh, fields.triangle(number, own));
    const bool is_wide = exists && !is_huge &&
                         tiles_in(tiles_of(fields.lattice(lattices, number), c)) > std::int64_t{kTilesPerLane} * lanes;
    std::uint32_t wide = __ballot_sync(0xffffffffu, is_wide && share == 0);
    for (bool takes_part = exists && !is_wide;; takes_part = true) {
      if (takes_part) bin_share<kPlace>(lattices, fields, lists, listed, share, shares);
      if (wide == 0) break;
      listed = __shfl_sync(0xffffffffu, own, __ffs(static_cast<int>(wide)) - 1);
      share = lane, shares = 32;
      wide &= wide - 1;
    }
  }
}

STANDOFF_KERNEL void clear_outcome(Outcome* outcome, Counter* counters, int count) {
  *outcome = no_outcome();
  for (int n = 0; n < count; ++n) counters[n] = 0;
}

/// Stops all later kernels if the lists do not fit.
STANDOFF_KERNEL void check_entries(const Counter* total, Counter capacity, Outcome* outcome) {
  if (*total > outcome->needed_entries) outcome->needed_entries = *total;
  if (*total > capacity) stop(outcome);
}

/// Writes 1 for each tile with triangles, 0 for the others, and 0 behind the last.
STANDOFF_KERNEL void mark_used_tiles(const Counter* start, std::int64_t tiles, std::uint32_t* used) {
  const std::int64_t tile = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (tile <= tiles) used[tile] = tile < tiles && start[tile + 1] > start[tile];
}

/// Writes each tile's slot, or -1, from the running sum of `used`, if there are slots for all. A thread per tile.
STANDOFF_KERNEL void give_slots(const std::uint32_t* used, const Counter* rank, std::int64_t tiles, DeviceOutput output,
                                Outcome* outcome) {
  const std::int64_t tile = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (tile > tiles) return;
  const Counter needed = rank[tiles];
  const bool fits = needed <= static_cast<Counter>(output.slot_capacity);
  if (tile == tiles) {
    outcome->needed_slots = needed;
    if (!fits) stop(outcome);
    return;
  }
  if (!fits || outcome->stopped) return;
  output.slots[tile] = used[tile] ? static_cast<std::int32_t>(rank[tile]) : -1;
}

}  // namespace standoff::STANDOFF_PLATFORM
