// Room for the candidates of a brick while its cells are visited.
#pragma once

#include <cstdint>

#include "cpu/lattice.h"

namespace difi::cpu {

/// Some candidates of one brick, sixteen to a group: their boxes and frames relative to the brick's centre. More
/// candidates than fit come one table after the other. About 1.6 MiB.
struct CandidateTable {
  static constexpr int kGroups = 512;
  static constexpr int kFrameNumbers = 20;

  struct Group {
    alignas(64) float low[3][kLanes];
    alignas(64) float high[3][kLanes];
    alignas(64) float frame[kFrameNumbers][kLanes];  ///< a register per number, to cull sixteen at once
    /// The same frames one after the other, to evaluate one: two cache lines of it instead of twenty.
    float one_frame[kLanes][kFrameNumbers];
    alignas(64) float slack[kLanes];  ///< what the distance in the frame may be off by
    alignas(64) std::uint32_t index[kLanes];
    std::uint32_t is_long;  ///< bits of the lanes whose samples need lines
  };
  Group groups[kGroups];
  alignas(64) float distance[kGroups][kLanes];  ///< from the centre of the cell being culled

  /// The groups that still have candidates for a cell, and which.
  struct Active {
    std::uint16_t group;
    std::uint16_t lanes;
  };
  Active all[kGroups], of_tile[kGroups], of_cell[kGroups], of_block[kGroups];
  std::uint32_t list[(kGroups + 1) * kLanes];  ///< candidates one by one: group * 16 + lane; room for a register more
};

}  // namespace difi::cpu
