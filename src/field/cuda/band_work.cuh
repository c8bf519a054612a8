// SPDX-License-Identifier: Apache-2.0
// Thin bands: what the blocks of gather_band take one after the other. Most tiles have no triangle, and get no block. A
// tile with very many, as on a coarse grid, is worked on by several blocks at once: its list is cut into parts.
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

/// A tile, and a part of its list.
struct WorkItem {
  std::int64_t tile[3];
  Counter first;        // entry
  std::uint32_t count;  // of entries
  std::uint32_t cut;    // which of the cut tiles, or kWhole
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

/// The items of all tiles with triangles, a thread a tile. Their order hangs on that of the threads, no bit on it.
STANDOFF_KERNEL void list_work(Lattice l, const Counter* start, BandWork work, Outcome* outcome) {
  if (outcome->stopped) return;
  const std::int64_t tiles = l.tile_count(), index = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  const Counter first = index < tiles ? start[index] : 0, count = index < tiles ? start[index + 1] - first : 0;
  const Counter total = start[tiles], even = (total + kMostParts - 1) / kMostParts,
                part = even < kLeastPart ? kLeastPart : even;
  WorkItem item{{}, first, static_cast<std::uint32_t>(count), kWhole};
  if (count > 0) tile_at(l, index, item.tile);
  // The light ones of a warp take their places at once.
  const bool is_light = count > 0 && count <= kHeavyList && count <= part;
  const std::uint32_t light = __ballot_sync(0xffffffffu, is_light);
  const int lane = static_cast<int>(threadIdx.x) % 32;
  Counter place = 0;
  if (lane == 0 && light) place = atomicAdd(&work.counts->light, static_cast<Counter>(__popc(light)));
  place = __shfl_sync(0xffffffffu, place, 0) + static_cast<Counter>(__popc(light & ((1u << lane) - 1)));
  if (is_light) work.items[work.capacity - 1 - static_cast<std::int64_t>(place)] = item;
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

/// Every sample of a dense field as where there is no triangle near. Threads stride over the samples.
STANDOFF_KERNEL void fill_outside(Lattice l, DeviceOutput output, Outcome* outcome) {
  if (outcome->stopped) return;
  const std::int64_t samples = l.size[0] * l.size[1] * l.size[2], step = std::int64_t{gridDim.x} * blockDim.x;
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < samples; n += step) {
    output.values[n] = l.thickness_world;
    if (output.nearest) output.nearest[n] = kNoTriangle;
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
