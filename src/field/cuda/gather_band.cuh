// SPDX-License-Identifier: Apache-2.0
// Thin bands: a block of threads takes one item of work after the other, and its warps share the item's triangles.
#pragma once

#include "field/cuda/band_measure.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// A warp stages this many triangles at least: staging takes as long for one as for 32.
inline constexpr std::uint32_t kLeastEach = 8;

/// Without the lowest `count` of its bits.
STANDOFF_DEVICE std::uint32_t without_lowest(std::uint32_t bits, int count) {
  for (int n = 0; n < count; ++n) bits &= bits - 1;
  return bits;
}

/// Measures to the triangles of the block's item; ends with a barrier. Returns from how many samples this lane
/// measured.
///
/// A list of few triangles, which is staged at once, may have long ones in one warp alone. So all warps measure to
/// these, each from a quarter of the samples. In a longer list each warp has some, and none waits for another.
template <bool kNearest, class Steps>
STANDOFF_DEVICE unsigned gather_item(const Lattice& l, const DeviceMesh& mesh, const std::uint32_t* entries,
                                     BandTile<kNearest>& tile) {
  const int warp = static_cast<int>(threadIdx.x) / 32, lane = static_cast<int>(threadIdx.x) % 32;
  BandStage& stage = tile.stage[warp];
  const std::uint32_t count = tile.item.count, rounds = (count + kBandThreads - 1) / kBandThreads,
                      even = (count + rounds * kBandWarps - 1) / (rounds * kBandWarps),
                      each = even < kLeastEach ? kLeastEach : even;
  unsigned measured = 0;
  std::uint32_t triangle = 0, long_ones = 0;
  for (std::uint32_t first = static_cast<std::uint32_t>(warp) * each; first < count; first += each * kBandWarps) {
    const int here = static_cast<int>(count - first < each ? count - first : each);
    triangle = entries[tile.item.first + first + static_cast<std::uint32_t>(lane < here ? lane : 0)];
    if constexpr (Steps::kSetsUp) {
      const Staged32 staged = stage_short(l, mesh, tile.view, triangle, here, stage);
      if constexpr (Steps::kFindsRows)
        measured += gather_rows<kNearest, Steps>(l, stage, staged.rows, tile);
      else
        measured += Steps::uses(stage.frame[lane].number[staged.rows % 20]);
      __syncwarp();
      long_ones = staged.is_long;
      while (rounds > 1 && long_ones) {
        const int staged_ones = stage_long(l, mesh, tile.view, triangle, long_ones, stage);
        if constexpr (Steps::kFindsRows) measured += gather_long<kNearest, Steps, 16>(l, stage, 0, tile);
        __syncwarp();
        long_ones = without_lowest(long_ones, staged_ones);
      }
    } else {
      measured += Steps::uses(__uint_as_float(triangle));
    }
  }
  for (;;) {
    const int staged_ones = stage_long(l, mesh, tile.view, triangle, long_ones, stage);
    long_ones = without_lowest(long_ones, staged_ones);
    __syncthreads();
    int all = 0;
    for (int n = 0; n < kBandWarps; ++n) all += tile.stage[n].long_count;
    if (all == 0) return measured;
    if constexpr (Steps::kFindsRows)
      for (int n = 0; n < kBandWarps; ++n)
        measured += gather_long<kNearest, Steps, 16 / kBandWarps>(l, tile.stage[n], 16 / kBandWarps * warp, tile);
    __syncthreads();
  }
}

/// Finishes the tile: clamps what `at` says each sample has found, and writes it; a tile without a band sample stays
/// unstored (sparse). All threads of the block take part. Returns how many samples are in the band.
template <bool kNearest, class Steps, class At>
STANDOFF_DEVICE unsigned finish_band(const Lattice& l, const std::int64_t* tile, const int* inside, unsigned* band,
                                     const DeviceOutput& output, At at) {
  const int t = static_cast<int>(threadIdx.x);
  constexpr int kEach = kTileSamples / kBandThreads;
  const auto nothing = nothing_found<kNearest>(l);
  for (int n = 0; n < kEach; ++n) {
    const int s = t + n * kBandThreads, x = s % 8, y = s / 8 % 8, z = s / 64;
    const bool in_grid = x < inside[0] && y < inside[1] && z < inside[2];
    const std::uint32_t is_band = __ballot_sync(0xffffffffu, in_grid && at(x, y, z) < nothing);
    if (t % 32 == 0 && is_band) atomicAdd(band, static_cast<unsigned>(__popc(is_band)));
  }
  __syncthreads();
  const unsigned in_band = *band;
  const std::int64_t index = l.tile(tile[0], tile[1], tile[2]);
  if (output.slots && in_band == 0) {
    if (t == 0) output.slots[index] = -1;
    return 0;
  }
  for (int n = 0; n < kEach; ++n) {
    const int s = t + n * kBandThreads, x = s % 8, y = s / 8 % 8, z = s / 64;
    const bool in_grid = x < inside[0] && y < inside[1] && z < inside[2];
    if (!output.slots && !in_grid) continue;
    const Found<kNearest> best = at(x, y, z);
    const bool is_band = in_grid && best < nothing;
    const auto bits = static_cast<std::uint32_t>(kNearest ? best >> (kNearest ? 32 : 0) : best);
    const float value = is_band ? min(sqrt(__uint_as_float(bits)) * l.unscale, l.thickness_world) : l.thickness_world;
    if (!Steps::uses(value)) continue;
    const std::int64_t to = output.slots
                                ? std::int64_t{output.slots[index]} * kTileSamples + s
                                : tile[0] * 8 + x + l.size[0] * (tile[1] * 8 + y + l.size[1] * (tile[2] * 8 + z));
    output.values[to] = value;
    if (kNearest) output.nearest[to] = is_band ? static_cast<std::uint32_t>(best) : kNoTriangle;
  }
  return in_band;
}

/// Leaves what a part of a list has found where the other parts do. All threads of the block take part.
template <bool kNearest>
STANDOFF_DEVICE void merge_part(const Lattice& l, const BandTile<kNearest>& tile, Found<kNearest>* into) {
  const auto nothing = nothing_found<kNearest>(l);
  for (int s = static_cast<int>(threadIdx.x); s < kTileSamples; s += kBandThreads) {
    const Found<kNearest> best = tile.found[found_at(s % 8, s / 8 % 8, s / 64)];
    if (best < nothing) atomicMin(into + s, best);
  }
}

/// Blocks take items until there are none. A tile whose list is cut is only lowered, and left to finish_cut_tiles.
template <bool kNearest, class Steps = AllSteps>
STANDOFF_KERNEL void __launch_bounds__(kBandThreads, kBandBlocks)
    gather_band(Lattice l, DeviceMesh mesh, const std::uint32_t* entries, BandWork work, DeviceOutput output,
                Outcome* outcome) {
  __shared__ BandTile<kNearest> tile;
  if (outcome->stopped) return;
  const int t = static_cast<int>(threadIdx.x);
  const Counter items = work.size();
  Counter mine = t == 0 ? atomicAdd(&work.counts->taken, Counter{1}) : 0;
  Counter band = 0, measured = 0;
  for (;;) {
    if (t == 0) {
      tile.has_item = mine < items;
      if (mine < items) {
        tile.item = work.at(mine);
        mine = atomicAdd(&work.counts->taken, Counter{1});  // the next one: known by then
      }
      tile.band = 0;
    }
    __syncthreads();
    if (!tile.has_item) break;
    if (tile.item.count == 0) {
      if constexpr (Steps::kWrites) fill_tiles(l, tile.item, output);
      __syncthreads();
      continue;
    }
    view_tile(l, tile.item.tile, tile.view);
    for (int n = t; n < kFoundRow * kTileSide * kTileSide; n += kBandThreads)
      tile.found[n] = nothing_found<kNearest>(l);
    __syncthreads();
    measured += gather_item<kNearest, Steps>(l, mesh, entries, tile);
    if (tile.item.cut != kWhole)
      merge_part(l, tile, reinterpret_cast<Found<kNearest>*>(work.found) + std::int64_t{tile.item.cut} * kTileSamples);
    else
      band += finish_band<kNearest, Steps>(l, tile.item.tile, tile.view.inside, &tile.band, output,
                                           [&](int x, int y, int z) { return tile.found[found_at(x, y, z)]; });
    __syncthreads();
  }
  for (int step = 16; step > 0; step /= 2) measured += __shfl_xor_sync(0xffffffffu, measured, step);
  if (t % 32 == 0 && measured) atomicAdd(&outcome->samples_examined, measured);
  if (t == 0 && band) atomicAdd(&outcome->samples_band, band);
}

/// Blocks stride over the tiles whose lists were cut.
template <bool kNearest, class Steps = AllSteps>
STANDOFF_KERNEL void __launch_bounds__(kBandThreads)
    finish_cut_tiles(Lattice l, BandWork work, DeviceOutput output, Outcome* outcome) {
  __shared__ unsigned band;
  if (outcome->stopped) return;
  Counter all = 0;
  for (Counter n = blockIdx.x; n < work.counts->cut; n += gridDim.x) {
    const auto* const from = reinterpret_cast<const Found<kNearest>*>(work.found) + n * kTileSamples;
    std::int64_t tile[3];
    tile_at(l, work.cut_tiles[n], tile);
    const int within[3] = {inside<kTileSide>(l, tile, 0), inside<kTileSide>(l, tile, 1), inside<kTileSide>(l, tile, 2)};
    if (threadIdx.x == 0) band = 0;
    __syncthreads();
    all += finish_band<kNearest, Steps>(l, tile, within, &band, output,
                                        [&](int x, int y, int z) { return from[x + 8 * y + 64 * z]; });
    __syncthreads();
  }
  if (threadIdx.x == 0 && all) atomicAdd(&outcome->samples_band, all);
}

}  // namespace standoff::STANDOFF_PLATFORM
