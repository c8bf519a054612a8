// SPDX-License-Identifier: Apache-2.0
// From the plan of a sign to what decides each sample.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "core/progress.h"
#include "sign/normal/nearest_triangles.h"
#include "sign/plan.h"
#include "sign/sides.h"
#include "standoff/grid.h"

namespace standoff {

/// What the sides are decided for. Only SignMethod::normal looks at thickness and nearest triangles.
struct UnsignedField {
  const Grid& grid;
  double thickness = 0;
  NearestTriangles nearest = {};
  /// What crossings may take at a time (RowCrossings) where they can be found again; bytes.
  std::int64_t crossing_bytes = std::numeric_limits<std::int64_t>::max();
};

/// What decides the sides of the field's samples by this plan; nothing where it turns out that there is no inside. What
/// the grid shows goes into the plan. Requires plan.has_sign(), and not SignMethod::shell (shell.h). The mesh and the
/// plan must stay where they are. Throws Error{interrupted, doubt}.
std::unique_ptr<Sides> make_sides(MeshView mesh, SignPlan& plan, const SignOptions& options, const UnsignedField& field,
                                  ProgressMeter& progress);

}  // namespace standoff
