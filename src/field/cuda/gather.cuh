// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields: a block of threads per tile. Each thread holds a sample in registers, all triangles of
// the tile pass through shared memory, and each sample is written once. (Thin bands: gather_band.cuh.)
//
// A warp holds 4x4x2 samples. Before it measures, its lanes compare 32 triangles with the centre of these samples, one
// each, and a vote keeps the triangles that may be nearer than the samples' best. So all lanes measure the same
// triangle (one read for all), and triangles far from all 32 samples are skipped. Skipping them changes no bit.
#pragma once

#include "field/cuda/bin.cuh"
#include "field/tolerances.h"
#include "gpu/warp.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// The tile of a block, in shared memory.
struct TileView {
  std::int64_t tile[3];
  float coordinate[3][kTileSide];  // the samples, relative to the brick's centre
  float to_samples[3];             // samples per grid unit
  int inside[3];                   // samples inside the grid
  Triple<double> center;           // the brick's centre
};

/// Thread t fills its part of the view of `tile`: 24 threads fill all of it.
STANDOFF_DEVICE void view_tile(const Lattice& l, const std::int64_t* tile, int t, TileView& view) {
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
/// The same for the tile number `index`.
STANDOFF_DEVICE void view_tile(const Lattice& l, std::int64_t index, TileView& view) {
  if (threadIdx.x >= 32) return;  // saves the other warps the division
  std::int64_t tile[3];
  tile_at(l, index, tile);
  view_tile(l, tile, static_cast<int>(threadIdx.x), view);
}

/// A triangle that is set up: its frame, or its lines if it is long. It takes eleven loads of 16 bytes. Triangles are
/// 44 words apart: so loads by neighbouring threads of neighbouring triangles never conflict in a bank of shared
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
  float slack[kTriangles];  // the error of a distance, for culling
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
  Triple<float> fa = narrowed(a), fb = narrowed(b), fd = narrowed(d);
  BoxOf<float> box = box_of(fa, fb, fd);
  if (is_speck(l, box)) {
    fa = fb = fd = middle_of(box);
    box = box_of(fa, fa, fa);
  }
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

inline constexpr int kGatherThreads = kTileSamples;
inline constexpr int kWarps = kGatherThreads / 32;
static_assert(Stage::kTriangles <= kGatherThreads && Stage::kTriangles % 32 == 0);

/// The sample of a tile that a thread holds: a warp has 4x4x2 samples, a tile 2x2x4 warps.
struct SampleAt {
  int x, y, z;
};
STANDOFF_DEVICE SampleAt sample_of_thread(int thread) {
  const int warp = thread / 32, lane = thread % 32;
  return {(warp & 1) * 4 + (lane & 3), (warp >> 1 & 1) * 4 + (lane >> 2 & 3), (warp >> 2) * 2 + (lane >> 4)};
}
/// The extent of a warp's samples along each axis, and half their diagonal, rounded up. Grid units.
struct WarpExtent {
  float width[3], radius;
};
STANDOFF_DEVICE WarpExtent warp_extent(const Lattice& l) {
  WarpExtent e{{static_cast<float>(3 * l.unit[0]), static_cast<float>(3 * l.unit[1]), static_cast<float>(l.unit[2])},
               0};
  const float x = e.width[0] / 2, y = e.width[1] / 2, z = e.width[2] / 2;
  e.radius = sqrt(x * x + y * y + z * z) * (1 + kSlackRatio);
  return e;
}

/// The best of a sample so far.
struct Nearest {
  float distance_sq;
  std::uint32_t triangle;
};

/// Measures from a sample to the staged triangles first + n for all bits n that are set in `left`.
template <bool kNearest>
STANDOFF_DEVICE void measure(const Stage& stage, int first, std::uint32_t left, const Triple<float>& sample,
                             Nearest& best) {
  for (; left; left &= left - 1) {
    const int n = first + __ffs(static_cast<int>(left)) - 1;
    const float d = staged_distance_sq(stage, n, sample);
    if (kNearest) {
      const std::uint32_t triangle = stage.index[n];
      if (d < best.distance_sq || (d == best.distance_sq && triangle < best.triangle)) best.triangle = triangle;
    }
    best.distance_sq = min(d, best.distance_sq);
  }
}

/// The samples of a warp, and the point of the mesh nearest to their centre so far.
struct WarpSamples {
  Triple<float> center;
  Triple<float> surface;
  float within;  // bounds the distance of `surface` from the centre; infinite if no point is known
};

/// Whether triangle n may be nearer than the point `surface` to one of the warp's samples. `least` is a lower bound of
/// its distance from their centre. (This is the test `bisector` of cell_hierarchy.cuh; the warp's samples are the
/// child.)
STANDOFF_DEVICE bool may_be_nearest(const WarpExtent& extent, const Stage& stage, int n, float least,
                                    const WarpSamples& warp) {
  const Triple<float>& q = warp.surface;
  float spread = extent.width[0] * max(stage.high[0][n] - q.x, q.x - stage.low[0][n]);
  spread = fma(extent.width[1], max(stage.high[1][n] - q.y, q.y - stage.low[1][n]), spread);
  spread = fma(extent.width[2], max(stage.high[2][n] - q.z, q.z - stage.low[2][n]), spread);
  const float within = warp.within * (1 + kBisectorSlack);
  return fma(least, least, -spread) < within * within;
}

/// Updates the warp's nearest point by the 32 staged triangles from `first` on, one per lane: `most` bounds the
/// distance of the lane's triangle. All lanes take part.
STANDOFF_DEVICE void find_surface(const Stage& stage, int first, float most, WarpSamples& warp) {
  float nearest = most;
  for (int bits = 16; bits > 0; bits /= 2) nearest = min(nearest, __shfl_xor_sync(0xffffffffu, nearest, bits));
  const std::uint32_t which = __ballot_sync(0xffffffffu, most == nearest);
  if (!(nearest < warp.within)) return;
  warp.within = nearest;
  const int n = first + __ffs(static_cast<int>(which)) - 1;
  warp.surface = closest_in_frame(load<TriangleFrame<float>>(stage.setup[n]), warp.center);
}

/// Measures from a warp's samples to the staged triangles that its vote keeps, of `count`. Returns how many were
/// measured.
template <bool kNearest>
STANDOFF_DEVICE int gather_stage(const Lattice& l, const WarpExtent& extent, const Stage& stage, int count,
                                 const Triple<float>& sample, bool in_grid, float known_within, WarpSamples& warp,
                                 Nearest& best) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  int measured = 0;
  for (int first = 0; first < count; first += 32) {
    const int mine = first + lane;
    const bool exists = mine < count;
    const float d = exists ? sqrt(staged_distance_sq(stage, mine, warp.center)) : 0;
    const float slack = exists ? stage.slack[mine] : 0;
    find_surface(stage, first, exists && !stage.is_long[mine] ? d + slack : __builtin_inff(), warp);
    // Samples past the grid must not keep triangles.
    const float worst = sqrt(warp_max(in_grid ? best.distance_sq : 0));
    const float within = min(l.thickness, min(worst, known_within)) * (1 + kSlackRatio) + extent.radius;
    const float least = max(d - slack, 0.0f);
    const bool is_near = exists && least <= within && may_be_nearest(extent, stage, mine, least, warp);
    const std::uint32_t left = __ballot_sync(0xffffffffu, is_near);
    measured += __popc(left);
    measure<kNearest>(stage, first, left, sample, best);
  }
  return measured;
}

/// A tile's finished samples, x fastest, before they are written in rows.
struct Finished {
  float value[kTileSamples];
  std::uint32_t nearest[kTileSamples];
  unsigned band, measured;  // samples in the band; triangles measured, summed over the warps
};

/// Writes a tile to its slot, or to its place in the dense grid. All threads of the block take part.
STANDOFF_DEVICE void write_tile(const Lattice& l, const TileView& view, std::int64_t index, const Finished& finished,
                                const DeviceOutput& output) {
  const int t = static_cast<int>(threadIdx.x);
  std::int64_t at;
  if (output.slots) {
    at = std::int64_t{output.slots[index]} * kTileSamples + t;
  } else {
    const int x = t % 8, y = t / 8 % 8, z = t / 64;
    if (x >= view.inside[0] || y >= view.inside[1] || z >= view.inside[2]) return;
    at = view.tile[0] * 8 + x + l.size[0] * (view.tile[1] * 8 + y + l.size[1] * (view.tile[2] * 8 + z));
  }
  output.values[at] = finished.value[t];
  if (output.nearest) output.nearest[at] = finished.nearest[t];
}

/// Clamps the samples, stores them in `finished`, and writes the tile. A sparse field does not store a tile without a
/// band sample. All threads of the block take part.
STANDOFF_DEVICE void finish_tile(const Lattice& l, const TileView& view, std::int64_t index, const SampleAt& at,
                                 float value, std::uint32_t nearest, bool is_band, Finished& finished,
                                 const DeviceOutput& output, Outcome* outcome) {
  const int t = at.x + 8 * at.y + 64 * at.z;
  finished.value[t] = value;
  finished.nearest[t] = nearest;
  const std::uint32_t band = __ballot_sync(0xffffffffu, is_band);
  if (threadIdx.x % 32 == 0) atomicAdd(&finished.band, static_cast<unsigned>(__popc(band)));
  __syncthreads();
  if (!output.slots || finished.band != 0) write_tile(l, view, index, finished, output);
  if (threadIdx.x == 0) {
    atomicAdd(&outcome->samples_band, Counter{finished.band});
    atomicAdd(&outcome->samples_examined, Counter{32} * finished.measured);
  }
  __syncthreads();
  if (threadIdx.x == 0 && output.slots && finished.band == 0) output.slots[index] = -1;
}

/// The lists of all tiles.
struct GatherLists {
  const Counter* start;
  const std::uint32_t* entries;
  const Counter* nearest_bound;  // per tile, or null: the upper half bounds the distance at the tile's centre
};

/// Blocks stride over the tiles.
template <bool kNearest>
STANDOFF_KERNEL void __launch_bounds__(kGatherThreads, 2)
    gather(Lattice l, DeviceMesh mesh, GatherLists lists, DeviceOutput output, Outcome* outcome) {
  __shared__ Stage stage;
  __shared__ Finished finished;
  __shared__ TileView view;
  __shared__ WarpExtent extent;
  __shared__ float tile_radius;
  if (outcome->stopped) return;
  const int thread = static_cast<int>(threadIdx.x);
  if (thread == 0) {
    extent = warp_extent(l);
    const double half = 3.5 * sqrt(l.unit[0] * l.unit[0] + l.unit[1] * l.unit[1] + l.unit[2] * l.unit[2]);
    tile_radius = static_cast<float>(half) * (1 + kSlackRatio);
  }
  const SampleAt at = sample_of_thread(thread);
  const std::int64_t tiles = l.tile_count();
  for (std::int64_t index = blockIdx.x; index < tiles; index += gridDim.x) {
    if (output.slots && output.slots[index] < 0) continue;
    view_tile(l, index, view);
    if (thread == 0) finished.band = finished.measured = 0;
    __syncthreads();
    const float* const x = view.coordinate[0];
    const float* const y = view.coordinate[1];
    const float* const z = view.coordinate[2];
    const Triple<float> sample{x[at.x], y[at.y], z[at.z]};
    const int wx = at.x & 4, wy = at.y & 4, wz = at.z & 6;
    WarpSamples warp{
        {(x[wx] + x[wx + 3]) / 2, (y[wy] + y[wy + 3]) / 2, (z[wz] + z[wz + 1]) / 2}, {0, 0, 0}, __builtin_inff()};
    const bool in_grid = at.x < view.inside[0] && at.y < view.inside[1] && at.z < view.inside[2];

    // Bound the distance of all samples of the tile from the mesh.
    float known_within = l.thickness;
    std::uint32_t nearest_center = kNoTriangle;
    if (lists.nearest_bound) {
      const Counter nearest_bound = lists.nearest_bound[index];
      const float bound = __uint_as_float(static_cast<std::uint32_t>(nearest_bound >> 32));
      nearest_center = static_cast<std::uint32_t>(nearest_bound);
      known_within = min(known_within, bound + tile_radius);
    }

    Nearest best{__builtin_inff(), kNoTriangle};
    int measured = 0;
    const Counter begin = lists.start[index], listed = lists.start[index + 1] - begin;
    // Begin with the triangle nearest to the tile's centre, which is also in the list: so warps know a near point of
    // the mesh from the start. Measuring it twice changes nothing.
    const Counter extra = nearest_center != kNoTriangle && listed > 0, all = listed + extra;
    for (Counter first = 0; first < all; first += Stage::kTriangles) {
      const int count = all - first < Stage::kTriangles ? static_cast<int>(all - first) : Stage::kTriangles;
      // The warps take turns in setting up.
      const int n = (thread + static_cast<int>(first % kGatherThreads)) % kGatherThreads;
      const Counter mine = first + static_cast<Counter>(n);
      __syncthreads();  // the last stage has been read
      if (n < count)
        set_up(l, mesh, mine < extra ? nearest_center : lists.entries[begin + mine - extra], view.center, stage, n);
      __syncthreads();
      measured += gather_stage<kNearest>(l, extent, stage, count, sample, in_grid, known_within, warp, best);
    }
    if (thread % 32 == 0) atomicAdd(&finished.measured, static_cast<unsigned>(measured));
    const bool in_band = in_grid && !(l.thickness_sq < best.distance_sq);
    const float value = in_grid ? min(sqrt(best.distance_sq) * l.unscale, l.thickness_world) : l.thickness_world;
    finish_tile(l, view, index, at, value, in_band ? best.triangle : kNoTriangle, in_band, finished, output, outcome);
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
