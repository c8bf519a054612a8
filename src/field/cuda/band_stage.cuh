// SPDX-License-Identifier: Apache-2.0
// Thin bands: up to 32 triangles in shared memory, set up for the samples of a tile by the lanes of a warp.
//
// A short triangle is measured to in the rows of samples that its box grown by the thickness reaches. The rows of all
// triangles of the warp are numbered through, and its lanes take them 32 at a time: so no lane waits for another
// triangle, however many rows each has.
#pragma once

#include "field/cuda/stage.cuh"

namespace standoff::STANDOFF_PLATFORM {

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
