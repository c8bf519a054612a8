// SPDX-License-Identifier: Apache-2.0
// The sum of very many caps' angles at a point, as finely as it is needed: far caps by their fields, near ones by solid
// angles in float, sixteen at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "sign/cpu/kernels.h"
#include "sign/open_winding/cap_tree.h"

namespace standoff {

/// The triangles of all caps in float, in the order of the tree.
class QuickAngles {
 public:
  /// Rims and tree must stay where they are. Throws Error{interrupted}.
  QuickAngles(const Rims& rims, const RimTree& tree, ProgressMeter& progress);

 private:
  friend class PointSum;

  // The triangles of a node's caps, and its rims with a weight other than 1.
  struct Range {
    std::int32_t first_triangle, past_triangle, first_weighted, past_weighted;
    std::int32_t size() const { return past_triangle - first_triangle + past_weighted - first_weighted; }
  };
  // The rim and the edge of a triangle; edge -1: the triangle is the whole rim.
  struct Source {
    std::int32_t rim, edge;
  };

  void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Source& source);

  const Rims& rims_;
  const RimTree& tree_;
  const cpu::SignKernels& kernels_;
  Vec3 center_;
  double scale_ = 1;           // a power of two: coordinates relative to the center are about 1 at most
  double extent_ = 0;          // the largest scaled coordinate
  std::vector<Range> ranges_;  // by node
  std::array<std::array<std::vector<float>, 3>, 3> corners_;
  std::vector<Source> sources_;
  std::vector<std::int32_t> weighted_;
};

/// The sum of all caps' angles at one point after another. Most decisions need it roughly, so it is made finer step by
/// step, and what was found before is kept.
class PointSum {
 public:
  /// The caps must stay where they are. The stack counts the work.
  PointSum(const QuickAngles& caps, NodeStack& stack) : caps_(caps), stack_(stack) {}

  /// Begins at a point, with the nodes of caps that are to be summed up, and what all others add there. False if the
  /// point is too far away for float.
  bool begin(const Vec3& p, NodeStack::Part nodes, const Interval& others);
  /// The sum with fields whose errors are at most `tolerance` each, smaller than the last time. Its error is that of
  /// the fields and of the others, and about 1e-7 for each near triangle.
  Interval refine(double tolerance);

 private:
  // A node whose field is in the sum; or, with an infinite error, one that was not looked at yet.
  struct Field {
    double value, error;
    std::int32_t node;
  };

  void add(std::int32_t node, const FieldTolerance& tolerance);
  void open(std::int32_t node, const FieldTolerance& tolerance);
  void add_angles(const QuickAngles::Range& range);

  const QuickAngles& caps_;
  NodeStack& stack_;
  Vec3 point_;
  std::array<float, 3> local_;
  double coordinates_;  // bounds the scaled coordinates of triangles and point together
  std::vector<Field> fields_, before_;
  cpu::AngleSums angles_;
  double angle_error_;  // in full turns
  Interval sum_;        // of all others, and of triangles and rims that are summed up one by one
};

}  // namespace standoff
