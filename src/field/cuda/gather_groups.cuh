// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields: triangles are measured in the groups of 4x4x2 samples of a tile where they may be
// nearest.
//
// Each lane keeps its triangle in registers and compares it with the centre of one group after the other. A group knows
// how far its samples are from the mesh at most, and a point of the mesh near its centre. What passes is a pair of a
// triangle and a group; pairs wait in a queue until there are enough for all lanes. Then eight lanes take a pair, a row
// of four samples each.
#pragma once

#include "field/cuda/gather.cuh"
#include "gpu/warp.cuh"

namespace standoff::STANDOFF_PLATFORM {

struct alignas(16) GroupState {
  Triple<float> center;
  float reach;  // triangles farther from the centre are not the nearest of any sample
  NearSurface surface;
};

/// A pair of a group and a staged triangle that has to be measured there.
using Pair = std::uint16_t;

struct GroupStage : CommonStage {
  static constexpr int kPairs = 256;
  GroupState group[kGroups];
  alignas(16) CellExtent extent;
  float known_within;  // bounds the distance of all samples of the tile from the mesh
  union {              // short triangles, then long ones
    Pair pair[kPairs];
    struct {
      float slack[kLong];
      CenteredBox box[kLong];
      LongPair long_pair[kLongPairs];
    };
  };

  STANDOFF_DEVICE void bound_long(int n, const BoxOf<float>& b) {
    slack[n] = distance_slack(farthest_coordinate(b));
    box[n] = centered(b);
  }
};

/// Whether a triangle in a box may be nearest to a sample of the group. `least` is a lower bound of its distance from
/// their centre, `slack` the error of that.
STANDOFF_DEVICE bool may_be_nearest(const CellExtent& extent, const CenteredBox& box, float least, float slack,
                                    const GroupState& group) {
  return least <= group.reach && least * least < bisector_sq(extent, box, slack, group.surface);
}

/// Lowers `reach` to what is known by now: the best of the group's samples, and the nearest point of the mesh. Two
/// lanes for each group; all take part.
template <class Tile>
STANDOFF_DEVICE void update_reach(const Lattice& l, Tile& tile) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const SampleAt first = group_sample(lane / 2, lane % 2 * 16);
  std::uint32_t worst = 0;
  STANDOFF_ROLLED
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const std::uint32_t bits = distance_bits(tile.found[found_at(first.x + x, first.y + y, first.z)]);
      worst = worst < bits ? bits : worst;
    }
  const std::uint32_t other = __shfl_xor_sync(0xffffffffu, worst, 1), most = __float_as_uint(l.thickness_sq);
  worst = worst < other ? other : worst;
  worst = worst < most ? worst : most;  // of samples without a triangle so far
  GroupState& group = tile.stage.group[lane / 2];
  const float radius = tile.stage.extent.radius;
  const float by_group = min(sqrt(__uint_as_float(worst)), group.surface.within + radius);
  const float far = min(l.thickness, min(by_group, tile.stage.known_within));
  __syncwarp();
  if (lane % 2 == 0) group.reach = far * (1 + kSlackRatio) + radius;
  __syncwarp();
}

/// Makes the triangle that is nearest to a group's centre, of those that the lanes have, its nearest point of the mesh,
/// if it is nearer than the one known so far. `most` bounds the distance of the lane's triangle. All lanes take part.
STANDOFF_DEVICE void find_surface(const TriangleFrame<float>& frame, float most, GroupState& group) {
  const std::uint32_t bits = __float_as_uint(most), least = warp_min(bits);  // ascend alike: none is negative
  if (!(__uint_as_float(least) < group.surface.within)) return;
  __syncwarp();  // all lanes have read it
  const std::uint32_t nearest = __ballot_sync(0xffffffffu, bits == least);
  if (static_cast<int>(threadIdx.x) % 32 == __ffs(static_cast<int>(nearest)) - 1)
    group.surface = {closest_in_frame(frame, group.center), most};
  __syncwarp();
}

/// Measures the queued pairs. All lanes take part; each returns the number of samples that it measured from.
template <class Tile>
STANDOFF_DEVICE unsigned measure_pairs(int queued, Tile& tile) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  // Four pairs at once, a quarter of the queue apart: neighbours in the queue have the same group, whose samples can be
  // lowered only one after the other.
  const int quarter = (queued + 3) / 4, first = lane / 8 * quarter;
  const int end = first + quarter < queued ? first + quarter : queued;
  unsigned measured = 0;
  STANDOFF_ROLLED
  for (int n = first; n < end; ++n) {
    const int pair = tile.stage.pair[n];
    lower_four<RowDistance>(tile, pair % CommonStage::kShort, pair / CommonStage::kShort, lane % 8);
    measured += 4;
  }
  return measured;
}

struct ByGroups {
  using Steps = AllSteps;
  using Stage = GroupStage;

  const Counter* nearest_bound;  // per tile, or null: the upper half bounds the distance at its centre, by the used
                                 // triangle whose number is the lower half

  /// What is known before any triangle of the list has been measured. All lanes take part.
  template <class Tile>
  STANDOFF_DEVICE void begin(const Lattice& l, const DeviceMesh& mesh, Tile& tile) const {
    const int lane = static_cast<int>(threadIdx.x) % 32;
    const TileView& view = tile.view;
    GroupState group{group_center(view, lane % kGroups), 0, {{0, 0, 0}, __builtin_inff()}};
    float known_within = l.thickness;
    if (nearest_bound) {
      const Counter nearest = nearest_bound[l.tile(view.tile[0], view.tile[1], view.tile[2])];
      const double half = 3.5 * sqrt(l.unit[0] * l.unit[0] + l.unit[1] * l.unit[1] + l.unit[2] * l.unit[2]);
      const float bound = __uint_as_float(static_cast<std::uint32_t>(nearest >> 32));
      known_within = min(known_within, bound + static_cast<float>(half) * (1 + kSlackRatio));
      const std::uint32_t triangle = used_triangle(mesh, static_cast<std::uint32_t>(nearest));
      const LocalCorners corners = local_corners(l, mesh, triangle, view.center);
      const auto frame =
          make_frame(narrowed(corners.a), narrowed(corners.b), narrowed(corners.c), float{kLeastLengthSq});
      group.surface = {
          closest_in_frame(frame, group.center),
          sqrt(distance_sq(frame, group.center)) + distance_slack(farthest_coordinate(narrowed_box(corners)))};
    }
    if (lane < kGroups) tile.stage.group[lane] = group;
    if (lane == 0) {
      tile.stage.extent = group_extent(l);
      tile.stage.known_within = known_within;
    }
    // Samples past the grid must not keep triangles.
    if (view.inside[0] < kTileSide || view.inside[1] < kTileSide || view.inside[2] < kTileSide) STANDOFF_ROLLED
    for (int n = lane; n < kTileSamples; n += 32) {
      const int x = n % 8, y = n / 8 % 8, z = n / 64;
      if (x >= view.inside[0] || y >= view.inside[1] || z >= view.inside[2]) tile.found[found_at(x, y, z)] = 0;
    }
    __syncwarp();
  }

  /// Sets up the triangles of the lanes that have one, and measures the short ones; adds the number of samples to
  /// `measured`. Returns a bit for each lane with a long triangle. All lanes take part.
  template <class Tile>
  static STANDOFF_DEVICE std::uint32_t gather_short(const Lattice& l, const DeviceMesh& mesh, std::uint32_t triangle,
                                                    bool has_one, Tile& tile, unsigned& measured) {
    const int lane = static_cast<int>(threadIdx.x) % 32;
    update_reach(l, tile);
    TriangleFrame<float> frame{};
    CenteredBox box{};
    float slack = 0;
    bool is_long_one = false;
    if (has_one) {
      const LocalCorners corners = local_corners(l, mesh, triangle, tile.view.center);
      Triple<float> a = narrowed(corners.a), b = narrowed(corners.b), c = narrowed(corners.c);
      BoxOf<float> around = box_of(a, b, c);
      if (is_speck(l, around)) {
        a = b = c = middle_of(around);
        around = box_of(a, a, a);
      }
      is_long_one = is_long(around);
      box = centered(around);
      slack = distance_slack(farthest_coordinate(around));
      if (!is_long_one) {
        frame = make_frame(a, b, c, float{kLeastLengthSq});
        store(frame, tile.stage.frame[lane]);
        tile.stage.triangle[lane] = triangle;
      }
    }
    const bool is_short = has_one && !is_long_one;
    const std::uint32_t long_ones = __ballot_sync(0xffffffffu, is_long_one);
    if (__ballot_sync(0xffffffffu, is_short) == 0) return long_ones;
    int queued = 0;
    STANDOFF_ROLLED
    for (int n = 0;; ++n) {
      if (n == kGroups || queued > GroupStage::kPairs - 32) {
        __syncwarp();
        measured += measure_pairs(queued, tile);
        __syncwarp();
        queued = 0;
      }
      if (n == kGroups) break;
      GroupState& group = tile.stage.group[n];
      const float distance = sqrt(distance_sq(frame, group.center));
      find_surface(frame, is_short ? distance + slack : __builtin_inff(), group);
      const bool keeps = is_short && may_be_nearest(tile.stage.extent, box, max(distance - slack, 0.0f), slack, group);
      const std::uint32_t kept = __ballot_sync(0xffffffffu, keeps);
      if (keeps)
        tile.stage.pair[queued + __popc(kept & ((1u << lane) - 1))] = static_cast<Pair>(n * CommonStage::kShort + lane);
      queued += __popc(kept);
    }
    return long_ones;
  }

  /// A group of samples, to which a long triangle may be nearest.
  struct Group {
    Triple<float> center;
    const GroupState& state;
    const CellExtent& extent;

    template <class Tile>
    STANDOFF_DEVICE Group(const Lattice&, const Tile& tile, int group)
        : center(tile.stage.group[group].center), state(tile.stage.group[group]), extent(tile.stage.extent) {}
    /// `least`: no more than the distance of staged triangle n from the centre.
    STANDOFF_DEVICE bool keeps(const Stage& stage, int n, float least) const {
      return may_be_nearest(extent, stage.box[n], max(least, 0.0f), stage.slack[n], state);
    }
  };
};

}  // namespace standoff::STANDOFF_PLATFORM
