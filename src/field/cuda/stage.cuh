// SPDX-License-Identifier: Apache-2.0
// Triangles in shared memory, set up for the samples of one tile.
#pragma once

#include "field/cuda/corners.cuh"
#include "field/is_long.h"

namespace standoff::STANDOFF_PLATFORM {

/// The tile that triangles are set up for: what all threads of a block read.
struct TileView {
  std::int64_t tile[3];
  float coordinate[3][kTileSide];  // of its samples, relative to the brick's centre
  float to_samples[3];             // samples per grid unit
  int inside[3];                   // samples inside the grid
  Triple<double> center;           // of its brick
};

/// Fills the view of `tile`, with the first 24 threads of a block.
STANDOFF_DEVICE void view_tile(const Lattice& l, const std::int64_t* tile, TileView& view) {
  const int t = static_cast<int>(threadIdx.x);
  if (t >= 3 * kTileSide) return;
  const int axis = t / kTileSide, n = t % kTileSide;
  view.coordinate[axis][n] = l.coordinate[axis][static_cast<int>(tile[axis] & 1) * kTileSide + n];
  if (n == 0) {
    view.tile[axis] = tile[axis];
    view.to_samples[axis] = static_cast<float>(1 / l.unit[axis]);
    view.inside[axis] = inside<kTileSide>(l, tile, axis);
  }
  if (t == 0) view.center = brick_center(l, tile);
}
/// The same for the tile of that number.
STANDOFF_DEVICE void view_tile(const Lattice& l, std::int64_t index, TileView& view) {
  if (threadIdx.x >= 32) return;  // others need not divide
  std::int64_t tile[3];
  tile_at(l, index, tile);
  view_tile(l, tile, view);
}

/// One triangle ready to be measured to: a frame, or where it is long the lines of one. Eleven loads of 16 bytes, and
/// 44 words apart: loads by neighbouring threads of neighbouring triangles then never conflict in a bank of shared
/// memory.
struct alignas(16) Staged {
  float number[44];
};

template <class Setup, class Words>
STANDOFF_DEVICE void store(const Setup& setup, Words& to) {
  static_assert(sizeof setup <= sizeof to);
  __builtin_memcpy(&to, &setup, sizeof setup);
}
template <class Setup, class Words>
STANDOFF_DEVICE Setup load(const Words& from) {
  Setup setup;
  __builtin_memcpy(&setup, &from, sizeof setup);
  return setup;
}

struct Stage {
  static constexpr int kTriangles = 128;
  Staged setup[kTriangles];
  float slack[kTriangles];  // what a distance may be off by when tiles and blocks are culled
  std::uint32_t index[kTriangles];
  unsigned char is_long[kTriangles];
  float low[3][kTriangles], high[3][kTriangles];  // its box, relative to the brick's centre
};

/// The squared distance from p to staged triangle n.
STANDOFF_DEVICE float staged_distance_sq(const Stage& stage, int n, const Triple<float>& p) {
  if (stage.is_long[n]) return distance_sq(load<TriangleLines<float>>(stage.setup[n]), p);
  return distance_sq(load<TriangleFrame<float>>(stage.setup[n]), p);
}

/// Sets up a triangle relative to a brick's centre, exactly as the CPU does.
STANDOFF_DEVICE void set_up(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                            const Triple<double>& center, Stage& stage, int n) {
  const Corners c = corners_of(mesh, triangle);
  const Triple<double> a = local(l, c.at[0], center), b = local(l, c.at[1], center), d = local(l, c.at[2], center);
  const Triple<float> fa = narrowed(a), fb = narrowed(b), fd = narrowed(d);
  const BoxOf<float> box = box_of(fa, fb, fd);
  stage.index[n] = triangle;
  stage.slack[n] = fma(farthest_coordinate(box), kSlackOfCoordinate, kSlack);
  stage.is_long[n] = is_long(box);
  stage.low[0][n] = box.low.x, stage.low[1][n] = box.low.y, stage.low[2][n] = box.low.z;
  stage.high[0][n] = box.high.x, stage.high[1][n] = box.high.y, stage.high[2][n] = box.high.z;
  if (stage.is_long[n])
    store(make_lines<float>(make_frame(a, b, d, double{kLeastLengthSq})), stage.setup[n]);
  else
    store(make_frame(fa, fb, fd, float{kLeastLengthSq}), stage.setup[n]);
}

}  // namespace standoff::STANDOFF_PLATFORM
