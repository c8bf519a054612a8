// SPDX-License-Identifier: Apache-2.0
// A tree of boxes over items in an order in which near ones are near: level n has a box for each kBranch boxes of the
// level below. No pointers: children are found by number.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "standoff/vec.h"

namespace standoff {

inline bool overlap(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

/// The squared distance from p to a box, 0 within.
inline double distance_sq(const Box& box, const Vec3& p) {
  const Vec3 outside = max(max(box.min - p, p - box.max), Vec3{});
  return dot(outside, outside);
}

class BoxTree {
 public:
  static constexpr std::size_t kBranch = 4;

  explicit BoxTree(std::vector<Box> boxes) {
    levels_.push_back(std::move(boxes));
    while (levels_.back().size() > 1) {
      const std::vector<Box>& below = levels_.back();
      std::vector<Box> level((below.size() + kBranch - 1) / kBranch);
      for (std::size_t n = 0; n < below.size(); ++n) {
        Box& box = level[n / kBranch];
        box.min = min(box.min, below[n].min);
        box.max = max(box.max, below[n].max);
      }
      levels_.push_back(std::move(level));
    }
  }

  /// Calls visit(other) for all items after `item` whose boxes overlap that of `item`, until it returns false. Each box
  /// compared with that of `item` takes one from `boxes`; returns false if it was stopped, or none was left.
  template <class Visit>
  bool for_each_later_overlap(std::size_t item, std::int64_t& boxes, const Visit& visit) const {
    return search(levels_.size() - 1, 0, item, levels_[0][item], boxes, visit);
  }
  /// Calls visit(item) for all items whose boxes are not farther from p than the root of most_sq, near ones first.
  /// Visit may lower most_sq.
  template <class Visit>
  void for_each_within(const Vec3& p, const double& most_sq, const Visit& visit) const {
    if (!levels_[0].empty()) search_near(levels_.size() - 1, 0, p, most_sq, visit);
  }
  /// Calls visit(item) for all items whose boxes overlap this one.
  template <class Visit>
  void for_each_overlap(const Box& box, const Visit& visit) const {
    search_all(levels_.size() - 1, 0, box, visit);
  }

 private:
  template <class Visit>
  void search_all(std::size_t level, std::size_t node, const Box& box, const Visit& visit) const {
    if (!overlap(levels_[level][node], box)) return;
    if (level == 0) return visit(node);
    const std::size_t past = std::min(kBranch * (node + 1), levels_[level - 1].size());
    for (std::size_t child = kBranch * node; child < past; ++child) search_all(level - 1, child, box, visit);
  }
  template <class Visit>
  bool search(std::size_t level, std::size_t node, std::size_t item, const Box& box, std::int64_t& boxes,
              const Visit& visit) const {
    if (--boxes < 0) return false;
    if (!overlap(levels_[level][node], box)) return true;
    if (level == 0) return node <= item || visit(node);
    const std::size_t below = level - 1, first = kBranch * node,
                      past = std::min(first + kBranch, levels_[below].size());
    // All items below child n come before item (n + 1) kBranch^below.
    for (std::size_t child = first; child < past; ++child)
      if ((child + 1) << 2 * below > item + 1 && !search(below, child, item, box, boxes, visit)) return false;
    return true;
  }
  static_assert(kBranch == 1 << 2);

  template <class Visit>
  void search_near(std::size_t level, std::size_t node, const Vec3& p, const double& most_sq,
                   const Visit& visit) const {
    if (level == 0) return visit(node);
    const std::vector<Box>& below = levels_[level - 1];
    std::array<std::pair<double, std::size_t>, kBranch> children;
    std::size_t count = 0;
    for (std::size_t child = kBranch * node; child < std::min(kBranch * (node + 1), below.size()); ++child)
      children[count++] = {distance_sq(below[child], p), child};
    std::sort(children.begin(), children.begin() + count);
    for (std::size_t n = 0; n < count && children[n].first <= most_sq; ++n)
      search_near(level - 1, children[n].second, p, most_sq, visit);
  }

  std::vector<std::vector<Box>> levels_;  // the items first
};

}  // namespace standoff
