// SPDX-License-Identifier: Apache-2.0
// What a warp that gathers has in shared memory: its tile's samples, the best of each so far, triangles that are set
// up, and, of many fields, the one that has the tile.
#pragma once

#include <type_traits>

#include "field/cuda/culling.cuh"
#include "field/cuda/field_set.cuh"
#include "field/cuda/gather_work.cuh"
#include "geometry/triangle_frame.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

// The samples of a tile.

/// The tile of a warp or block, in shared memory.
struct TileView {
  std::int64_t tile[3];
  alignas(16) float coordinate[3][kTileSide];  // the samples, relative to the brick's centre
  float to_samples[3];                         // samples per grid unit
  int inside[3];                               // samples inside the grid
  Triple<double> center;                       // the brick's centre
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

// A tile has 2x2x4 groups of 4x4x2 samples.
inline constexpr int kGroups = kTileSamples / 32;
struct SampleAt {
  int x, y, z;
};
/// Sample `n` of a group.
STANDOFF_DEVICE SampleAt group_sample(int group, int n) {
  return {(group & 1) * 4 + (n & 3), (group >> 1 & 1) * 4 + (n >> 2 & 3), (group >> 2) * 2 + (n >> 4)};
}
STANDOFF_DEVICE Triple<float> group_center(const TileView& view, int group) {
  const SampleAt at = group_sample(group, 0);
  const float* const x = view.coordinate[0] + at.x;
  const float* const y = view.coordinate[1] + at.y;
  const float* const z = view.coordinate[2] + at.z;
  return {(x[0] + x[3]) / 2, (y[0] + y[3]) / 2, (z[0] + z[1]) / 2};
}
/// The extent of a group's samples, rounded up. Grid units.
STANDOFF_DEVICE CellExtent group_extent(const Lattice& l) {
  CellExtent e{{static_cast<float>(3 * l.unit[0]), static_cast<float>(3 * l.unit[1]), static_cast<float>(l.unit[2])},
               0};
  const float x = e.width[0] / 2, y = e.width[1] / 2, z = e.width[2] / 2;
  e.radius = sqrt(x * x + y * y + z * z) * (1 + kSlackRatio);
  return e;
}

/// The best of a sample as an integer: the bits of the squared distance, which ascend with it because it is not
/// negative; and below them the nearest triangle's index if it is asked for, so that the lowest wins a tie.
template <bool kNearest>
using Found = std::conditional_t<kNearest, Counter, std::uint32_t>;

template <bool kNearest>
STANDOFF_DEVICE Found<kNearest> found(float distance_sq, std::uint32_t triangle) {
  if constexpr (kNearest) return Counter{__float_as_uint(distance_sq)} << 32 | triangle;
  return __float_as_uint(distance_sq);
}
/// The bits of its squared distance.
template <class Best>
STANDOFF_DEVICE std::uint32_t distance_bits(Best best) {
  return static_cast<std::uint32_t>(sizeof(Best) == 8 ? Counter{best} >> 32 : Counter{best});
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

// Triangles that are set up.

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

/// A frame takes five loads of 16 bytes. Frames are 20 words apart: loads from neighbouring triangles do not meet in a
/// bank of shared memory.
struct alignas(16) StagedFrame {
  float number[20];
};
struct alignas(16) StagedLines {
  float number[40];
};

/// What every way stages; ways derive their own stage from it.
struct CommonStage {
  static constexpr int kShort = 32, kLong = 16;
  union {
    StagedFrame frame[kShort];
    StagedLines lines[kLong];
  };
  std::uint32_t triangle[kShort];
};
static_assert(sizeof(StagedLines) * CommonStage::kLong <= sizeof(StagedFrame) * CommonStage::kShort);

/// A pair of a staged long triangle and a group where it is near. Stages have `long_pair`, room for all of them.
using LongPair = std::uint8_t;
inline constexpr int kLongPairs = CommonStage::kLong * kGroups;
static_assert(kLongPairs == 256);

/// A triangle's corners relative to the brick's centre.
struct LocalCorners {
  Triple<double> a, b, c;
};
STANDOFF_DEVICE LocalCorners local_corners(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                                           const Triple<double>& center) {
  const Corners corners = corners_of(mesh, triangle);
  return {local(l, corners.at[0], center), local(l, corners.at[1], center), local(l, corners.at[2], center)};
}
STANDOFF_DEVICE BoxOf<float> narrowed_box(const LocalCorners& corners) {
  return box_of(narrowed(corners.a), narrowed(corners.b), narrowed(corners.c));
}

// The shared memory of a warp.

/// Of many fields, the one that has the warp's item: a copy of what lies far away in device memory.
struct StagedField {
  std::int64_t number;
  alignas(8) unsigned char bytes[sizeof(PlacedField)];
};
struct NoStagedField {};

template <bool kNearest, class Fields, class Stage>
struct GatherTile {
  static constexpr bool kWithNearest = kNearest, kMany = Fields::kMany;
  std::conditional_t<Fields::kMany, StagedField, NoStagedField> staged;
  WorkItem item;
  TileView view;
  Found<kNearest> found[kFoundRow * kTileSide * kTileSide];
  Stage stage;
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
// and the gather of thin bands then spills a tenth more.
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

}  // namespace standoff::STANDOFF_PLATFORM
