// SPDX-License-Identifier: Apache-2.0
// The sidecars of a field in device memory, from its nearest triangles. Launched after the field and its sign. The bits
// are those of the CPU (cpu/kernels/sidecars.inl): a sample is measured in one of three ways (geometry/closest_part.h),
// and which one is decided alike.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/grid_axis.h"
#include "core/tile_count.h"
#include "geometry/closest_part.h"
#include "gpu/mesh.cuh"
#include "gpu/platform.cuh"
#include "gpu/warp.cuh"
#include "sidecars/sidecars.h"
#include "standoff/error.h"
#include "standoff/field.h"

namespace standoff::STANDOFF_PLATFORM {

// A choice, not measured: four samples for each thread.
inline constexpr unsigned kSidecarThreads = 128;

/// What the gradient on the surface follows from.
struct SurfaceNormals {
  bool has_sign;           ///< it points outwards; else to the sample's side
  bool is_reversed;        ///< all triangles are reversed
  const std::int8_t* use;  ///< the orientation of each triangle (OrientedMesh::use), or null: the mesh's own
  STANDOFF_DEVICE double orientation(std::uint32_t triangle) const {
    const bool reversed = (use && use[triangle] < 0) != is_reversed;
    return !has_sign ? 0.0 : reversed ? -1.0 : 1.0;
  }
};

struct SidecarTask {
  DeviceMesh mesh;
  DeviceOutput output;
  DeviceSidecars to;
  GridAxis x, y, z;
  Size3 tiles;
  double scale, unscale;
  SurfaceNormals normals;
  const Outcome* outcome;
};

/// A tile, in shared memory.
struct SidecarTileView {
  std::int64_t at[3];          // its first sample
  std::int64_t slot;           // sparse output: where its values are
  double place[3][kTileSide];  // the samples, scaled world coordinates
};

/// A hash table of the triangles that are nearest to a tile's samples, in shared memory.
struct TileTriangles {
  static constexpr unsigned kEntries = 2 * static_cast<unsigned>(kTileSamples);
  static constexpr std::uint16_t kNoEntry = kEntries;
  std::uint16_t entry[kTileSamples];  // of each sample's triangle in the table, or kNoEntry
  std::uint32_t triangle[kEntries];   // kNoTriangle: a free entry
  int first[kEntries];                // its first sample
  int count[kEntries];                // its samples
  int end;                            // triangles whose first sample is before this one are prepared once

  STANDOFF_DEVICE unsigned entry_of(std::uint32_t wanted) {
    // Fibonacci hashing (Knuth): the top ten bits of a product. Its low ten are the same for triangles 1024 apart, as
    // neighbours in regular meshes may be.
    static_assert(kEntries == 1u << 10);
    for (unsigned at = wanted * 2654435761u >> 22;; at = (at + 1) % kEntries) {
      const std::uint32_t there = atomicCAS(&triangle[at], kNoTriangle, wanted);
      if (there == kNoTriangle || there == wanted) return at;
    }
  }
};

STANDOFF_DEVICE bool is_in_grid(const SidecarTask& task, const SidecarTileView& view, int sample) {
  return view.at[0] + sample % 8 < task.x.size && view.at[1] + sample / 8 % 8 < task.y.size &&
         view.at[2] + sample / 64 < task.z.size;
}
/// The index in the output of a sample, which is in the grid if the output is dense.
STANDOFF_DEVICE std::int64_t index_of(const SidecarTask& task, const SidecarTileView& view, int sample) {
  if (task.output.slots) return view.slot * kTileSamples + sample;
  return view.at[0] + sample % 8 +
         task.x.size * (view.at[1] + sample / 8 % 8 + task.y.size * (view.at[2] + sample / 64));
}

/// Reads the tile's nearest triangles. All threads of the block take part.
STANDOFF_DEVICE void find_triangles(const SidecarTask& task, const SidecarTileView& view, TileTriangles& found) {
  for (unsigned n = threadIdx.x; n < TileTriangles::kEntries; n += kSidecarThreads) {
    found.triangle[n] = kNoTriangle;
    found.first[n] = static_cast<int>(kTileSamples);
    found.count[n] = 0;
  }
  __syncthreads();
  for (int sample = static_cast<int>(threadIdx.x); sample < kTileSamples; sample += int{kSidecarThreads}) {
    const std::uint32_t triangle =
        is_in_grid(task, view, sample) ? task.output.nearest[index_of(task, view, sample)] : kNoTriangle;
    const unsigned entry = triangle == kNoTriangle ? TileTriangles::kNoEntry : found.entry_of(triangle);
    found.entry[sample] = static_cast<std::uint16_t>(entry);
    if (triangle == kNoTriangle) continue;
    atomicMin(&found.first[entry], sample);
    atomicAdd(&found.count[entry], 1);
  }
  __syncthreads();
}

/// Finds how many of the tile's triangles are prepared once. All lanes of one warp take part.
STANDOFF_DEVICE void find_end(TileTriangles& found) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  int triangles = 0, samples = 0;
  for (int begin = 0; begin < kTileSamples; begin += 32) {
    const unsigned entry = found.entry[begin + lane];
    const bool is_first = entry != TileTriangles::kNoEntry && found.first[entry] == begin + lane;
    const int mine = is_first ? found.count[entry] : 0, sum = warp_sum_up_to(mine);
    const std::uint32_t firsts = __ballot_sync(0xffffffffu, is_first);
    const int before = triangles + __popc(firsts & ((1u << lane) - 1));
    const std::uint32_t ends = __ballot_sync(0xffffffffu, is_first && !prepares_more(before, samples + sum - mine));
    if (ends != 0) {
      if (lane == 0) found.end = begin + __ffs(static_cast<int>(ends)) - 1;
      return;
    }
    triangles += __popc(firsts);
    samples += __shfl_sync(0xffffffffu, sum, 31);
  }
  if (lane == 0) found.end = static_cast<int>(kTileSamples);
}

/// Three numbers of a sample, rounded to float.
STANDOFF_DEVICE void store_triple(float* to, std::int64_t at, const Triple<double>& v) {
  if (!to) return;
  to[3 * at] = static_cast<float>(v.x);
  to[3 * at + 1] = static_cast<float>(v.y);
  to[3 * at + 2] = static_cast<float>(v.z);
}
/// `point`: in scaled world coordinates.
STANDOFF_DEVICE void store_sidecars(const SidecarTask& task, std::int64_t at, const Triple<double>& point,
                                    const Triple<double>& weights, double feature, const Triple<double>& direction) {
  store_triple(task.to.closest_point, at, point * task.unscale);
  store_triple(task.to.barycentric, at, weights);
  if (task.to.feature) task.to.feature[at] = static_cast<std::uint8_t>(feature);
  store_triple(task.to.gradient, at, direction);
}

/// Measures a sample that has a nearest triangle. `is_prepared`: on the CPU, the triangle is prepared for all of its
/// samples in the tile.
STANDOFF_DEVICE void measure_sample(const SidecarTask& task, const SidecarTileView& view, int sample,
                                    std::uint32_t triangle, bool is_prepared) {
  const std::int64_t at = index_of(task, view, sample);
  const Triple<double> place{view.place[0][sample % 8], view.place[1][sample / 8 % 8], view.place[2][sample / 64]};
  Corners corner = corners_of(task.mesh, triangle);
  for (Triple<double>& one : corner.at) one = one * task.scale;
  const Triple<double>&a = corner.at[0], &b = corner.at[1], &c = corner.at[2];
  const double sign = __float_as_uint(task.output.values[at]) >> 31 != 0 ? -1.0 : 1.0;
  if (is_prepared) {
    const Triple<double> low{view.place[0][0], view.place[1][0], view.place[2][0]},
        high{view.place[0][kTileSide - 1], view.place[1][kTileSide - 1], view.place[2][kTileSide - 1]};
    const auto face = quick_face(a, b, c, reach_sq(low, high, a));
    const auto over = quick_face_at(face, place - a);
    if (over.is_inside)
      return store_sidecars(task, at, minus_scaled(place, face.normal, over.height),
                            {(1.0 - over.v) - over.w, over.v, over.w}, 0,
                            face.normal * (over.height < 0 ? -sign : sign));
  }
  const auto part = quick_part(quick_triangle(a, b, c), place - a);
  if (part.is_sound)
    return store_sidecars(task, at, place + part.point, weights_of(part), feature_of(part),
                          part.point * (-sign / sqrt(part.distance_sq)));
  for (Triple<double>& one : corner.at) one = one - place;
  const ClosestPart<double> exact = closest_part(a, b, c);
  const Slope<double> slope = slope_of(exact, a, task.normals.orientation(triangle));
  store_sidecars(task, at, place + exact.point, exact.weights, exact.feature,
                 slope.direction * (slope.is_near > 0.5 ? 1.0 : sign));
}

/// Blocks stride over the tiles.
STANDOFF_KERNEL void __launch_bounds__(kSidecarThreads) fill_sidecars(SidecarTask task) {
  __shared__ SidecarTileView view;
  __shared__ TileTriangles found;
  if (task.outcome->stopped != 0) return;
  const std::int64_t tiles = task.tiles.x * task.tiles.y * task.tiles.z;
  for (std::int64_t tile = blockIdx.x; tile < tiles; tile += gridDim.x) {
    if (task.output.slots && task.output.slots[tile] < 0) continue;
    if (threadIdx.x < 3 * kTileSide) {
      const int axis = static_cast<int>(threadIdx.x) / kTileSide, n = static_cast<int>(threadIdx.x) % kTileSide;
      const GridAxis& along = axis == 0 ? task.x : axis == 1 ? task.y : task.z;
      const std::int64_t number = axis == 0   ? tile % task.tiles.x
                                  : axis == 1 ? tile / task.tiles.x % task.tiles.y
                                              : tile / (task.tiles.x * task.tiles.y);
      view.place[axis][n] = along.at(kTileSide * number + n) * task.scale;
      if (n == 0) view.at[axis] = kTileSide * number;
      if (threadIdx.x == 0) view.slot = task.output.slots ? task.output.slots[tile] : 0;
    }
    __syncthreads();
    find_triangles(task, view, found);
    if (threadIdx.x < 32) find_end(found);
    __syncthreads();
    for (int sample = static_cast<int>(threadIdx.x); sample < kTileSamples; sample += int{kSidecarThreads}) {
      const unsigned entry = found.entry[sample];
      if (entry != TileTriangles::kNoEntry) {
        measure_sample(task, view, sample, found.triangle[entry], found.first[entry] < found.end);
      } else if (task.output.slots || is_in_grid(task, view, sample)) {
        const Triple<double> nothing{0, 0, 0};
        store_sidecars(task, index_of(task, view, sample), nothing, nothing, 0, nothing);
      }
    }
    __syncthreads();
  }
}

/// Throws Error{usage} if there are no nearest triangles, from which sidecars follow.
inline void check_sidecars(const Task& task) {
  if (task.sidecars.any() && !task.output.nearest)
    throw Error(ErrorCode::usage,
                "cuda: sidecars are made from nearest triangles, but output.nearest is null; give it device memory for "
                "an index of each sample");
}

/// Launches them, after the task's field and sign. `normals`: of the sign that the values have.
inline void enqueue_sidecars(const Task& task, const SurfaceNormals& normals, Stream stream) {
  if (!task.sidecars.any()) return;
  const double scale = sidecar_scale(task.grid);
  const Size3 tiles = DistanceField::tiles_of(task.grid.size);
  const SidecarTask sidecars{
      task.mesh, task.output, task.sidecars, axis_of(task.grid, 0), axis_of(task.grid, 1), axis_of(task.grid, 2), tiles,
      scale,     1 / scale,   normals,       task.outcome};
  const std::int64_t blocks = std::min<std::int64_t>(tile_count(task.grid.size), std::int64_t{kManyBlocks} * 4);
  launch(stream, "sidecars", fill_sidecars, blocks, kSidecarThreads, sidecars);
}

}  // namespace standoff::STANDOFF_PLATFORM
