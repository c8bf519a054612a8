// SPDX-License-Identifier: Apache-2.0
// Scratch memory for the candidates of a tile while its cells are visited.
#pragma once

#include <cstdint>

#include "field/cpu/frame_lanes.h"
#include "field/cpu/lattice.h"

namespace standoff::cpu {

/// Cells of 4x4x4 samples: one block wide, kCellBlocks high and deep.
inline constexpr int kCellSide = 4, kCellBlocks = 2, kBlocksOfCell = kCellBlocks * kCellBlocks;
static_assert(kCellSide == kBlockX && kCellSide == kCellBlocks * kBlockY && kCellSide == kCellBlocks * kBlockZ);

/// Sixteen triangles set up, relative to the brick's centre.
struct FrameGroup {
  FrameLanes frame;
  alignas(64) std::uint32_t index[kLanes];  ///< in the mesh
  std::uint32_t is_long;                    ///< bits of the lanes whose samples need lines
};

/// Groups that are looked at together, 2048 triangles. A thread's table of them takes 0.6 MiB; most tiles have far
/// fewer candidates. With fewer groups, tiles with more candidates go on in more parts, each with reference points of
/// its own.
inline constexpr int kTableGroups = 128;

/// Candidates one by one: group * 16 + lane; room for a register more.
struct CandidateList {
  std::uint32_t candidate[(kTableGroups + 1) * kLanes];
  int count;
};

/// Some candidates of one tile. More candidates than fit come one table after the other.
struct CandidateTable {
  static constexpr int kGroups = kTableGroups;
  static constexpr int kCornersPerAxis = 3;
  static constexpr int kCorners = kCornersPerAxis * kCornersPerAxis * kCornersPerAxis;

  /// What blocks choose by: the box of each candidate, and a point of it. Axis, candidate.
  template <int kCount>
  struct Extents {
    alignas(64) float low[3][kCount];
    alignas(64) float high[3][kCount];
    alignas(64) float point[3][kCount];
  };

  struct Group : FrameGroup {
    alignas(64) float slack[kLanes];  ///< what a distance from the frame may be off by
    /// What the squared distance from each corner of the lattice is at least.
    alignas(64) float corner_distance_sq[kCorners][kLanes];
    Extents<kLanes> extent;
    std::uint32_t lanes;  ///< bits of the lanes in use
  };
  Group groups[kGroups];
  int count;  ///< groups in use

  /// The lattice of the tile's 2x2x2 cells, x fastest, and near each corner the nearest point of the surface found.
  struct Corner {
    float at[3];
    float point[3];
    float distance_sq;  ///< infinite while none was found
    float slack;        ///< how far from the surface the point may be
  };
  Corner corners[kCorners];

  /// The groups a cell has to look at, and the lanes of each.
  struct Active {
    std::uint16_t group;
    std::uint16_t lanes;
  };
  Active active[kGroups];
  int active_groups;

  CandidateList list;                             ///< those of a cell
  Extents<(kGroups + 1) * kLanes> listed_extent;  ///< of the candidates in the list; room for a register more
  CandidateList block_list[kBlocksOfCell];        ///< those that a block has to look at
};

}  // namespace standoff::cpu
