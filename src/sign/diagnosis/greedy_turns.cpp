// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/greedy_turns.h"

#include <cstdlib>
#include <queue>
#include <utility>

namespace standoff {
namespace {

struct Wish {
  std::uint32_t other;
  std::int64_t gain;
};

}  // namespace

std::vector<std::int8_t> greedy_turns(std::size_t count, std::span<const TurnPair> pairs) {
  std::vector<std::size_t> begin(count + 1);
  for (const TurnPair& pair : pairs) ++begin[pair.a + 1], ++begin[pair.b + 1];
  for (std::size_t n = 0; n < count; ++n) begin[n + 1] += begin[n];
  std::vector<Wish> wishes(begin[count]);
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (const TurnPair& pair : pairs) {
    wishes[next[pair.a]++] = {pair.b, pair.gain};
    wishes[next[pair.b]++] = {pair.a, pair.gain};
  }

  // The strongest sum first, then the least number. A sum that has changed meanwhile is in the queue again.
  using Entry = std::pair<std::int64_t, std::int64_t>;
  std::priority_queue<Entry> queue;
  std::vector<std::int8_t> turns(count, 1);
  std::vector<std::uint8_t> placed(count);
  std::vector<std::int64_t> sums(count);
  for (std::uint32_t first = 0; first < count; ++first) {
    if (placed[first] != 0 || begin[first] == begin[first + 1]) continue;
    queue.emplace(0, -std::int64_t{first});
    while (!queue.empty()) {
      const auto [strength, number] = queue.top();
      queue.pop();
      const auto n = static_cast<std::uint32_t>(-number);
      if (placed[n] != 0 || strength != std::abs(sums[n])) continue;
      placed[n] = 1;
      if (sums[n] < 0) turns[n] = -1;
      for (std::size_t w = begin[n]; w < begin[n + 1]; ++w) {
        const auto [other, gain] = wishes[w];
        if (placed[other] != 0) continue;
        sums[other] += turns[n] * gain;
        queue.emplace(std::abs(sums[other]), -std::int64_t{other});
      }
    }
  }
  return turns;
}

}  // namespace standoff
