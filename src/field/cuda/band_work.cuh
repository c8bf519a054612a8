// SPDX-License-Identifier: Apache-2.0
// Thin bands: the work items that the warps of gather_band take, and how a warp stages an item's triangles.
#pragma once

#include "field/cuda/bin.cuh"
#include "field/cuda/gather.cuh"

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

struct BandWork {
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
STANDOFF_KERNEL void check_lists(Fields fields, TileLists lists, BandWork work) {
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
STANDOFF_KERNEL void list_work(Fields fields, const Counter* start, BandWork work, bool fills) {
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

// A warp stages up to 32 triangles: its lanes set them up for the samples of a tile, in shared memory.
//
// A short triangle is measured in the rows of samples that its box, grown by the thickness, reaches. The rows of all
// triangles of the warp are numbered consecutively, and its lanes take them 32 at a time: so no lane waits for another
// triangle, however many rows each has.

/// A frame takes five loads of 16 bytes. Frames are 20 words apart: loads from neighbouring triangles do not meet in a
/// bank of shared memory.
struct alignas(16) StagedFrame {
  float number[20];
};
struct alignas(16) StagedLines {
  float number[40];
};

/// Samples x to x + nx - 1 of the rows y to y + ny - 1 and z to z + nz - 1 of a tile.
struct SampleBox {
  int x, nx, y, ny, z, nz;
};

/// The rows of a staged triangle, in two words. A warp has at most 32 * 64 rows, of 8 samples each.
struct alignas(8) StagedRows {
  std::uint32_t number;  // low half: the first row among the warp's; high half: 1024 / ny, rounded up
  std::uint32_t box;     // x, nx, y, ny, z: four bits each
};

/// n / ny equals n * (1024 / ny, rounded up) / 1024, truncated: the error before is less than 64 / 1024, so below 1 /
/// ny.
STANDOFF_DEVICE StagedRows packed(const SampleBox& box, unsigned number) {
  const unsigned ny = static_cast<unsigned>(box.ny), inverse = (1023 + ny) / ny;
  return {number | inverse << 16,
          static_cast<std::uint32_t>(box.x | box.nx << 4 | box.y << 8 | box.ny << 12 | box.z << 16)};
}

struct BandStage {
  static constexpr int kShort = 32, kLong = 16;
  union {
    StagedFrame frame[kShort];
    StagedLines lines[kLong];
  };
  StagedRows rows[kShort];
  std::uint32_t triangle[kShort];
  float slack[kLong];
};
static_assert(sizeof(StagedLines) * BandStage::kLong <= sizeof(StagedFrame) * BandStage::kShort);

/// The first sample at or above `low` along an axis, and the number of samples up to `high`, which may be negative. The
/// error is the rounding of numbers no farther from the tile than a short triangle, at most 1e-5 grid units, which the
/// bounds' margins cover.
STANDOFF_DEVICE void samples_between(const TileView& view, int axis, float low, float high, int& first, int& count) {
  const float past = static_cast<float>(view.inside[axis]);
  const float from = (low - view.coordinate[axis][0]) * view.to_samples[axis];
  const float to = (high - view.coordinate[axis][0]) * view.to_samples[axis];
  // Truncation of numbers that are not negative rounds down.
  first = static_cast<int>(min(max(from + 1, 0.0f), past));
  count = static_cast<int>(min(max(to + 1, 0.0f), past)) - first;
}

/// The samples of the tile that the box of a triangle, grown by the thickness, may reach; no rows if there are none.
STANDOFF_DEVICE SampleBox reached_samples(const Lattice& l, const TileView& view, const BoxOf<float>& box) {
  const float slack = fma(farthest_coordinate(box), kSlackOfCoordinate, kSlack);
  const float reach = fma(l.thickness, 1 + kSlackRatio, slack);
  SampleBox s;
  samples_between(view, 0, box.low.x - reach, box.high.x + reach, s.x, s.nx);
  samples_between(view, 1, box.low.y - reach, box.high.y + reach, s.y, s.ny);
  samples_between(view, 2, box.low.z - reach, box.high.z + reach, s.z, s.nz);
  return s;
}

/// A triangle's corners relative to the brick's centre.
struct LocalCorners {
  Triple<double> a, b, c;
};
STANDOFF_DEVICE LocalCorners local_corners(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                                           const Triple<double>& center) {
  const Corners corners = corners_of(mesh, triangle);
  return {local(l, corners.at[0], center), local(l, corners.at[1], center), local(l, corners.at[2], center)};
}

/// The result of staging.
struct Staged32 {
  std::uint32_t is_long;  // a bit for each lane whose triangle is long, and is not staged yet
  unsigned rows;          // the rows of all other triangles
};

/// Stages the short triangles that reach the tile, and their rows: a lane per triangle, where it has one. All lanes
/// take part.
STANDOFF_DEVICE Staged32 stage_short(const Lattice& l, const DeviceMesh& mesh, const TileView& view,
                                     std::uint32_t triangle, bool has_one, BandStage& stage) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const std::uint32_t before = (1u << lane) - 1;
  bool is_long_one = false;
  int rows = 0;
  SampleBox box{};
  Triple<float> a{}, b{}, c{};
  if (has_one) {
    const LocalCorners corners = local_corners(l, mesh, triangle, view.center);
    a = narrowed(corners.a), b = narrowed(corners.b), c = narrowed(corners.c);
    const BoxOf<float> around = box_of(a, b, c);
    is_long_one = is_long(around);
    if (!is_long_one) box = reached_samples(l, view, around);
    if (box.nx > 0 && box.ny > 0 && box.nz > 0) rows = box.ny * box.nz;
  }
  int through = rows;  // the rows up to and including this lane's
  for (int step = 1; step < 32; step *= 2) {
    const int other = __shfl_sync(0xffffffffu, through, lane - step);
    if (lane >= step) through += other;
  }
  const std::uint32_t reaching = __ballot_sync(0xffffffffu, rows > 0);
  if (rows > 0) {
    const int n = __popc(reaching & before);
    store(make_frame(a, b, c, float{kLeastLengthSq}), stage.frame[n]);
    stage.rows[n] = packed(box, static_cast<unsigned>(through - rows));
    stage.triangle[n] = triangle;
  }
  // The rows of lanes past the last triangle never begin.
  if (lane >= __popc(reaching)) stage.rows[lane].number = 0xffff;
  const Staged32 staged{__ballot_sync(0xffffffffu, is_long_one),
                        static_cast<unsigned>(__shfl_sync(0xffffffffu, through, 31))};
  __syncwarp();
  return staged;
}

/// Stages the first long triangles, up to BandStage::kLong, and returns their number. All lanes take part; no lane may
/// still read the stage.
STANDOFF_DEVICE int stage_long(const Lattice& l, const DeviceMesh& mesh, const TileView& view, std::uint32_t triangle,
                               std::uint32_t is_long, BandStage& stage) {
  const int lane = static_cast<int>(threadIdx.x) % 32, n = __popc(is_long & ((1u << lane) - 1));
  if ((is_long >> lane & 1) && n < BandStage::kLong) {
    const auto [a, b, c] = local_corners(l, mesh, triangle, view.center);
    const BoxOf<float> box = box_of(narrowed(a), narrowed(b), narrowed(c));
    stage.slack[n] = fma(farthest_coordinate(box), kSlackOfCoordinate, kSlack);
    store(make_lines<float>(make_frame(a, b, c, double{kLeastLengthSq})), stage.lines[n]);
    stage.triangle[n] = triangle;
  }
  const int all = __popc(is_long);
  __syncwarp();
  return all < BandStage::kLong ? all : BandStage::kLong;
}

}  // namespace standoff::STANDOFF_PLATFORM
