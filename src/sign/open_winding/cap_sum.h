// SPDX-License-Identifier: Apache-2.0
// What the caps of an open mesh add to its winding number at a point.
#pragma once

#include "sign/open_winding/node_stack.h"
#include "sign/open_winding/rim_tree.h"
#include "sign/open_winding/rims.h"

namespace standoff {

/// A part of the winding number, and how far it may be off.
struct Interval {
  double value, error;
};

/// What all caps add at a point. Fields of far caps are used where they are known to `tolerance`; with 0, only rounding
/// is left.
Interval cap_sum_at(const Rims& rims, const RimTree& tree, const Vec3& p, double tolerance, NodeStack& stack);

/// The same as a linear function in a cell, each part continued across its caps if they are in the cell. Fields of far
/// caps are used where they are known to `tolerance`, at most kFieldTolerance. The error is infinite, or any number
/// above `most`, if an edge of a rim is near, or if it cannot be made smaller than that.
LinearField cap_sum_in(const Rims& rims, const RimTree& tree, const Cell& cell, double tolerance, double most,
                       WorkCheck& check);

/// `sum` and what the caps of these nodes, all leaves, add.
Interval add_angles(const Rims& rims, const RimTree& tree, const Vec3& p, NodeStack& stack, NodeStack::Part leaves,
                    Interval sum);

}  // namespace standoff
