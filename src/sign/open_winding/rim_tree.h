// SPDX-License-Identifier: Apache-2.0
// The rims in a tree of balls, so that many far ones count as one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sign/open_winding/linear_field.h"
#include "sign/open_winding/rims.h"

namespace standoff {

/// What caps add to the winding number far away: the first terms of its expansion about a point, which are sums over
/// the caps' areas. All are divided by 4 pi, and counted with the rims' weights.
struct Moments {
  Vec3 center;        ///< the centroid of the areas
  double radius = 0;  ///< all caps are within it
  Vec3 area;          ///< the sum of the areas' normals
  /// The sum of normal (x) (position - center): its symmetric part without trace, xx, yy, zz, xy, yz, zx.
  std::array<double, 6> skew = {};
  double area_norm = 0, skew_norm = 0;  ///< bounds of area, and of the sum of skew's singular values
  double total = 0;                     ///< the sum of the areas' sizes
  double inertia = 0;                   ///< the same of size * distance^2 from the center
  double near_sq = 0;                   ///< nearer than its square root, kFieldTolerance is not met
};

/// Fields of caps that are known this well in a cell are taken as they are. Some hundred of them may add up.
inline constexpr double kFieldTolerance = 1e-3;
/// What rounding leaves of a winding number that is put together from integer windings, angles and fields up to some
/// thousands.
inline constexpr double kWindingRounding = 1e-12;

/// Adds the caps' field in the cell to `sum`, whose center is that of the cell, if it is known to `tolerance` there;
/// returns whether it did. Requires tolerance <= kFieldTolerance.
bool add_far_field(const Moments& caps, const Cell& cell, double tolerance, LinearField& sum);

/// The most that the caps may add anywhere in the cell, without a look at where they face. Infinite if they are near.
double bound_of_field(const Moments& caps, const Cell& cell);

class RimTree {
 public:
  struct Node {
    Moments caps;
    std::int32_t right = 0;  ///< the second child; the first one is the next node. 0: a leaf
    std::int32_t rim = -1;   ///< of a leaf

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

}  // namespace standoff
