// SPDX-License-Identifier: Apache-2.0
// The candidates of a cell among triangles that are small against the spacing, and scratch memory for those it keeps.
#pragma once

#include <cstdint>

#include "field/cpu/box_arrays.h"
#include "field/cpu/candidate_table.h"
#include "field/cpu/lattice.h"

namespace standoff::cpu {

struct CrowdedCell {
  int at[3];                   ///< its first sample in the brick
  const BoxArrays& boxes;      ///< of its candidates; all entries are triangles
  const float (*points)[3];    ///< a point of each entry, in the coordinates of the boxes and as exact as they are
  const std::uint32_t* index;  ///< in the mesh, of each entry
  float brick_center[3];       ///< in the coordinates of the boxes
  float extent;                ///< no sample has larger coordinates there
};

/// Those candidates of a cell that some of its blocks chose. More boxes than fit come one table after the other.
struct CrowdedTable {
  static constexpr int kMost = kTableGroups * kLanes;

  std::uint32_t chosen[kMost];  ///< mesh indices
  int chosen_count;
  FrameGroup groups[kTableGroups];          ///< the same set up
  CandidateList block_list[kBlocksOfCell];  ///< of those, the ones that a block has to look at
};

}  // namespace standoff::cpu
