// Room for the candidates of a brick while its cells are visited.
#pragma once

#include <cstdint>

#include "cpu/lattice.h"

namespace difi::cpu {

/// Some candidates of one brick, sixteen to a group: their boxes and frames relative to the brick's centre, a register per number.
/// More candidates than fit come one table after the other. About 1.1 MiB.
struct CandidateTable {
  static constexpr int kGroups = 512;
  static constexpr int kFrameNumbers = 20;
  static constexpr int kMostLong = 256;
  static constexpr int kLinesNumbers = 42;

  struct Group {
    alignas(64) float low[3][kLanes];
    alignas(64) float high[3][kLanes];
    alignas(64) float frame[kFrameNumbers][kLanes];
    alignas(64) float slack[kLanes];  ///< what the distance in the frame may be off by
    alignas(64) std::uint32_t index[kLanes];
    std::uint32_t is_long;            ///< bits of the lanes whose samples need lines
  };
  Group groups[kGroups];
  alignas(64) float distance[kGroups][kLanes];  ///< from the centre of the cell being culled

  /// The groups that still have candidates for a cell, and which.
  struct Active {
    std::uint16_t group;
    std::uint16_t lanes;
  };
  Active all[kGroups], of_tile[kGroups], of_cell[kGroups];
};

}  // namespace difi::cpu
