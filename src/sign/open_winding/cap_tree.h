// SPDX-License-Identifier: Apache-2.0
// The rims in a tree of balls, so that many far caps count as one; and the sum of all caps' angles at a point or in a
// cell, in double.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "core/threads.h"
#include "sign/open_winding/caps.h"

namespace standoff {

/// The far field of caps: the first terms of the winding number's expansion about a point, which are sums over the
/// caps' areas. All are divided by 4 pi, and multiplied by the rims' weights.
struct Moments {
  Vec3 center;             ///< the centroid of the areas
  double radius = 0;       ///< of a ball around the center that contains all caps
  double error_reach = 0;  ///< the fourth root of 3 inertia: the field is off by (error_reach / (distance - radius))^4
  Vec3 area;               ///< the sum of the areas' normals
  /// The sum of normal (x) (position - center): its symmetric part without trace, xx, yy, zz, xy, yz, zx.
  std::array<double, 6> skew = {};
  double area_norm = 0, skew_norm = 0;  ///< bound area, and the sum of skew's singular values
  double total = 0;                     ///< the sum of the areas' sizes
  double inertia = 0;                   ///< the integral of the squared distance from the center over the areas
};

/// A field of caps is used if its error in a cell is at most this. Some hundred of them may add up.
inline constexpr double kFieldTolerance = 1e-3;

/// When the field of caps is used in a cell.
class FieldTolerance {
 public:
  /// If its error in the cell is at most `error`.
  FieldTolerance(double error) : FieldTolerance(error, error) {}
  /// If its error from taking caps together is at most `error`. That of a linear function in the cell comes on top:
  /// smaller groups of caps have it as well.
  static FieldTolerance of_groups(double error) { return {error, std::numeric_limits<double>::infinity()}; }

  double in_cell() const { return in_cell_; }
  /// Whether the error from taking the caps together is too large at this distance, or they are within their radius.
  bool is_near(const Moments& caps, double distance_sq) const {
    const double near = caps.radius + caps.error_reach * reach_;
    return !(distance_sq > near * near);
  }

 private:
  FieldTolerance(double of_group, double in_cell) : reach_(1 / std::sqrt(std::sqrt(of_group))), in_cell_(in_cell) {}

  double reach_, in_cell_;
};

/// Bounds the rounding of a winding number that is the sum of integer windings, angles and fields up to some thousands.
inline constexpr double kWindingRounding = 1e-12;

/// Adds the caps' field in the cell to `sum` if the tolerance allows it; returns whether it did. Requires that `sum`
/// has the cell's center.
bool add_far_field(const Moments& caps, const Cell& cell, const FieldTolerance& tolerance, LinearField& sum);

/// A part of the winding number, and a bound of its error.
struct Interval {
  double value, error;
};

/// The caps' field at a point, if the tolerance allows it.
std::optional<Interval> far_field_at(const Moments& caps, const Vec3& p, const FieldTolerance& tolerance);

/// The most that the caps may add anywhere in the cell, whatever their directions. Infinite if they are near.
double bound_of_field(const Moments& caps, const Cell& cell);

class RimTree {
 public:
  struct Node {
    Moments caps;
    std::int32_t right = 0;  ///< the second child; the first one is the next node; 0: this is a leaf
    std::int32_t rim = -1;   ///< the rim of a leaf

    bool is_leaf() const { return right == 0; }
  };

  explicit RimTree(const Rims& rims) {
    ProgressMeter nobody;
    make(rims, nobody);
  }
  /// The progress can end it.
  RimTree(const Rims& rims, ProgressMeter& progress) { make(rims, progress); }

  /// The root is node 0, if there are rims.
  std::span<const Node> nodes() const { return nodes_; }
  const Node& operator[](std::int32_t node) const { return nodes_[static_cast<std::size_t>(node)]; }

 private:
  void make(const Rims& rims, ProgressMeter& progress);
  void build(std::span<std::int32_t> rims, std::span<const Moments> moments, WorkCheck& check);

  std::vector<Node> nodes_;
};

/// The number of visits of rims and nodes between two checks of the progress.
inline constexpr std::int64_t kLooks = 1 << 15;

/// The nodes of the tree whose caps are not summed up yet, for cells within cells: a field that is good enough in a
/// cell is good enough in its parts. On a stack, the nodes of a cell's parts follow the nodes of the cell.
class NodeStack {
 public:
  struct Part {
    std::size_t begin, end;
  };

  /// Every sum of caps takes a stack: it counts the work, and may stop it.
  NodeStack(const RimTree& tree, WorkCheck& check) : tree_(tree), check_(check) {
    nodes_.clear();
    if (!tree.nodes().empty()) nodes_.push_back(0);
  }

  /// All caps.
  Part root() const { return {0, tree_.nodes().empty() ? std::size_t{0} : std::size_t{1}}; }
  std::int32_t operator[](std::size_t n) const { return nodes_[n]; }
  void set(std::size_t n, std::int32_t node) { nodes_[n] = node; }
  std::size_t size() const { return nodes_.size(); }
  /// Counts visits of rims and nodes: some 10 to 300 ns each. Throws Error{interrupted}.
  void count(std::size_t visits) { check_.add(static_cast<std::int64_t>(visits)); }
  void resize(std::size_t size) { nodes_.resize(size); }

  /// Moves the places of `part` for which is_first(place) to its begin; returns their end.
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

  /// Adds the fields of nodes of `part` that the tolerance allows, and returns the others, on top of the stack. Opens
  /// nodes that are not smaller than `open_above`: with 0, all others are leaves.
  Part add_far(Part part, const Cell& cell, const FieldTolerance& tolerance, double open_above, LinearField& sum) {
    const std::size_t begin = nodes_.size();
    for (std::size_t n = part.begin; n < part.end; ++n) add_far(nodes_[n], cell, tolerance, open_above, sum);
    return {begin, nodes_.size()};
  }

  /// The same with all others opened: nothing, and no more nodes than before, if they are more than `most`, or if the
  /// error of the fields is more than 1/2.
  std::optional<Part> add_far_up_to(std::size_t most, Part part, const Cell& cell, const FieldTolerance& tolerance,
                                    LinearField& sum) {
    const std::size_t begin = nodes_.size();
    for (std::size_t n = part.begin; n < part.end; ++n)
      if (!add_far_up_to(begin + most, nodes_[n], cell, tolerance, sum)) {
        nodes_.resize(begin);
        return {};
      }
    return Part{begin, nodes_.size()};
  }

 private:
  void add_far(std::int32_t node, const Cell& cell, const FieldTolerance& tolerance, double open_above,
               LinearField& sum) {
    count(1);
    const RimTree::Node& caps = tree_[node];
    if (add_far_field(caps.caps, cell, tolerance, sum)) return;
    if (caps.is_leaf() || caps.caps.radius < open_above) return nodes_.push_back(node);
    add_far(node + 1, cell, tolerance, open_above, sum);
    add_far(caps.right, cell, tolerance, open_above, sum);
  }
  bool add_far_up_to(std::size_t most_nodes, std::int32_t node, const Cell& cell, const FieldTolerance& tolerance,
                     LinearField& sum) {
    count(1);
    const RimTree::Node& caps = tree_[node];
    if (add_far_field(caps.caps, cell, tolerance, sum)) return sum.error <= 0.5;
    if (!caps.is_leaf())
      return add_far_up_to(most_nodes, node + 1, cell, tolerance, sum) &&
             add_far_up_to(most_nodes, caps.right, cell, tolerance, sum);
    nodes_.push_back(node);
    return nodes_.size() <= most_nodes;
  }

  const RimTree& tree_;
  WorkCheck& check_;
  const KeptByThread<std::vector<std::int32_t>> kept_;
  std::vector<std::int32_t>& nodes_ = *kept_;
};

/// The sum of all caps' angles at a point. Uses fields of far caps whose error is at most `tolerance`; with 0, only
/// rounding is left.
Interval cap_sum_at(const Rims& rims, const RimTree& tree, const Vec3& p, double tolerance, NodeStack& stack);

/// The sum as a linear function in a cell; each part is continued across its caps if the cell contains them. Uses
/// fields of far caps that the tolerance allows. The error is infinite, or any number above `most`, if an edge of a rim
/// is near, or if the error cannot be made smaller.
LinearField cap_sum_in(const Rims& rims, const RimTree& tree, const Cell& cell, const FieldTolerance& tolerance,
                       double most, WorkCheck& check);

/// Adds the angles of the caps of these nodes, all leaves, to `sum`.
Interval add_angles(const Rims& rims, const RimTree& tree, const Vec3& p, NodeStack& stack, NodeStack::Part leaves,
                    Interval sum);

}  // namespace standoff
