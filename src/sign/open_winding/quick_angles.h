// SPDX-License-Identifier: Apache-2.0
// What all caps add to the winding number at a point, about: far ones by their fields, near ones by solid angles in
// float, sixteen at once.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sign/cpu/kernels.h"
#include "sign/open_winding/cap_sum.h"
#include "sign/open_winding/node_stack.h"
#include "sign/open_winding/rim_tree.h"
#include "sign/open_winding/rims.h"

namespace standoff {

/// Meshes of very many loose triangles have a rim for each, and few of them are far: then the sum of all is quicker
/// than a search for those that are.
class QuickAngles {
 public:
  /// Both must stay where they are. Throws Error{interrupted}.
  QuickAngles(const Rims& rims, const RimTree& tree, ProgressMeter& progress);

  /// The same as cap_sum_at(), and certain to be within the error too, which is some 1e-7 per near rim more than that
  /// of the fields. Nothing where the point is too far for float. The stack counts the work.
  std::optional<Interval> at(const Vec3& p, double tolerance, NodeStack& stack) const;

 private:
  // Of a node of the tree: the triangles of its caps, and its rims that have a weight.
  struct Range {
    std::int32_t first_triangle, past_triangle, first_weighted, past_weighted;
    std::int32_t size() const { return past_triangle - first_triangle + past_weighted - first_weighted; }
  };
  // Which rim and edge a triangle is of; edge -1: the triangle is the whole rim.
  struct Source {
    std::int32_t rim, edge;
  };
  struct Sum;

  void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Source& source);
  void add(std::int32_t node, Sum& sum) const;
  void add_angles(const Range& range, Sum& sum) const;

  const Rims& rims_;
  const RimTree& tree_;
  const cpu::SignKernels& kernels_;
  Vec3 center_;
  double scale_ = 1;           // a power of two: coordinates relative to the center are about 1 at the most
  double extent_ = 0;          // their largest, scaled
  std::vector<Range> ranges_;  // by node
  std::array<std::array<std::vector<float>, 3>, 3> corners_;
  std::vector<Source> sources_;
  std::vector<std::int32_t> weighted_;
};

}  // namespace standoff
