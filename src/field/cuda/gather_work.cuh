// SPDX-License-Identifier: Apache-2.0
// The work items that the warps of `gather` take.
#pragma once

#include "field/cuda/bin.cuh"

namespace standoff::STANDOFF_PLATFORM {

// Items of work. The list of a tile with very many triangles, as on a coarse grid, is cut into parts, which several
// warps take at once. Most tiles have no triangle; in dense memory they are filled 32 at a time, which keeps the
// memory busy while other warps compute.

/// Cutting lists adds at most this many parts: enough for every warp of a GPU to have several, even if all triangles
/// lie in one tile. Decides no bit, and neither do the next two.
inline constexpr std::int64_t kMostParts = 16384;
/// A part has at least this many triangles: a warp stages so many at once.
inline constexpr Counter kLeastPart = 32;
/// At most so many lists are cut, as the results of each take 4 KiB of workspace.
inline constexpr std::int64_t kMostCut = kMostParts / 4;

inline constexpr std::uint32_t kWhole = 0xffffffffu;

/// A tile of the stack of fields (field_set.cuh) and a part of its list; or, without a list, which of the 32 tiles from
/// this one on along x are to be filled.
struct WorkItem {
  std::int64_t tile[3];
  Counter first;        // the first entry
  std::uint32_t count;  // the number of entries
  std::uint32_t cut;    // the number of the cut tile, or kWhole; without a list, a bit for each tile to fill
};

struct WorkCounts {
  Counter heavy, light;  // items of long and short lists, from the front and from the back of the array
  Counter cut;           // tiles whose list was cut
  Counter taken;         // items that warps have taken after their first one
  Counter longer[2];     // lists longer than least_part(), and than twice that
};

/// The least length of parts for so many entries. Fewer than kMostCut lists can be longer than four times that.
STANDOFF_DEVICE Counter least_part(Counter entries) {
  const Counter even = (entries + kMostParts - 1) / kMostParts;
  return even < kLeastPart ? kLeastPart : even;
}

struct GatherWork {
  WorkItem* items;
  std::int64_t capacity;  // the number of items that fit
  std::int64_t* cut_tiles;
  Counter* found;  // per sample of each cut tile: the best of its parts so far
  WorkCounts* counts;

  STANDOFF_DEVICE Counter size() const { return counts->heavy + counts->light; }
  /// The length of parts: as short as kMostCut allows.
  STANDOFF_DEVICE Counter part(Counter entries) const {
    const Counter least = least_part(entries);
    return counts->longer[0] <= kMostCut ? least : counts->longer[1] <= kMostCut ? 2 * least : 4 * least;
  }
  STANDOFF_DEVICE const WorkItem& at(Counter n) const {
    const Counter heavy = counts->heavy;
    return items[n < heavy ? static_cast<std::int64_t>(n) : capacity - 1 - static_cast<std::int64_t>(n - heavy)];
  }
};

/// The number of groups of 32 tiles along x.
template <class Fields>
STANDOFF_HD std::int64_t tile_groups(const Fields& fields) {
  return (fields.tiles(0) + 31) / 32 * fields.tiles(1) * fields.tiles(2);
}

/// After the second pass over the triangles: counts the long lists, and stops a field if it placed fewer triangles than
/// were counted: the beginning of such a list was never written, and may hold anything. A thread per tile.
template <class Fields>
STANDOFF_KERNEL void check_lists(Fields fields, TileLists lists, GatherWork work) {
  __shared__ unsigned longer[2];
  const std::int64_t index = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x, tiles = tile_count_of(fields);
  if (threadIdx.x < 2) longer[threadIdx.x] = 0;
  __syncthreads();
  if (index < tiles) {
    const Counter least = least_part(lists.start[tiles]), length = lists.start[index + 1] - lists.start[index];
    if (length > least) atomicAdd(&longer[0], 1u);
    if (length > 2 * least) atomicAdd(&longer[1], 1u);
    if (lists.counts[index] != 0 && !fields.total()->stopped) {
      std::int64_t tile[3];
      const std::int64_t number = find_tile(fields, index, tile);
      if (!fields.has_stopped_alone(number)) stop_for_miscount(fields.field(number).outcome);
    }
  }
  __syncthreads();
  if (threadIdx.x < 2 && longer[threadIdx.x] != 0)
    atomicAdd(&work.counts->longer[threadIdx.x], static_cast<Counter>(longer[threadIdx.x]));
}

/// Lists the items of all tiles: a thread per tile, a warp per group. Empty tiles get items only if they must be
/// filled. Lists of more than half a part come first, so that none is left when all others are done. The order of items
/// depends on the timing of threads, but no bit of the field does.
template <class Fields>
STANDOFF_KERNEL void list_work(Fields fields, const Counter* start, GatherWork work, bool fills) {
  if (fields.total()->stopped) return;
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const std::int64_t tiles = tile_count_of(fields), groups = (fields.tiles(0) + 31) / 32,
                     group = std::int64_t{blockIdx.x} * (blockDim.x / 32) + threadIdx.x / 32;
  if (group >= tile_groups(fields)) return;
  const std::int64_t x = group % groups * 32 + lane, row = group / groups, y = row % fields.tiles(1),
                     layer = row / fields.tiles(1), index = x + fields.tiles(0) * row;
  if (fields.has_stopped_alone(fields.field_of_layer(layer))) return;
  const bool exists = x < fields.tiles(0);
  const Counter first = exists ? start[index] : 0, count = exists ? start[index + 1] - first : 0;
  const Counter part = work.part(start[tiles]);
  WorkItem item{{x, y, layer}, first, static_cast<std::uint32_t>(count), kWhole};
  const std::uint32_t empty = __ballot_sync(0xffffffffu, fills && exists && count == 0);
  const bool fills_here = lane == 0 && empty != 0;
  // The light items of a warp take their places at once, together with the item that fills the group's empty tiles.
  const bool is_light = count > 0 && 2 * count <= part;
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

/// Fills the tiles of an item without a list with the value far from all triangles. All lanes take part: they fill a
/// row of samples through all of the tiles at once.
STANDOFF_DEVICE void fill_tiles(const Lattice& l, const WorkItem& item, const DeviceOutput& output) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const std::int64_t left = l.size[0] - item.tile[0] * kTileSide;
  const int width = left < 32 * kTileSide ? static_cast<int>(left) : 32 * kTileSide;
  for (int row = 0; row < kTileSide * kTileSide; ++row) {
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
