// SPDX-License-Identifier: Apache-2.0
// Thin bands: what the blocks of gather_band take one after the other. A tile with very many triangles, as on a coarse
// grid, is worked on by several blocks at once: its list is cut into parts. Most tiles have none; in dense memory they
// are filled 32 at a time, which keeps the memory busy while other blocks compute.
#pragma once

#include "field/cuda/bin.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Lists are cut into parts of so many triangles that they make at most this many more than there are tiles: enough for
/// every multiprocessor to have many where all triangles lie in one tile. It is also how many tiles may be cut, and
/// each of them takes 4 KiB of workspace. Decides no bit.
inline constexpr std::int64_t kMostParts = 4096;
/// A part has this many triangles at least: one for each thread of a block.
inline constexpr Counter kLeastPart = 128;
/// Lists of more triangles are begun first, so that none of them is left when all others are done.
inline constexpr Counter kHeavyList = 512;

inline constexpr std::uint32_t kWhole = 0xffffffffu;

/// A tile, and a part of its list; or, without a list, the tiles to fill among the 32 from this one on along x.
struct WorkItem {
  std::int64_t tile[3];
  Counter first;        // entry
  std::uint32_t count;  // of entries
  std::uint32_t cut;    // which of the cut tiles, or kWhole; without a list, a bit for each tile to fill
};

struct WorkCounts {
  Counter heavy, light;  // items, from the front and from the back of the array
  Counter cut;           // tiles
  Counter taken;         // items
};

struct BandWork {
  WorkItem* items;
  std::int64_t capacity;  // of items
  std::int64_t* cut_tiles;
  Counter* found;  // per sample of each cut tile: what its parts have found
  std::int64_t most_cut;
  WorkCounts* counts;

  STANDOFF_DEVICE Counter size() const { return counts->heavy + counts->light; }
  STANDOFF_DEVICE const WorkItem& at(Counter n) const {
    const Counter heavy = counts->heavy;
    return items[n < heavy ? static_cast<std::int64_t>(n) : capacity - 1 - static_cast<std::int64_t>(n - heavy)];
  }
};

/// How many groups of 32 tiles along x there are.
STANDOFF_HD inline std::int64_t tile_groups(const Lattice& l) {
  return (l.tiles[0] + 31) / 32 * l.tiles[1] * l.tiles[2];
}

/// The items of all tiles, a thread a tile and a warp a group; empty tiles only where they are to be filled. The order
/// of items hangs on that of the threads, no bit on it.
STANDOFF_KERNEL void list_work(Lattice l, const Counter* start, BandWork work, bool fills, Outcome* outcome) {
  if (outcome->stopped) return;
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const std::int64_t tiles = l.tile_count(), groups = (l.tiles[0] + 31) / 32,
                     group = std::int64_t{blockIdx.x} * (blockDim.x / 32) + threadIdx.x / 32;
  if (group >= tile_groups(l)) return;
  const std::int64_t x = group % groups * 32 + lane, row = group / groups, index = x + l.tiles[0] * row;
  const bool exists = x < l.tiles[0];
  const Counter first = exists ? start[index] : 0, count = exists ? start[index + 1] - first : 0;
  const Counter total = start[tiles], even = (total + kMostParts - 1) / kMostParts,
                part = even < kLeastPart ? kLeastPart : even;
  WorkItem item{{x, row % l.tiles[1], row / l.tiles[1]}, first, static_cast<std::uint32_t>(count), kWhole};
  const std::uint32_t empty = __ballot_sync(0xffffffffu, fills && exists && count == 0);
  const bool fills_here = lane == 0 && empty != 0;
  // The light ones of a warp take their places at once, and with them the one that fills the group's empty tiles.
  const bool is_light = count > 0 && count <= kHeavyList && count <= part;
  const std::uint32_t light = __ballot_sync(0xffffffffu, is_light);
  Counter place = 0;
  if (lane == 0 && (light || fills_here))
    place = atomicAdd(&work.counts->light, static_cast<Counter>(__popc(light)) + (fills_here ? 1 : 0));
  place = __shfl_sync(0xffffffffu, place, 0) + static_cast<Counter>(__popc(light & ((1u << lane) - 1)));
  if (is_light) work.items[work.capacity - 1 - static_cast<std::int64_t>(place)] = item;
  if (fills_here)
    work.items[work.capacity - 1 - static_cast<std::int64_t>(place + static_cast<Counter>(__popc(light)))] = {
        {item.tile[0], item.tile[1], item.tile[2]}, 0, 0, empty};
  if (count == 0 || is_light) return;
  const Counter parts = (count + part - 1) / part;
  if (parts > 1) {
    item.cut = static_cast<std::uint32_t>(atomicAdd(&work.counts->cut, Counter{1}));
    work.cut_tiles[item.cut] = index;
  }
  place = atomicAdd(&work.counts->heavy, parts);
  for (Counter n = 0; n < parts; ++n) {
    const Counter left = count - n * part;
    item.first = first + n * part;
    item.count = static_cast<std::uint32_t>(left < part ? left : part);
    work.items[place + n] = item;
  }
}

/// Fills the tiles of an item without a list as where there is no triangle near. All threads of the block take part: a
/// warp a row of samples through all of the tiles.
STANDOFF_DEVICE void fill_tiles(const Lattice& l, const WorkItem& item, const DeviceOutput& output) {
  const int lane = static_cast<int>(threadIdx.x) % 32, warps = static_cast<int>(blockDim.x) / 32;
  const std::int64_t left = l.size[0] - item.tile[0] * kTileSide;
  const int width = left < 32 * kTileSide ? static_cast<int>(left) : 32 * kTileSide;
  for (int row = static_cast<int>(threadIdx.x) / 32; row < kTileSide * kTileSide; row += warps) {
    const std::int64_t y = item.tile[1] * kTileSide + row % kTileSide, z = item.tile[2] * kTileSide + row / kTileSide;
    if (y >= l.size[1] || z >= l.size[2]) continue;
    const std::int64_t at = item.tile[0] * kTileSide + l.size[0] * (y + l.size[1] * z);
    for (int x = lane; x < width; x += 32) {
      if (!(item.cut >> x / kTileSide & 1)) continue;
      output.values[at + x] = l.thickness_world;
      if (output.nearest) output.nearest[at + x] = kNoTriangle;
    }
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
