// SPDX-License-Identifier: Apache-2.0
// Thin bands: a short triangle is measured in the rows of samples that its box, grown by the thickness, reaches.
//
// The rows of all 32 triangles of a warp are numbered consecutively, and its lanes take them 32 at a time: so no lane
// waits for another triangle, however many rows each has. Along a row two thirds of the linear functions of the frame
// stay the same, and no lane measures beyond the triangle's reach.
#pragma once

#include "field/cuda/gather.cuh"

namespace standoff::STANDOFF_PLATFORM {

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

struct RowStage : CommonStage {
  union {  // of short triangles, then of long ones
    StagedRows rows[kShort];
    LongPair long_pair[kLongPairs];
  };
  float slack[kLong];

  STANDOFF_DEVICE void bound_long(int n, const BoxOf<float>& box) {
    slack[n] = distance_slack(farthest_coordinate(box));
  }
};

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
  const float reach = fma(l.thickness, 1 + kSlackRatio, distance_slack(farthest_coordinate(box)));
  SampleBox s;
  samples_between(view, 0, box.low.x - reach, box.high.x + reach, s.x, s.nx);
  samples_between(view, 1, box.low.y - reach, box.high.y + reach, s.y, s.ny);
  samples_between(view, 2, box.low.z - reach, box.high.z + reach, s.z, s.nz);
  return s;
}

/// The result of staging.
struct Staged32 {
  std::uint32_t is_long;  // a bit for each lane whose triangle is long, and is not staged yet
  unsigned rows;          // the rows of all other triangles
};

/// Stages the short triangles that reach the tile, and their rows: a lane per triangle, where it has one. All lanes
/// take part.
STANDOFF_DEVICE Staged32 stage_short(const Lattice& l, const DeviceMesh& mesh, const TileView& view,
                                     std::uint32_t triangle, bool has_one, RowStage& stage) {
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

/// Measures from a row of samples to a staged triangle; returns the number of samples.
template <class Steps, class Tile>
STANDOFF_DEVICE unsigned measure_row(int n, unsigned row, Tile& tile) {
  const StagedRows rows = tile.stage.rows[n];
  const int x = static_cast<int>(rows.box & 15), nx = static_cast<int>(rows.box >> 4 & 15),
            ny = static_cast<int>(rows.box >> 12 & 15);
  if constexpr (Steps::kMeasures) {
    const int of_triangle = static_cast<int>(row - (rows.number & 0xffff));
    const int deep = of_triangle * static_cast<int>(rows.number >> 16) >> 10;
    const int y = static_cast<int>(rows.box >> 8 & 15) + of_triangle - deep * ny,
              z = static_cast<int>(rows.box >> 16) + deep;
    const RowDistance distance(tile, n, y, z);
    const std::uint32_t triangle = Tile::kWithNearest ? tile.stage.triangle[n] : 0;
    const float* px = tile.view.coordinate[0] + x;
    auto* at = tile.found + found_at(x, y, z);
    for (int left = nx; left > 0; --left, ++px, ++at)
      lower(at, found<Tile::kWithNearest>(distance.squared(*px), triangle));
  }
  return static_cast<unsigned>(nx);
}

/// Measures the staged short triangles, which have `count` rows. All lanes take part; each returns the number of
/// samples that it measured from.
template <class Steps, class Tile>
STANDOFF_DEVICE unsigned gather_rows(unsigned count, Tile& tile) {
  const unsigned lane = threadIdx.x % 32;
  const unsigned first_row = tile.stage.rows[lane].number & 0xffff;  // the first row of this lane's triangle
  unsigned measured = 0;
  int begun = 0;  // the number of triangles whose rows begin before `first`
  for (unsigned first = 0; first < count; first += 32) {
    const unsigned ahead = first_row - first;
    const std::uint32_t begin = warp_or(ahead < 32 ? 1u << ahead : 0);
    const int n = begun + __popc(begin & (0xffffffffu >> (31 - lane))) - 1;
    begun += __popc(begin);
    if (first + lane < count) measured += measure_row<Steps>(n, first + lane, tile);
  }
  return measured;
}

template <class WayOfSteps>
struct ByRows {
  using Steps = WayOfSteps;
  using Stage = RowStage;

  template <class Tile>
  STANDOFF_DEVICE void begin(const Lattice&, const DeviceMesh&, Tile&) const {}

  /// Sets up the triangles of the lanes that have one, and measures the short ones that reach the tile; adds the number
  /// of samples to `measured`. Returns a bit for each lane with a long triangle. All lanes take part.
  template <class Tile>
  static STANDOFF_DEVICE std::uint32_t gather_short(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                                                    bool has_one, Tile& tile, unsigned& measured) {
    const Staged32 staged = stage_short(l, mesh, tile.view, triangle, has_one, tile.stage);
    if constexpr (Steps::kFindsRows)
      measured += gather_rows<Steps>(staged.rows, tile);
    else
      measured += Steps::uses(tile.stage.frame[threadIdx.x % 32].number[staged.rows % 20]);
    return staged.is_long;
  }

  /// A group of samples, which a triangle may reach.
  struct Group {
    Triple<float> center;
    float within;

    template <class Tile>
    STANDOFF_DEVICE Group(const Lattice& l, const Tile& tile, int group)
        : center(group_center(tile.view, group)), within(l.thickness * (1 + kSlackRatio) + group_extent(l).radius) {}
    /// `least`: no more than the distance of a staged triangle from the centre.
    STANDOFF_DEVICE bool keeps(const Stage&, int, float least) const { return least <= within; }
  };
};

}  // namespace standoff::STANDOFF_PLATFORM
