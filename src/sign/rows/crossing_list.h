// SPDX-License-Identifier: Apache-2.0
// Crossings as they are found: lists in blocks that never move, of which all threads together have so many.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/progress.h"

namespace standoff {

/// Where a row of a window of rows crosses a triangle.
struct FoundCrossing {
  static constexpr int kRowBits = 23, kPastBits = 40;
  std::uint64_t bits;

  /// `row`: 64 * row of tiles + row in the tile (y + 8 z). Rows of tiles are numbered ty + tiles_y * tz, from the
  /// window's first one.
  static FoundCrossing make(std::uint64_t row, std::uint64_t past, bool enters) {
    return {row << (kPastBits + 1) | past << 1 | std::uint64_t{enters}};
  }
  std::uint64_t row() const { return bits >> (kPastBits + 1); }
  /// The first sample past the triangle.
  std::uint64_t past() const { return bits << kRowBits >> (kRowBits + 1); }
  /// Whether the row enters the solid there.
  bool enters() const { return (bits & 1) != 0; }
};

/// How many blocks may still be taken.
class BlockBudget {
 public:
  explicit BlockBudget(std::int64_t blocks) : left_(blocks) {}
  bool take() { return left_.fetch_sub(1, std::memory_order_relaxed) > 0; }
  bool is_spent() const { return left_.load(std::memory_order_relaxed) < 0; }

 private:
  std::atomic<std::int64_t> left_;
};

class CrossingList {
 public:
  static constexpr std::size_t kBlock = 4096;  ///< 32 KiB
  static constexpr std::ptrdiff_t kMostAtOnce = 64;
  using Block = std::array<FoundCrossing, kBlock>;

  explicit CrossingList(BlockBudget& budget) : budget_(&budget) {}
  /// The progress can end the work at each block.
  CrossingList(BlockBudget& budget, ProgressMeter& progress) : budget_(&budget), progress_(&progress) {}

  /// Makes room for `count` more, at most kMostAtOnce; false if the budget is spent.
  bool make_room(std::ptrdiff_t count) { return end_ - next_ >= count || take_block(); }
  /// Adds one, if it counts: where that is as likely as not, nothing depends on a guess. Requires room.
  void add(const FoundCrossing& crossing, bool counts) {
    *next_ = crossing;
    next_ += counts;
  }
  /// Calls use(crossings) for each block.
  template <class Use>
  void for_each_block(const Use& use) const {
    for (std::size_t n = 0; n < blocks_.size(); ++n)
      use(std::span<const FoundCrossing>(blocks_[n]->data(), n + 1 < blocks_.size() ? sizes_[n] : size_of_last()));
  }
  std::size_t blocks() const { return blocks_.size(); }

 private:
  std::size_t size_of_last() const { return static_cast<std::size_t>(next_ - blocks_.back()->data()); }
  bool take_block() {
    if (progress_) progress_->check();
    if (!budget_->take()) return false;
    if (!blocks_.empty()) sizes_.push_back(size_of_last());
    blocks_.push_back(std::make_unique_for_overwrite<Block>());
    next_ = blocks_.back()->data();
    end_ = next_ + kBlock;
    return true;
  }

  BlockBudget* budget_;
  ProgressMeter* progress_ = nullptr;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<std::size_t> sizes_;  // of all blocks but the last
  FoundCrossing* next_ = nullptr;
  FoundCrossing* end_ = nullptr;
};

}  // namespace standoff
