// SPDX-License-Identifier: Apache-2.0
// Sets of boxes that contain a box. Sets are equal if and only if their numbers are, and a long one that grows takes no
// more memory than what is new: so thousands of nested shells take linear time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "standoff/vec.h"

namespace standoff {

inline bool contains(const Box& outer, const Box& inner) {
  return outer.min.x <= inner.min.x && outer.min.y <= inner.min.y && outer.min.z <= inner.min.z &&
         outer.max.x >= inner.max.x && outer.max.y >= inner.max.y && outer.max.z >= inner.max.z;
}

/// Boxes in an order in which what contains another one comes first; of equal ones the first contains the others.
class BoxOrder {
 public:
  explicit BoxOrder(std::vector<Box> sorted) : boxes_(std::move(sorted)) {}
  const Box& operator[](std::uint32_t n) const { return boxes_[n]; }
  std::size_t size() const { return boxes_.size(); }
  bool is_larger(std::uint32_t outer, std::uint32_t inner) const {
    return outer < inner && contains(boxes_[outer], boxes_[inner]);
  }

 private:
  std::vector<Box> boxes_;
};

/// Sets of numbers, each made of a smaller one and a number above all of its members.
class Sets {
 public:
  static constexpr std::uint32_t kEmpty = 0;

  /// The set of `below` and `member`.
  std::uint32_t with(std::uint32_t below, std::uint32_t member) {
    const auto [place, is_new] =
        numbers_.try_emplace(std::uint64_t{below} << 32 | member, static_cast<std::uint32_t>(sets_.size()));
    if (is_new) sets_.push_back({below, member, sets_[below].size + 1});
    return place->second;
  }
  std::int32_t size(std::uint32_t set) const { return sets_[set].size; }
  /// The greatest one; of a set that is not empty.
  std::uint32_t last(std::uint32_t set) const { return sets_[set].last; }
  std::uint32_t without_last(std::uint32_t set) const { return sets_[set].below; }
  /// How many sets were made.
  std::size_t count() const { return sets_.size(); }

 private:
  struct Set {
    std::uint32_t below, last;
    std::int32_t size;
  };
  std::vector<Set> sets_ = {{kEmpty, 0, 0}};
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
};

/// The boxes of parts that a point is in, while it moves.
class Around {
 public:
  Around(const BoxOrder& order, Sets& sets) : order_(order), sets_(sets) {}

  void clear() {
    inside_.clear();
    nested_.clear();
  }
  void enter(std::uint32_t n) { inside_.insert(cut_at(n), n); }
  void leave(std::uint32_t n) { inside_.erase(cut_at(n)); }

  /// Those whose box contains that of n. `steps` is increased by the work done.
  std::uint32_t containing(std::uint32_t n, std::int64_t& steps) {
    const auto before = static_cast<std::size_t>(std::ranges::lower_bound(inside_, n) - inside_.begin());
    for (std::size_t next = nested_.size(); next < before; ++next, ++steps) {
      if (next > 0 && !order_.is_larger(inside_[next - 1], inside_[next])) break;
      nested_.push_back(sets_.with(next > 0 ? nested_.back() : Sets::kEmpty, inside_[next]));
    }
    // The nested ones: what contains a box that contains n contains it too.
    std::size_t most = std::min(before, nested_.size());
    for (; most > 0 && !order_.is_larger(inside_[most - 1], n); ++steps) --most;
    std::uint32_t set = most > 0 ? nested_[most - 1] : Sets::kEmpty;
    for (std::size_t next = nested_.size(); next < before; ++next, ++steps)
      if (order_.is_larger(inside_[next], n)) set = sets_.with(set, inside_[next]);
    return set;
  }

 private:
  std::vector<std::uint32_t>::iterator cut_at(std::uint32_t n) {
    const auto place = std::ranges::lower_bound(inside_, n);
    nested_.resize(std::min(nested_.size(), static_cast<std::size_t>(place - inside_.begin())));
    return place;
  }

  const BoxOrder& order_;
  Sets& sets_;
  std::vector<std::uint32_t> inside_;  // in the order of the boxes
  std::vector<std::uint32_t> nested_;  // the sets of its first members, as far as each contains the next
};

}  // namespace standoff
