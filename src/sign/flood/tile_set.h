// SPDX-License-Identifier: Apache-2.0
// A set of tiles, of which each gets a number: what few tiles have takes memory for those alone.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace standoff {

/// One and a half bits for each tile that could be in the set.
class TileSet {
 public:
  explicit TileSet(std::size_t tiles) : bits_(tiles / 64 + 1), before_(bits_.size()) {}

  /// From any thread, before number_them().
  void add(std::size_t tile) {
    std::atomic_ref<std::uint64_t> word(bits_[tile / 64]);
    const std::uint64_t bit = std::uint64_t{1} << tile % 64;
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }
  /// Gives the tiles numbers, in the order of their indices.
  void number_them() {
    for (std::size_t n = 0; n < bits_.size(); ++n) {
      before_[n] = static_cast<std::uint32_t>(count_);
      count_ += static_cast<std::size_t>(std::popcount(bits_[n]));
    }
  }

  std::size_t count() const { return count_; }
  bool has(std::size_t tile) const { return (bits_[tile / 64] >> tile % 64 & 1) != 0; }
  /// The number of a tile of the set, from 0.
  std::size_t number(std::size_t tile) const {
    const std::uint64_t below = (std::uint64_t{1} << tile % 64) - 1;
    return before_[tile / 64] + static_cast<std::size_t>(std::popcount(bits_[tile / 64] & below));
  }
  /// Calls use(tile) for each, in order.
  template <class Use>
  void for_each(const Use& use) const {
    for (std::size_t n = 0; n < bits_.size(); ++n)
      for (std::uint64_t rest = bits_[n]; rest != 0; rest &= rest - 1)
        use(64 * n + static_cast<std::size_t>(std::countr_zero(rest)));
  }

 private:
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint32_t> before_;  // tiles of the set before each word
  std::size_t count_ = 0;
};

}  // namespace standoff
