// SPDX-License-Identifier: Apache-2.0
// Thin bands: each warp takes one work item after another, and computes its tile alone.
#pragma once

#include <type_traits>

#include "field/cuda/band_work.cuh"
#include "field/cuda/gather.cuh"
#include "gpu/warp.cuh"

namespace standoff::STANDOFF_PLATFORM {

// A warp measures the triangles that it has staged, 32 at a time. The best of each sample of the tile lies in shared
// memory, and is lowered by atomic minima, as several lanes may reach the same sample: so the order of triangles
// changes no bit. Warps share nothing, so no warp waits for another one, and each stages as many triangles at once as
// there are.
//
// A short triangle reaches a few samples of the tile. A lane takes a row of them, along which two thirds of the linear
// functions of the frame stay the same, and no lane measures beyond the triangle's reach. A long triangle is compared
// with the centres of the tile's 16 groups of 4x4x2 samples, a lane each, and measured in the groups that are near.

// Eight blocks to a multiprocessor leave 64 registers, nine 56, so that numbers are spilled. One field gains more by
// registers (a twentieth, on an H200), many small ones by warps (a fortieth). Compute capability 7.5 has room for
// eight.
inline constexpr int kBandThreads = 128, kBandWarps = kBandThreads / 32;
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 800
inline constexpr int kBlocksOfMany = 8;
#else
inline constexpr int kBlocksOfMany = 9;
#endif
template <class Fields>
inline constexpr int kBandBlocks = Fields::kMany ? kBlocksOfMany : 8;

/// The best of a sample as an integer: the bits of the squared distance, which ascend with it because it is not
/// negative; and below them the nearest triangle's index if it is asked for, so that the lowest wins a tie.
template <bool kNearest>
using Found = std::conditional_t<kNearest, Counter, std::uint32_t>;

template <bool kNearest>
STANDOFF_DEVICE Found<kNearest> found(float distance_sq, std::uint32_t triangle) {
  if constexpr (kNearest) return Counter{__float_as_uint(distance_sq)} << 32 | triangle;
  return __float_as_uint(distance_sq);
}
/// The least value that no band sample has: the float after the rounded square of the thickness. A float above the
/// rounded square is above the true square too, so its root is no less than the thickness, to which it would be
/// clamped: such distances need not be kept.
template <bool kNearest>
STANDOFF_DEVICE Found<kNearest> nothing_found(const Lattice& l) {
  return found<kNearest>(__uint_as_float(__float_as_uint(l.thickness_sq) + 1), 0);
}

/// Lowers the best of a sample, in shared memory. There is no condition in front of 32 bits: a minimum is one
/// instruction, a branch takes four. 64 bits are lowered by a loop, which is worth a look first.
template <class Best>
STANDOFF_DEVICE void lower(Best* best, Best to) {
  if (sizeof(Best) == 4 || to < load_relaxed(best)) atomicMin(best, to);
}

/// Words from row to row: one more than a row has, so that rows of a triangle lie in different banks of shared memory.
inline constexpr int kFoundRow = kTileSide + 1;
STANDOFF_DEVICE int found_at(int x, int y, int z) { return x + kFoundRow * (y + kTileSide * z); }

/// Of many fields, the one that has the warp's item: a copy of what lies far away in device memory.
struct StagedField {
  std::int64_t number;
  alignas(8) unsigned char bytes[sizeof(PlacedField)];
};
struct NoStagedField {};

/// The shared memory of a warp.
template <bool kNearest, class Fields>
struct BandTile {
  static constexpr bool kWithNearest = kNearest, kMany = Fields::kMany;
  std::conditional_t<Fields::kMany, StagedField, NoStagedField> staged;
  WorkItem item;
  TileView view;
  Found<kNearest> found[kFoundRow * kTileSide * kTileSide];
  BandStage stage;
};

/// The steps of a gather. A field takes all of them; a benchmark of single steps leaves some out.
struct AllSteps {
  static constexpr bool kSetsUp = true;     // sets up triangles
  static constexpr bool kFindsRows = true;  // finds the samples to measure from
  static constexpr bool kMeasures = true;
  static constexpr bool kWrites = true;
  /// Whether a number that was found is written, or counted if its step is the last.
  static STANDOFF_DEVICE bool uses(float) { return true; }
};

/// Copies field `number` to shared memory, if there are many. All lanes take part.
template <class Tile, class Fields>
STANDOFF_DEVICE void stage_field(const Fields& fields, Tile& tile) {
  if constexpr (Fields::kMany) {
    static_assert(sizeof(PlacedField) % 4 == 0);
    const auto* const from = reinterpret_cast<const unsigned char*>(fields.all + tile.staged.number);
    for (unsigned n = 4 * (threadIdx.x % 32); n < sizeof(PlacedField); n += 4 * 32)
      __builtin_memcpy(tile.staged.bytes + n, from + n, 4);
  }
}
/// Calls use(lattice, field) with the field of the warp's item: from where it lies, or, if there are many, from shared
/// memory once it is there.
//
// They are handed down, not returned: nvcc 13 copies a kernel's parameters if a function returns references to them,
// and gather_band then spills a tenth more.
template <class Fields, class Tile, class Use>
STANDOFF_DEVICE void with_far_field(const typename Fields::Lattices& lattices, const Fields& fields, const Tile& tile,
                                    Use use) {
  if constexpr (Fields::kMany)
    use(fields.all[tile.staged.number].lattice, fields.all[tile.staged.number]);
  else
    use(lattices, fields);
}
template <class Fields, class Tile, class Use>
STANDOFF_DEVICE void with_staged_field(const typename Fields::Lattices& lattices, const Fields& fields,
                                       const Tile& tile, Use use) {
  if constexpr (Fields::kMany) {
    const auto& staged = *reinterpret_cast<const PlacedField*>(tile.staged.bytes);
    use(staged.lattice, staged);
  } else {
    use(lattices, fields);
  }
}

/// Measures from a row of samples to a staged triangle; returns the number of samples.
template <class Steps, class Tile>
STANDOFF_DEVICE unsigned measure_row(const BandStage& stage, int n, unsigned row, Tile& tile) {
  constexpr bool kNearest = Tile::kWithNearest;
  const StagedRows rows = stage.rows[n];
  const int x = static_cast<int>(rows.box & 15), nx = static_cast<int>(rows.box >> 4 & 15),
            ny = static_cast<int>(rows.box >> 12 & 15);
  if constexpr (Steps::kMeasures) {
    const int of_triangle = static_cast<int>(row - (rows.number & 0xffff));
    const int deep = of_triangle * static_cast<int>(rows.number >> 16) >> 10;
    const int y = static_cast<int>(rows.box >> 8 & 15) + of_triangle - deep * ny,
              z = static_cast<int>(rows.box >> 16) + deep;
    const auto f = load<TriangleFrame<float>>(stage.frame[n]);
    const float py = tile.view.coordinate[1][y], pz = tile.view.coordinate[2][z];
    // This is evaluate() of triangle_frame.h; only its last step changes along the row.
    const float q0 = fma(py, f.q.g.y, fma(pz, f.q.g.z, f.q.c)), y0 = fma(py, f.y.g.y, fma(pz, f.y.g.z, f.y.c)),
                z0 = fma(py, f.z.g.y, fma(pz, f.z.g.z, f.z.c));
    const std::uint32_t triangle = kNearest ? stage.triangle[n] : 0;
    const float* px = tile.view.coordinate[0] + x;
    Found<kNearest>* at = tile.found + found_at(x, y, z);
    for (int left = nx; left > 0; --left, ++px, ++at) {
      const float d = frame_distance_sq(f, fma(*px, f.q.g.x, q0), fma(*px, f.y.g.x, y0), fma(*px, f.z.g.x, z0));
      lower(at, found<kNearest>(d, triangle));
    }
  }
  return static_cast<unsigned>(nx);
}

/// Measures the staged short triangles, which have `count` rows. All lanes take part; each returns the number of
/// samples that it measured from.
template <class Steps, class Tile>
STANDOFF_DEVICE unsigned gather_rows(const BandStage& stage, unsigned count, Tile& tile) {
  const unsigned lane = threadIdx.x % 32;
  const unsigned first_row = stage.rows[lane].number & 0xffff;  // the first row of this lane's triangle
  unsigned measured = 0;
  int begun = 0;  // the number of triangles whose rows begin before `first`
  for (unsigned first = 0; first < count; first += 32) {
    const unsigned ahead = first_row - first;
    const std::uint32_t begin = warp_or(ahead < 32 ? 1u << ahead : 0);
    const int n = begun + __popc(begin & (0xffffffffu >> (31 - lane))) - 1;
    begun += __popc(begin);
    if (first + lane < count) measured += measure_row<Steps>(stage, n, first + lane, tile);
  }
  return measured;
}

/// Measures the staged long triangles. All lanes take part; each returns the number of samples that it measured from.
template <class Steps, class Tile>
STANDOFF_DEVICE unsigned gather_long(const Lattice& l, const BandStage& stage, int count, Tile& tile) {
  constexpr bool kNearest = Tile::kWithNearest;
  constexpr int kGroups = kTileSamples / 32, kAtOnce = 32 / kGroups;  // a lane for each triangle and group
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const float* const x = tile.view.coordinate[0];
  const float* const y = tile.view.coordinate[1];
  const float* const z = tile.view.coordinate[2];
  const SampleAt group = sample_of_thread(lane % kGroups * 32);  // the first sample of the lane's group
  const Triple<float> center{(x[group.x] + x[group.x + 3]) / 2, (y[group.y] + y[group.y + 3]) / 2,
                             (z[group.z] + z[group.z + 1]) / 2};
  const float within = l.thickness * (1 + kSlackRatio) + warp_extent(l).radius;
  unsigned measured = 0;
  STANDOFF_ROLLED
  for (int first = 0; first < count; first += kAtOnce) {
    const int mine = first + lane / kGroups;
    const bool is_near =
        mine < count &&
        sqrt(distance_sq(load<TriangleLines<float>>(stage.lines[mine]), center)) - stage.slack[mine] <= within;
    const std::uint32_t near = __ballot_sync(0xffffffffu, is_near);
    measured += static_cast<unsigned>(__popc(near));
    if constexpr (Steps::kMeasures) {
      STANDOFF_ROLLED
      for (std::uint32_t left = near; left; left &= left - 1) {
        const int bit = __ffs(static_cast<int>(left)) - 1, n = first + bit / kGroups;
        const SampleAt at = sample_of_thread(bit % kGroups * 32 + lane);
        const float d =
            distance_sq(load<TriangleLines<float>>(stage.lines[n]), Triple<float>{x[at.x], y[at.y], z[at.z]});
        lower(&tile.found[found_at(at.x, at.y, at.z)], found<kNearest>(d, stage.triangle[n]));
      }
    }
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
template <class Steps, class Tile>
STANDOFF_DEVICE unsigned gather_item(const Lattice& l, const DeviceMesh& mesh, const std::uint32_t* entries,
                                     Tile& tile) {
  const std::uint32_t lane = threadIdx.x % 32, count = tile.item.count;
  const std::uint32_t* const list = entries + tile.item.first;
  BandStage& stage = tile.stage;
  unsigned measured = 0;
  std::uint32_t next = lane < count ? list[lane] : 0;
  for (std::uint32_t first = 0; first < count; first += 32) {
    const std::uint32_t triangle = next;
    if (first + 32 + lane < count) next = list[first + 32 + lane];  // early: it is known when needed
    if constexpr (Steps::kSetsUp) {
      const Staged32 staged = stage_short(l, mesh, tile.view, triangle, first + lane < count, stage);
      if constexpr (Steps::kFindsRows)
        measured += gather_rows<Steps>(stage, staged.rows, tile);
      else
        measured += Steps::uses(stage.frame[lane].number[staged.rows % 20]);
      __syncwarp();
      for (std::uint32_t is_long = staged.is_long; is_long != 0;) {
        const int now = stage_long(l, mesh, tile.view, triangle, is_long, stage);
        if constexpr (Steps::kFindsRows) measured += gather_long<Steps>(l, stage, now, tile);
        __syncwarp();
        is_long = without_lowest(is_long, now);
      }
    } else {
      measured += Steps::uses(__uint_as_float(triangle));
    }
  }
  return measured;
}

/// Finishes the tile: clamps the best of each sample, which `at` returns, and writes it. A sparse field does not store
/// a tile without a band sample. All lanes take part. Returns the number of samples in the band.
template <bool kNearest, class Steps, class At>
STANDOFF_DEVICE unsigned finish_band(const Lattice& l, const std::int64_t* tile, const int* inside,
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
    const auto bits = static_cast<std::uint32_t>(kNearest ? best >> (kNearest ? 32 : 0) : best);
    const float value = is_band ? min(sqrt(__uint_as_float(bits)) * l.unscale, l.thickness_world) : l.thickness_world;
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

/// Warps take items until none is left: the first one by their own number, as a counter that all of them ask would hold
/// up small fields. A tile whose list was cut is finished later, by finish_cut_tiles.
template <bool kNearest, class Steps, class Fields>
STANDOFF_KERNEL void __launch_bounds__(kBandThreads, kBandBlocks<Fields>)
    gather_band(typename Fields::Lattices lattices, Fields fields, const std::uint32_t* entries, BandWork work) {
  __shared__ BandTile<kNearest, Fields> tiles[kBandWarps];
  if (fields.total()->stopped) return;
  const int lane = static_cast<int>(threadIdx.x) % 32;
  BandTile<kNearest, Fields>& tile = tiles[threadIdx.x / 32];
  const Counter items = work.size(), warps = std::uint64_t{gridDim.x} * kBandWarps;
  Counter band = 0, measured = 0, next = 0;
  for (Counter number = std::uint64_t{blockIdx.x} * kBandWarps + threadIdx.x / 32; number < items;
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
      measured += gather_item<Steps>(l, field.mesh, entries, tile);
      if (tile.item.cut != kWhole)
        merge_part<kNearest>(
            l, tile, reinterpret_cast<Found<kNearest>*>(work.found) + std::int64_t{tile.item.cut} * kTileSamples);
      else
        band += finish_band<kNearest, Steps>(l, tile.item.tile, tile.view.inside, field.output,
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
STANDOFF_KERNEL void __launch_bounds__(kBandThreads)
    finish_cut_tiles(typename Fields::Lattices lattices, Fields fields, BandWork work) {
  __shared__ Found<kNearest> staged[kBandWarps][kTileSamples];
  if (fields.total()->stopped) return;
  const int warp = static_cast<int>(threadIdx.x) / 32;
  for (Counter n = blockIdx.x * kBandWarps + threadIdx.x / 32; n < work.counts->cut; n += gridDim.x * kBandWarps) {
    const auto* const from = reinterpret_cast<const Found<kNearest>*>(work.found) + n * kTileSamples;
    for (int s = static_cast<int>(threadIdx.x) % 32; s < kTileSamples; s += 32) staged[warp][s] = from[s];
    __syncwarp();
    std::int64_t tile[3];
    const std::int64_t number = find_tile(fields, work.cut_tiles[n], tile);
    const Lattice& l = fields.lattice(lattices, number);
    const auto& field = fields.field(number);
    const int within[3] = {inside<kTileSide>(l, tile, 0), inside<kTileSide>(l, tile, 1), inside<kTileSide>(l, tile, 2)};
    const unsigned band = finish_band<kNearest, Steps>(
        l, tile, within, field.output, [&](int x, int y, int z) { return staged[warp][x + 8 * y + 64 * z]; });
    add_counts(field.outcome, 0, band);
    __syncwarp();
  }
}

}  // namespace standoff::STANDOFF_PLATFORM
