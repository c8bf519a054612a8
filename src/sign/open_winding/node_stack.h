// SPDX-License-Identifier: Apache-2.0
// Which caps are not summed up yet, for cells within cells: what is known well enough in a cell is known in its parts.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "sign/open_winding/linear_field.h"
#include "sign/open_winding/rim_tree.h"

namespace standoff {

/// Looks at rims and nodes between two checks of the progress.
inline constexpr std::int64_t kLooks = 1 << 15;

/// Nodes of the tree whose caps are not in a field yet, on a stack: a cell's nodes are followed by those of its parts.
class NodeStack {
 public:
  struct Part {
    std::size_t begin, end;
  };

  /// All sums of caps are made with a stack at hand: it counts their work, and may stop it.
  NodeStack(const RimTree& tree, WorkCheck& check) : tree_(tree), check_(check) {
    if (!tree.nodes().empty()) nodes_.push_back(0);
  }

  /// All caps.
  Part root() const { return {0, tree_.nodes().empty() ? std::size_t{0} : std::size_t{1}}; }
  std::int32_t operator[](std::size_t n) const { return nodes_[n]; }
  void set(std::size_t n, std::int32_t node) { nodes_[n] = node; }
  std::size_t size() const { return nodes_.size(); }
  /// Counts looks at rims and nodes: some 10 to 300 ns each. Throws Error{interrupted}.
  void count(std::size_t looks) { check_.add(static_cast<std::int64_t>(looks)); }
  void resize(std::size_t size) { nodes_.resize(size); }

  /// Moves the places of `part` for which is_first(place) to its begin; returns where they end.
  template <class IsFirst>
  std::size_t partition(Part part, const IsFirst& is_first) {
    std::size_t end = part.begin;
    for (std::size_t n = part.begin; n < part.end; ++n)
      if (is_first(n)) std::swap(nodes_[n], nodes_[end++]);
    return end;
  }

  /// The most that the caps of these nodes may add anywhere in the cell; infinite, or any number above `enough`.
  double bound_of(Part part, const Cell& cell, double enough) {
    count(part.end - part.begin);
    double sum = 0;
    for (std::size_t n = part.begin; n < part.end && sum <= enough; ++n)
      sum += bound_of_field(tree_[nodes_[n]].caps, cell);
    return sum;
  }

  /// Adds the fields of those nodes of `part` that are known to `tolerance` in the cell, and returns the others: larger
  /// ones than `open_above` are opened. They are on top of the stack.
  Part add_far(Part part, const Cell& cell, double tolerance, double open_above, LinearField& sum) {
    const std::size_t begin = nodes_.size();
    for (std::size_t n = part.begin; n < part.end; ++n) add_far(nodes_[n], cell, tolerance, open_above, sum);
    return {begin, nodes_.size()};
  }

 private:
  void add_far(std::int32_t node, const Cell& cell, double tolerance, double open_above, LinearField& sum) {
    count(1);
    const RimTree::Node& caps = tree_[node];
    if (add_far_field(caps.caps, cell, tolerance, sum)) return;
    if (caps.is_leaf() || caps.caps.radius <= open_above) return nodes_.push_back(node);
    add_far(node + 1, cell, tolerance, open_above, sum);
    add_far(caps.right, cell, tolerance, open_above, sum);
  }

  const RimTree& tree_;
  WorkCheck& check_;
  std::vector<std::int32_t> nodes_;
};

}  // namespace standoff
