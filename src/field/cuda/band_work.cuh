// SPDX-License-Identifier: Apache-2.0
// Thin bands: what the blocks of gather_band take, one item after the other, and how a warp stages the item's
// triangles.
#pragma once

#include "field/cuda/bin.cuh"
#include "field/cuda/gather.cuh"

namespace standoff::STANDOFF_PLATFORM {

// Items of work. A tile with very many triangles, as on a coarse
// grid, is worked on by several blocks at once: its list is cut into parts. Most tiles have none; in dense memory they
// are filled 32 at a time, which keeps the memory busy while other blocks compute.

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

// Up to 32 triangles in shared memory, set up for the samples of a tile by the lanes of a warp.
//
// A short triangle is measured to in the rows of samples that its box grown by the thickness reaches. The rows of all
// triangles of the warp are numbered through, and its lanes take them 32 at a time: so no lane waits for another
// triangle, however many rows each has.

/// A frame, five loads of 16 bytes. 20 words apart: loads from neighbouring triangles do not meet in a bank of shared
/// memory.
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

/// The rows of a staged triangle, in two words. At most 32 * 64 rows, 8 of each.
struct alignas(8) StagedRows {
  std::uint32_t number;  // of the first row, among all of the warp; above it 1024 / ny, rounded up
  std::uint32_t box;     // x, nx, y, ny, z: four bits each
};

/// n / ny is n * (1024 / ny, rounded up) / 1024: off by less than 64 / 1024 before truncation, so less than 1 / ny.
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
  int long_count;  // of the staged ones
};
static_assert(sizeof(StagedLines) * BandStage::kLong <= sizeof(StagedFrame) * BandStage::kShort);

/// The first sample at or above `low` and how many there are up to `high`, along an axis; 0 or fewer for none. Off by
/// the rounding of numbers that are not farther from the tile than a short triangle is: 1e-5 grid units at most, which
/// the bounds' margins hold.
STANDOFF_DEVICE void samples_between(const TileView& view, int axis, float low, float high, int& first, int& count) {
  const float past = static_cast<float>(view.inside[axis]);
  const float from = (low - view.coordinate[axis][0]) * view.to_samples[axis];
  const float to = (high - view.coordinate[axis][0]) * view.to_samples[axis];
  // By truncation of what is not negative.
  first = static_cast<int>(min(max(from + 1, 0.0f), past));
  count = static_cast<int>(min(max(to + 1, 0.0f), past)) - first;
}

/// The samples of the tile that the box of a triangle, grown by the thickness, may reach: no rows where there are none.
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

/// What a warp knows of the triangles it has staged.
struct Staged32 {
  std::uint32_t is_long;  // a bit for each lane whose triangle is long, and is not staged yet
  unsigned rows;          // of all others
};

/// A lane a triangle: stages the short ones that reach the tile, and their rows. `count` of the lanes have one. All
/// lanes take part.
STANDOFF_DEVICE Staged32 stage_short(const Lattice& l, const DeviceMesh& mesh, const TileView& view,
                                     std::uint32_t triangle, int count, BandStage& stage) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const std::uint32_t before = (1u << lane) - 1;
  bool is_long_one = false;
  int rows = 0;
  SampleBox box{};
  Triple<float> a{}, b{}, c{};
  if (lane < count) {
    const LocalCorners corners = local_corners(l, mesh, triangle, view.center);
    a = narrowed(corners.a), b = narrowed(corners.b), c = narrowed(corners.c);
    const BoxOf<float> around = box_of(a, b, c);
    is_long_one = is_long(around);
    if (!is_long_one) box = reached_samples(l, view, around);
    if (box.nx > 0 && box.ny > 0 && box.nz > 0) rows = box.ny * box.nz;
  }
  int through = rows;  // the rows up to this lane's
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
  // Lanes past the last one have rows that never begin.
  if (lane >= __popc(reaching)) stage.rows[lane].number = 0xffff;
  const Staged32 staged{__ballot_sync(0xffffffffu, is_long_one),
                        static_cast<unsigned>(__shfl_sync(0xffffffffu, through, 31))};
  __syncwarp();
  return staged;
}

/// Stages the first of the long triangles, up to BandStage::kLong, and returns how many. All lanes take part; no lane
/// may still read what is staged.
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
  const int all = __popc(is_long), count = all < BandStage::kLong ? all : BandStage::kLong;
  if (lane == 0) stage.long_count = count;
  __syncwarp();
  return count;
}

}  // namespace standoff::STANDOFF_PLATFORM
