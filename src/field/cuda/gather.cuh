// SPDX-License-Identifier: Apache-2.0
// From lists of triangles to distances. A warp takes one work item (gather_work.cuh) after another and computes the
// item's tile alone: it shares nothing with other warps, so none waits for another one.
//
// A warp sets up 32 triangles of the list at a time, one per lane, in shared memory. The best of each sample of the
// tile lies there too, and is lowered by atomic minima, as several lanes may reach the same sample: so the order of
// triangles changes no bit.
//
// A short triangle is set up as a frame in float, a long one as linear functions in double (tolerances.h). Which
// samples a short one is measured from is found in one of two ways:
//   ByRows     thin bands: in the rows of samples that its box, grown by the thickness, reaches (gather_rows.cuh)
//   ByGroups   thick bands and full fields: in the groups of 4x4x2 samples where it may be the nearest triangle
//              (gather_groups.cuh)
// A long triangle is measured in groups either way. A way W has
//   W::Steps                        the steps that it takes: AllSteps, but for benchmarks
//   W::Stage                        what a warp has set up: a CommonStage with `slack`, `long_pair` and bound_long()
//   way.begin(l, mesh, tile)        begins an item
//   W::gather_short(...)            sets up 32 triangles at most, and measures the short ones
//   W::Group                        a group of samples, whose keeps() decides whether a long triangle is measured there
#pragma once

#include "field/cuda/gather_tile.cuh"
#include "field/cuda/gather_work.cuh"
#include "field/tolerances.h"
#include "gpu/warp.cuh"

namespace standoff::STANDOFF_PLATFORM {

inline constexpr int kGatherThreads = 128, kGatherWarps = kGatherThreads / 32;

/// Bytes of shared memory of a multiprocessor, of which each block takes kSharedOfBlock beside its own.
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 900
inline constexpr int kSharedBytes = 228 << 10, kMostBlocks = 16;
#elif __CUDA_ARCH__ == 800 || __CUDA_ARCH__ == 870
inline constexpr int kSharedBytes = 164 << 10, kMostBlocks = 16;
#elif __CUDA_ARCH__ >= 800
inline constexpr int kSharedBytes = 100 << 10, kMostBlocks = 12;
#else
inline constexpr int kSharedBytes = 64 << 10, kMostBlocks = 8;
#endif
inline constexpr int kSharedOfBlock = 1 << 10;
/// Blocks to a multiprocessor, which bounds the registers: as many as there is shared memory for, but not so many that
/// too few registers are left. Eight leave 64, nine 56, so that numbers are spilled. One thin band gains more by
/// registers (a twentieth, on an H200), many small ones by warps (a fortieth).
template <class Tile>
constexpr int gather_blocks() {
  constexpr int kWanted = Tile::kMany ? 9 : 8,
                kFit = kSharedBytes / (int{sizeof(Tile)} * kGatherWarps + kSharedOfBlock);
  constexpr int kLess = kFit < kWanted ? kFit : kWanted;
  return kLess < 1 ? 1 : kLess < kMostBlocks ? kLess : kMostBlocks;
}

// Measuring.

/// The steps of a gather. A field takes all of them; a benchmark of single steps leaves some out.
struct AllSteps {
  static constexpr bool kSetsUp = true;     // sets up triangles
  static constexpr bool kFindsRows = true;  // finds the samples to measure from
  static constexpr bool kMeasures = true;
  static constexpr bool kWrites = true;
  /// Whether a number that was found is written, or counted if its step is the last.
  static STANDOFF_DEVICE bool uses(float) { return true; }
};

/// A staged short triangle, for the samples of one row.
struct RowDistance {
  TriangleFrame<float> frame;
  float q, y, z;  // evaluate() of triangle_frame.h, of which only the last step changes along the row

  template <class Tile>
  STANDOFF_DEVICE RowDistance(const Tile& tile, int triangle, int row, int layer)
      : frame(load<TriangleFrame<float>>(tile.stage.frame[triangle])) {
    const float py = tile.view.coordinate[1][row], pz = tile.view.coordinate[2][layer];
    q = fma(py, frame.q.g.y, fma(pz, frame.q.g.z, frame.q.c));
    y = fma(py, frame.y.g.y, fma(pz, frame.y.g.z, frame.y.c));
    z = fma(py, frame.z.g.y, fma(pz, frame.z.g.z, frame.z.c));
  }
  STANDOFF_DEVICE float squared(float px) const {
    return frame_distance_sq(frame, fma(px, frame.q.g.x, q), fma(px, frame.y.g.x, y), fma(px, frame.z.g.x, z));
  }
};

/// A staged long triangle, for the samples of one row.
struct LongRowDistance {
  TriangleLines<float> lines;
  LineReadings<float> at_zero;  // without the last step of evaluate()

  template <class Tile>
  STANDOFF_DEVICE LongRowDistance(const Tile& tile, int triangle, int row, int layer)
      : lines(load<TriangleLines<float>>(tile.stage.lines[triangle])) {
    const float py = tile.view.coordinate[1][row], pz = tile.view.coordinate[2][layer];
    const auto reading = [&](const Triple<float>& g, float c) { return fma(py, g.y, fma(pz, g.z, c)); };
    const auto &left = lines.left, &right = lines.right;
    at_zero = {
        reading(lines.q.g, lines.q.c),       reading(lines.y.g, lines.y.c),           reading(lines.z.g, lines.z.c),
        reading(left.past.g, left.past.c),   reading(left.across.g, left.across.c),   reading(left.along.g, 0),
        reading(right.past.g, right.past.c), reading(right.across.g, right.across.c), reading(right.along.g, 0)};
  }
  STANDOFF_DEVICE float squared(float px) const {
    const auto &left = lines.left, &right = lines.right;
    return lines_distance_sq(
        lines, LineReadings<float>{
                   fma(px, lines.q.g.x, at_zero.q), fma(px, lines.y.g.x, at_zero.y), fma(px, lines.z.g.x, at_zero.z),
                   fma(px, left.past.g.x, at_zero.past_left), fma(px, left.across.g.x, at_zero.across_left),
                   fma(px, left.along.g.x, at_zero.along_left), fma(px, right.past.g.x, at_zero.past_right),
                   fma(px, right.across.g.x, at_zero.across_right), fma(px, right.along.g.x, at_zero.along_right)});
  }
};

/// Measures from the four samples of row `n` of a group to staged triangle `triangle`.
template <class Distance, class Tile>
STANDOFF_DEVICE void lower_four(Tile& tile, int triangle, int group, int n) {
  constexpr bool kNearest = Tile::kWithNearest;
  const SampleAt at = group_sample(group, 4 * n);
  const Distance distance(tile, triangle, at.y, at.z);
  float px[4], squared[4];
  __builtin_memcpy(px, __builtin_assume_aligned(tile.view.coordinate[0] + at.x, sizeof px), sizeof px);
  for (int x = 0; x < 4; ++x) squared[x] = distance.squared(px[x]);
  for (int x = 0; x < 4; ++x)
    lower(&tile.found[found_at(at.x + x, at.y, at.z)],
          found<kNearest>(squared[x], kNearest ? tile.stage.triangle[triangle] : 0));
}

/// Stages the first long triangles, up to CommonStage::kLong, and returns their number. All lanes take part; no lane
/// may still read the stage.
template <class Stage>
STANDOFF_DEVICE int stage_long(const Lattice& l, const DeviceMesh& mesh, const TileView& view, std::uint32_t triangle,
                               std::uint32_t is_long, Stage& stage) {
  const int lane = static_cast<int>(threadIdx.x) % 32, n = __popc(is_long & ((1u << lane) - 1));
  if ((is_long >> lane & 1) && n < Stage::kLong) {
    const LocalCorners corners = local_corners(l, mesh, triangle, view.center);
    stage.bound_long(n, narrowed_box(corners));
    store(make_lines<float>(make_frame(corners.a, corners.b, corners.c, double{kLeastLengthSq})), stage.lines[n]);
    stage.triangle[n] = triangle;
  }
  const int all = __popc(is_long);
  __syncwarp();
  return all < Stage::kLong ? all : Stage::kLong;
}

/// Measures the staged long triangles in the groups where they are near. All lanes take part; each returns the number
/// of samples that it measured from.
template <class Way, class Tile>
STANDOFF_DEVICE unsigned gather_long(const Lattice& l, int count, Tile& tile) {
  constexpr int kAtOnce = 32 / kGroups;  // a lane for each triangle and group
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const typename Way::Group group(l, tile, lane % kGroups);
  int queued = 0;
  STANDOFF_ROLLED
  for (int first = 0; first < count; first += kAtOnce) {
    const int mine = first + lane / kGroups;
    bool is_near = false;
    if (mine < count) {
      const float squared = distance_sq(load<TriangleLines<float>>(tile.stage.lines[mine]), group.center);
      is_near = group.keeps(tile.stage, mine, sqrt(squared) - tile.stage.slack[mine]);
    }
    const std::uint32_t near = __ballot_sync(0xffffffffu, is_near);
    if (is_near)
      tile.stage.long_pair[queued + __popc(near & ((1u << lane) - 1))] =
          static_cast<LongPair>(mine * kGroups + lane % kGroups);
    queued += __popc(near);
  }
  __syncwarp();
  unsigned measured = 0;
  if constexpr (Way::Steps::kMeasures) {
    STANDOFF_ROLLED
    for (int n = lane / 8; n < queued; n += 4) {
      const int pair = tile.stage.long_pair[n];
      lower_four<LongRowDistance>(tile, pair / kGroups, pair % kGroups, lane % 8);
      measured += 4;
    }
  } else {
    measured = static_cast<unsigned>(queued);
  }
  return measured;
}

/// Clears the lowest `count` set bits.
STANDOFF_DEVICE std::uint32_t without_lowest(std::uint32_t bits, int count) {
  for (int n = 0; n < count; ++n) bits &= bits - 1;
  return bits;
}

/// Measures the triangles of the warp's item. All lanes take part; each returns the number of samples that it measured
/// from.
template <class Way, class Tile>
STANDOFF_DEVICE unsigned gather_item(const Lattice& l, const DeviceMesh& mesh, const Way& way,
                                     const std::uint32_t* entries, Tile& tile) {
  using Steps = typename Way::Steps;
  const std::uint32_t lane = threadIdx.x % 32, count = tile.item.count;
  const std::uint32_t* const list = entries + tile.item.first;
  unsigned measured = 0;
  way.begin(l, mesh, tile);
  std::uint32_t next = lane < count ? list[lane] : 0;
  for (std::uint32_t first = 0; first < count; first += 32) {
    const std::uint32_t triangle = next;
    if (first + 32 + lane < count) next = list[first + 32 + lane];  // early: it is known when needed
    if constexpr (Steps::kSetsUp) {
      std::uint32_t is_long = Way::gather_short(l, mesh, triangle, first + lane < count, tile, measured);
      __syncwarp();
      while (is_long != 0) {
        const int now = stage_long(l, mesh, tile.view, triangle, is_long, tile.stage);
        if constexpr (Steps::kFindsRows) measured += gather_long<Way>(l, now, tile);
        __syncwarp();
        is_long = without_lowest(is_long, now);
      }
    } else {
      measured += Steps::uses(__uint_as_float(triangle));
    }
  }
  return measured;
}

// Writing.

/// Finishes the tile: clamps the best of each sample, which `at` returns, and writes it. A sparse field does not store
/// a tile without a band sample. All lanes take part. Returns the number of samples in the band.
template <bool kNearest, class Steps, class At>
STANDOFF_DEVICE unsigned finish_tile(const Lattice& l, const std::int64_t* tile, const int* inside,
                                     const DeviceOutput& output, At at) {
  // A lane has sample x of the rows y and y + 4 of each layer.
  const int lane = static_cast<int>(threadIdx.x) % 32, x = lane % 8, y = lane / 8;
  const auto nothing = nothing_found<kNearest>(l);
  const auto in_grid = [&](int n) { return x < inside[0] && y + n % 2 * 4 < inside[1] && n / 2 < inside[2]; };
  const auto best_at = [&](int n) { return in_grid(n) ? at(x, y + n % 2 * 4, n / 2) : nothing; };
  const std::int64_t row = l.size[0], layer = l.size[0] * l.size[1];
  std::int64_t first = tile[0] * 8 + x + row * (tile[1] * 8 + y) + layer * (tile[2] * 8);
  if (output.slots) {
    std::int32_t& slot = output.slots[l.tile(tile[0], tile[1], tile[2])];
    bool any = false;
    STANDOFF_ROLLED
    for (int n = 0; n < kTileSamples / 32; ++n) any |= best_at(n) < nothing;
    if (__ballot_sync(0xffffffffu, any) == 0) {
      if (lane == 0) slot = -1;
      return 0;
    }
    first = std::int64_t{slot} * kTileSamples + lane;
  }
  unsigned band = 0;
  STANDOFF_ROLLED
  for (int n = 0; n < kTileSamples / 32; ++n) {
    const Found<kNearest> best = best_at(n);
    const bool is_band = best < nothing;
    band += is_band;
    const float value =
        is_band ? min(sqrt(__uint_as_float(distance_bits(best))) * l.unscale, l.thickness_world) : l.thickness_world;
    if (!(output.slots || in_grid(n)) || !Steps::uses(value)) continue;
    const std::int64_t to = first + (output.slots ? 32 * n : n % 2 * 4 * row + n / 2 * layer);
    output.values[to] = value;
    if (kNearest) output.nearest[to] = is_band ? static_cast<std::uint32_t>(best) : kNoTriangle;
  }
  return warp_sum(band);
}

/// Merges the results of a part of a list into the results of all parts. All lanes take part.
template <bool kNearest, class Tile>
STANDOFF_DEVICE void merge_part(const Lattice& l, const Tile& tile, Found<kNearest>* into) {
  const auto nothing = nothing_found<kNearest>(l);
  STANDOFF_ROLLED
  for (int s = static_cast<int>(threadIdx.x) % 32; s < kTileSamples; s += 32) {
    const Found<kNearest> best = tile.found[found_at(s % 8, s / 8 % 8, s / 64)];
    if (best < nothing && best < load_relaxed(into + s)) atomicMin(into + s, best);
  }
}

/// Adds a warp's counts, of the samples that each lane measured and of all samples in the band, to an outcome.
STANDOFF_DEVICE void add_counts(Outcome* outcome, Counter measured, Counter band) {
  measured = warp_sum(measured);
  if (threadIdx.x % 32 != 0) return;
  if (measured) atomicAdd(&outcome->samples_examined, measured);
  if (band) atomicAdd(&outcome->samples_band, band);
}

template <bool kNearest, class Way, class Fields>
inline constexpr int kGatherBlocks = gather_blocks<GatherTile<kNearest, Fields, typename Way::Stage>>();

/// Warps take items until none is left: the first one by their own number, as a counter that all of them ask would hold
/// up small fields. A tile whose list was cut is finished later, by finish_cut_tiles.
template <bool kNearest, class Way, class Fields>
STANDOFF_KERNEL void __launch_bounds__(kGatherThreads, kGatherBlocks<kNearest, Way, Fields>)
    gather(typename Fields::Lattices lattices, Fields fields, Way way, const std::uint32_t* entries, GatherWork work) {
  using Steps = typename Way::Steps;
  using Tile = GatherTile<kNearest, Fields, typename Way::Stage>;
  __shared__ Tile tiles[kGatherWarps];
  if (fields.total()->stopped) return;
  const int lane = static_cast<int>(threadIdx.x) % 32;
  Tile& tile = tiles[threadIdx.x / 32];
  const Counter items = work.size(), warps = std::uint64_t{gridDim.x} * kGatherWarps;
  Counter band = 0, measured = 0, next = 0;
  for (Counter number = std::uint64_t{blockIdx.x} * kGatherWarps + threadIdx.x / 32; number < items;
       number = __shfl_sync(0xffffffffu, next, 0)) {
    if (lane == 0) {
      next = warps + atomicAdd(&work.counts->taken, Counter{1});  // early: it is known when needed
      tile.item = work.at(number);
      if constexpr (Fields::kMany) tile.staged.number = fields.unstack(tile.item.tile);
    }
    __syncwarp();
    if (tile.item.count == 0) {
      with_far_field(lattices, fields, tile, [&](const Lattice& l, const auto& field) {
        if constexpr (Steps::kWrites) fill_tiles(l, tile.item, field.output);
      });
      __syncwarp();
      continue;
    }
    stage_field(fields, tile);
    with_far_field(lattices, fields, tile, [&](const Lattice& l, const auto&) {
      view_tile(l, tile.item.tile, lane, tile.view);
      const auto nothing = nothing_found<kNearest>(l);
      STANDOFF_ROLLED
      for (int n = lane; n < kFoundRow * kTileSide * kTileSide; n += 32) tile.found[n] = nothing;
    });
    __syncwarp();
    with_staged_field(lattices, fields, tile, [&](const Lattice& l, const auto& field) {
      measured += gather_item(l, field.mesh, way, entries, tile);
      if (tile.item.cut != kWhole)
        merge_part<kNearest>(
            l, tile, reinterpret_cast<Found<kNearest>*>(work.found) + std::int64_t{tile.item.cut} * kTileSamples);
      else
        band += finish_tile<kNearest, Steps>(l, tile.item.tile, tile.view.inside, field.output,
                                             [&](int x, int y, int z) { return tile.found[found_at(x, y, z)]; });
      if constexpr (Fields::kMany) {
        add_counts(field.outcome, measured, band);
        measured = band = 0;
      }
    });
    __syncwarp();
  }
  if constexpr (!Fields::kMany) add_counts(fields.total(), measured, band);
}

/// Finishes the tiles whose lists were cut; warps stride over them.
template <bool kNearest, class Steps, class Fields>
STANDOFF_KERNEL void __launch_bounds__(kGatherThreads)
    finish_cut_tiles(typename Fields::Lattices lattices, Fields fields, GatherWork work) {
  __shared__ Found<kNearest> staged[kGatherWarps][kTileSamples];
  if (fields.total()->stopped) return;
  const int warp = static_cast<int>(threadIdx.x) / 32;
  for (Counter n = blockIdx.x * kGatherWarps + threadIdx.x / 32; n < work.counts->cut; n += gridDim.x * kGatherWarps) {
    const auto* const from = reinterpret_cast<const Found<kNearest>*>(work.found) + n * kTileSamples;
    for (int s = static_cast<int>(threadIdx.x) % 32; s < kTileSamples; s += 32) staged[warp][s] = from[s];
    __syncwarp();
    std::int64_t tile[3];
    const std::int64_t number = find_tile(fields, work.cut_tiles[n], tile);
    const Lattice& l = fields.lattice(lattices, number);
    const auto& field = fields.field(number);
    const int within[3] = {inside<kTileSide>(l, tile, 0), inside<kTileSide>(l, tile, 1), inside<kTileSide>(l, tile, 2)};
    const unsigned band = finish_tile<kNearest, Steps>(
        l, tile, within, field.output, [&](int x, int y, int z) { return staged[warp][x + 8 * y + 64 * z]; });
    add_counts(field.outcome, 0, band);
    __syncwarp();
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
