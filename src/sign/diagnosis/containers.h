// SPDX-License-Identifier: Apache-2.0
// Which boxes contain a box. Boxes that each contain the next one are kept as chains, which share what they have in
// common: so thousands of nested shells take linear memory and time.
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

/// Chains of numbers, each above the one before it. Chains are equal if and only if their numbers are.
class Chains {
 public:
  static constexpr std::uint32_t kEmpty = 0;

  /// The chain of `below` and then `last`.
  std::uint32_t with(std::uint32_t below, std::uint32_t last) {
    const auto [place, is_new] =
        numbers_.try_emplace(std::uint64_t{below} << 32 | last, static_cast<std::uint32_t>(links_.size()));
    if (is_new) links_.push_back({below, last, links_[below].length + 1});
    return place->second;
  }
  std::int32_t length(std::uint32_t chain) const { return links_[chain].length; }
  /// The greatest number; of a chain that is not empty.
  std::uint32_t last(std::uint32_t chain) const { return links_[chain].last; }
  std::uint32_t without_last(std::uint32_t chain) const { return links_[chain].below; }
  /// How many chains were made.
  std::size_t count() const { return links_.size(); }

 private:
  struct Link {
    std::uint32_t below, last;
    std::int32_t length;
  };
  std::vector<Link> links_ = {{kEmpty, 0, 0}};
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
};

/// A set of numbers: those of a chain, and then greater ones from a list.
struct Containers {
  std::uint32_t chain = Chains::kEmpty, listed = 0;
  std::size_t first = 0;  ///< where in the list
};

/// The boxes of parts that a point is in, while it moves.
class Around {
 public:
  Around(const BoxOrder& order, Chains& chains) : order_(order), chains_(chains) {}

  void clear() {
    inside_.clear();
    nested_.clear();
  }
  void enter(std::uint32_t n) { inside_.insert(cut_at(n), n); }
  void leave(std::uint32_t n) { inside_.erase(cut_at(n)); }

  /// Those whose box contains that of n. Appends to the list, and adds the work done to `steps`.
  Containers containing(std::uint32_t n, std::vector<std::uint32_t>& list, std::int64_t& steps) {
    const auto before = static_cast<std::size_t>(std::ranges::lower_bound(inside_, n) - inside_.begin());
    for (std::size_t next = nested_.size(); next < before; ++next, ++steps) {
      if (next > 0 && !order_.is_larger(inside_[next - 1], inside_[next])) break;
      nested_.push_back(chains_.with(next > 0 ? nested_.back() : Chains::kEmpty, inside_[next]));
    }
    // What contains a box that contains n contains it too.
    std::size_t most = std::min(before, nested_.size());
    for (; most > 0 && !order_.is_larger(inside_[most - 1], n); ++steps) --most;
    Containers found{most > 0 ? nested_[most - 1] : Chains::kEmpty, 0, list.size()};
    for (std::size_t next = nested_.size(); next < before; ++next, ++steps)
      if (order_.is_larger(inside_[next], n)) list.push_back(inside_[next]);
    found.listed = static_cast<std::uint32_t>(list.size() - found.first);
    return found;
  }

 private:
  std::vector<std::uint32_t>::iterator cut_at(std::uint32_t n) {
    const auto place = std::ranges::lower_bound(inside_, n);
    nested_.resize(std::min(nested_.size(), static_cast<std::size_t>(place - inside_.begin())));
    return place;
  }

  const BoxOrder& order_;
  Chains& chains_;
  std::vector<std::uint32_t> inside_;  // in the order of the boxes
  std::vector<std::uint32_t> nested_;  // chains of its first members, as far as each contains the next
};

}  // namespace standoff
