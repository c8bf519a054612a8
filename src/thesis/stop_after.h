// SPDX-License-Identifier: Apache-2.0
// Ablation: after which step a measured kernel stops. Table 5.4 of the thesis takes two times, and their difference is
// what a step costs.
#pragma once

#include <cstdint>

namespace standoff {

/// Each goes farther than the one before. A step that a method does not have costs it nothing.
enum class StopAfter {
  lists,     ///< tiles: lists made and walked through; thesis: samples walked through, with their positions
  set_up,    ///< triangles set up in shared memory
  rows,      ///< the samples from which a triangle must be measured to
  distance,  ///< distances, and the least of them
  read,      ///< thesis: what the sample holds is read
  write,     ///< nothing is left out: the field
  always,    ///< thesis: the field, written without a look at what the sample holds
};

/// The bits of a float that no arithmetic gives. What is left out would happen at these, so that the compiler must
/// compute all that comes before.
inline constexpr std::uint32_t kNeverBits = 0x7fa00001u;

}  // namespace standoff
