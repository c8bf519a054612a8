// SPDX-License-Identifier: Apache-2.0
// The functions of src/thesis in the tables of src/backends.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "field/backend.h"
#include "geometry/triangle_box.h"
#include "geometry/triple.h"
#include "standoff/mesh.h"

namespace standoff::cpu {

/// The method `thesis` on the CPU: Algorithm 1 of the 2008 thesis (docs/thesis.md). For each triangle, and each sample
/// in its box grown by the thickness, it computes the squared distance and keeps it if it is smaller.
/// Counts::samples_examined is the number of these pairs. Skipping and compaction come before (Job::kept).
Counts run_thesis(const Job& job, Sink& sink);
/// The same for other samples: those that `visited` names for a triangle, world units. They must lie in the triangle's
/// box grown by the thickness. Counts a unit of progress for each brick; the caller begins the stage.
using VisitedSamples = SampleRange(const Triple<double> (&corner)[3], const Grid& grid, double thickness);
Counts run_in_boxes(const Job& job, Sink& sink, VisitedSamples* visited);
std::int64_t thesis_scratch_bytes(const MeshLoad& mesh, const Grid& grid, double thickness, int threads);

}  // namespace standoff::cpu

namespace standoff {

/// The thesis's skip rule, `neighbour` (docs/skip.md). Goes through the mesh in order and drops a triangle if at least
/// `fraction` of its box lies in the box of its neighbour, the nearest triangle before or after it that is not dropped;
/// of two equal triangles it drops the later. Boxes are grown by `thickness` on all sides. It ends when no triangle
/// that stays could be dropped. Fraction 1 compares boxes without tolerance, grown or not. With infinite thickness,
/// boxes are not grown. Takes time linear in the number of triangles, one thread, and memory for the result only.
/// Requires a valid mesh.
std::vector<std::uint32_t> kept_by_neighbour_rule(MeshView mesh, double thickness, double fraction);

/// The share of `inner` that lies in `outer`, both grown by `margin`: 0 to 1. It is 1 if and only if all of `inner`
/// does, unless the boxes' sizes differ so much that rounding hides the rest. A flat box counts as the limit of thin
/// ones.
double share_inside(const Box& inner, const Box& outer, double margin);

}  // namespace standoff
