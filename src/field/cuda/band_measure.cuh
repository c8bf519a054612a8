// SPDX-License-Identifier: Apache-2.0
// Thin bands: a warp measures to the triangles that it has staged. What the samples of a tile have found lies in shared
// memory, where it is lowered by atomic minima: the order of triangles changes no bit.
//
// A short triangle reaches a few samples of the tile. A lane takes a row of them, along which two thirds of the linear
// functions of the frame stay the same, and no lane measures where the triangle does not reach. A long triangle is
// compared with the centres of the tile's 16 groups of 4x4x2 samples, a lane each, and measured to in the groups that
// are near.
#pragma once

#include <type_traits>

#include "field/cuda/band_stage.cuh"
#include "field/cuda/band_work.cuh"
#include "field/cuda/gather.cuh"

namespace standoff::STANDOFF_PLATFORM {

// Few warps to a block, as all of them wait for the last one at the end of a tile; and so many blocks to a
// multiprocessor that others go on meanwhile. 56 registers, of which the double precision of long triangles wants more.
inline constexpr int kBandThreads = 128, kBandBlocks = 9;
inline constexpr int kBandWarps = kBandThreads / 32;
static_assert(kLeastPart % kBandThreads == 0);

/// What a sample has found: the squared distance's bits, which ascend with it as it is not negative; above the nearest
/// triangle's index where that is wanted, so that the lowest wins a tie.
template <bool kNearest>
using Found = std::conditional_t<kNearest, Counter, std::uint32_t>;

template <bool kNearest>
STANDOFF_DEVICE Found<kNearest> found(float distance_sq, std::uint32_t triangle) {
  if constexpr (kNearest) return Counter{__float_as_uint(distance_sq)} << 32 | triangle;
  return __float_as_uint(distance_sq);
}
/// The least that no sample of the band has found: the float after the thickness squared, as rounded. Whatever lies
/// above the rounded square lies above the true one too, so its root is no less than the thickness, to which it would be
/// clamped: such distances need not be kept.
template <bool kNearest>
STANDOFF_DEVICE Found<kNearest> nothing_found(const Lattice& l) {
  return found<kNearest>(__uint_as_float(__float_as_uint(l.thickness_sq) + 1), 0);
}

/// Words from row to row: those of a triangle's rows then lie in different banks of shared memory.
inline constexpr int kFoundRow = kTileSide + 1;
STANDOFF_DEVICE int found_at(int x, int y, int z) { return x + kFoundRow * (y + kTileSide * z); }

/// What the threads of a block share.
template <bool kNearest>
struct BandTile {
  WorkItem item;
  int has_item;
  unsigned band;  // samples in it
  TileView view;
  Found<kNearest> found[kFoundRow * kTileSide * kTileSide];
  BandStage stage[kBandWarps];
};

/// The steps of a gather. A program that measures what each of them costs leaves some out; a field takes these.
struct AllSteps {
  static constexpr bool kSetsUp = true;     // triangles
  static constexpr bool kFindsRows = true;  // which samples to measure from
  static constexpr bool kMeasures = true;
  static constexpr bool kWrites = true;
  /// Whether a number that was found is written, or counted where its step is the last.
  static STANDOFF_DEVICE bool uses(float) { return true; }
};

/// The bitwise or over the lanes of a warp.
STANDOFF_DEVICE std::uint32_t warp_or(std::uint32_t bits) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
  return __reduce_or_sync(0xffffffffu, bits);
#else
  for (int step = 16; step > 0; step /= 2) bits |= __shfl_xor_sync(0xffffffffu, bits, step);
  return bits;
#endif
}

/// Measures from a row of samples to a staged triangle; returns how many samples that were.
template <bool kNearest, class Steps>
STANDOFF_DEVICE unsigned measure_row(const Lattice& l, const BandStage& stage, int n, unsigned row,
                                     BandTile<kNearest>& tile) {
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
    // evaluate() of triangle_frame.h, of which all but the last step is the same along the row.
    const float q0 = fma(py, f.q.g.y, fma(pz, f.q.g.z, f.q.c)), y0 = fma(py, f.y.g.y, fma(pz, f.y.g.z, f.y.c)),
                z0 = fma(py, f.z.g.y, fma(pz, f.z.g.z, f.z.c));
    const std::uint32_t triangle = kNearest ? stage.triangle[n] : 0;
    const float* const px = tile.view.coordinate[0] + x;
    Found<kNearest>* const at = tile.found + found_at(x, y, z);
    for (int i = 0; i < nx; ++i) {
      const float d = frame_distance_sq(f, fma(px[i], f.q.g.x, q0), fma(px[i], f.y.g.x, y0), fma(px[i], f.z.g.x, z0));
      if (d <= l.thickness_sq) atomicMin(at + i, found<kNearest>(d, triangle));
    }
  }
  return static_cast<unsigned>(nx);
}

/// Measures to the staged short triangles, which have `count` rows. All lanes take part; each returns from how many
/// samples it measured.
template <bool kNearest, class Steps>
STANDOFF_DEVICE unsigned gather_rows(const Lattice& l, const BandStage& stage, unsigned count,
                                     BandTile<kNearest>& tile) {
  const unsigned lane = threadIdx.x % 32;
  const unsigned first_row = stage.rows[lane].number & 0xffff;  // of the triangle that is this lane's here
  unsigned measured = 0;
  int begun = 0;  // triangles whose rows begin before `first`
  for (unsigned first = 0; first < count; first += 32) {
    const unsigned ahead = first_row - first;
    const std::uint32_t begin = warp_or(ahead < 32 ? 1u << ahead : 0);
    const int n = begun + __popc(begin & (0xffffffffu >> (31 - lane))) - 1;
    begun += __popc(begin);
    if (first + lane < count) measured += measure_row<kNearest, Steps>(l, stage, n, first + lane, tile);
  }
  return measured;
}

/// Measures to the staged long triangles, from kGroups of the tile's groups of samples on: from all of them, or from a
/// warp's share. All lanes take part, and each returns from how many samples it measured.
template <bool kNearest, class Steps, int kGroups>
STANDOFF_DEVICE unsigned gather_long(const Lattice& l, const BandStage& stage, int first_group,
                                     BandTile<kNearest>& tile) {
  constexpr int kAtOnce = 32 / kGroups;  // triangles, a lane for each of them and each group
  const int lane = static_cast<int>(threadIdx.x) % 32, count = stage.long_count;
  const float* const x = tile.view.coordinate[0];
  const float* const y = tile.view.coordinate[1];
  const float* const z = tile.view.coordinate[2];
  const SampleAt group = sample_of_thread((first_group + lane % kGroups) * 32);  // the first of this lane's group
  const Triple<float> center{(x[group.x] + x[group.x + 3]) / 2, (y[group.y] + y[group.y + 3]) / 2,
                             (z[group.z] + z[group.z + 1]) / 2};
  const float within = l.thickness * (1 + kSlackRatio) + warp_extent(l).radius;
  unsigned measured = 0;
  for (int first = 0; first < count; first += kAtOnce) {
    const int mine = first + lane / kGroups;
    const bool is_near =
        mine < count &&
        sqrt(distance_sq(load<TriangleLines<float>>(stage.lines[mine]), center)) - stage.slack[mine] <= within;
    const std::uint32_t near = __ballot_sync(0xffffffffu, is_near);
    measured += static_cast<unsigned>(__popc(near));
    if constexpr (Steps::kMeasures) {
      for (std::uint32_t left = near; left; left &= left - 1) {
        const int bit = __ffs(static_cast<int>(left)) - 1, n = first + bit / kGroups;
        const SampleAt at = sample_of_thread((first_group + bit % kGroups) * 32 + lane);
        const float d =
            distance_sq(load<TriangleLines<float>>(stage.lines[n]), Triple<float>{x[at.x], y[at.y], z[at.z]});
        if (d <= l.thickness_sq)
          atomicMin(&tile.found[found_at(at.x, at.y, at.z)], found<kNearest>(d, stage.triangle[n]));
      }
    }
  }
  return measured;
}

}  // namespace standoff::STANDOFF_PLATFORM
