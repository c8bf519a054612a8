// Room for the candidates of a tile while its cells are visited.
#pragma once

#include <cstdint>

#include "cpu/lattice.h"

namespace difi::cpu {

/// Some candidates of one tile, sixteen to a group, relative to the brick's centre. More candidates than fit come one
/// table after the other.
struct CandidateTable {
  static constexpr int kGroups = 128;
  static constexpr int kFrameNumbers = 20, kExtentNumbers = 9;
  static constexpr int kCornersPerAxis = 3;
  static constexpr int kCorners = kCornersPerAxis * kCornersPerAxis * kCornersPerAxis;

  struct Group {
    alignas(64) float frame[kFrameNumbers][kLanes];
    alignas(64) float slack[kLanes];  ///< what a distance from the frame may be off by
    /// What the squared distance from each corner of the lattice is at least.
    alignas(64) float corner_distance_sq[kCorners][kLanes];
    alignas(64) std::uint32_t index[kLanes];
    /// What blocks choose by: lowest and highest coordinates of each candidate, then those of a point of it.
    alignas(64) float extent[kExtentNumbers][kLanes];
    std::uint32_t lanes;    ///< bits of the lanes in use
    std::uint32_t is_long;  ///< bits of the lanes whose samples need lines
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
  int active_groups, active_candidates;

  /// Candidates one by one: group * 16 + lane; room for a register more.
  struct List {
    std::uint32_t candidate[(kGroups + 1) * kLanes];
    int count;
  };
  List list;
  alignas(64) float listed_extent[kExtentNumbers][(kGroups + 1) * kLanes];  ///< of the candidates in the list

  static constexpr int kBlocksOfCell = 4;
  List block_list[kBlocksOfCell];  ///< those of the list that a block has to look at
};

}  // namespace difi::cpu
