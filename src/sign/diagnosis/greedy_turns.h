// SPDX-License-Identifier: Apache-2.0
// Which of many things to turn, where pairs of them want to be turned alike or differently.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace standoff {

/// A wish: gain if a and b are both turned or both not, -gain if one is. a and b differ.
struct TurnPair {
  std::uint32_t a, b;
  std::int64_t gain;
};

/// 1, or -1 for what is turned, so that the sum of all gains is large. To find the largest sum is a hard problem (a
/// maximum cut). Here one thing after the other is placed: next comes always that with the largest sum of wishes toward
/// those already placed, the first one if there are several, and it is placed as that sum says; where the sum is 0 it
/// is not turned. Takes time like sorting the pairs.
std::vector<std::int8_t> greedy_turns(std::size_t count, std::span<const TurnPair> pairs);

}  // namespace standoff
