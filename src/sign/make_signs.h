// SPDX-License-Identifier: Apache-2.0
// Makes the SampleSigns of a planned sign.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "core/progress.h"
#include "sign/normal/nearest_triangles.h"
#include "sign/plan.h"
#include "sign/signs.h"
#include "standoff/grid.h"

namespace standoff {

/// The field that needs a sign. Only SignMethod::normal looks at thickness and nearest triangles.
struct UnsignedField {
  const Grid& grid;
  double thickness = 0;
  NearestTriangles nearest = {};
  /// The bytes that crossings may take at a time (RowCrossings) where they can be found again.
  std::int64_t crossing_bytes = std::numeric_limits<std::int64_t>::max();
};

/// The method of the plan for the field's samples; nothing if there is no inside after all. Reports in the plan what
/// the grid shows. Requires plan.has_sign(), and not SignMethod::shell (Shell). The mesh and the plan must stay where
/// they are. Throws Error{interrupted, doubt}.
std::unique_ptr<SampleSigns> make_signs(MeshView mesh, SignPlan& plan, const SignOptions& options,
                                        const UnsignedField& field, ProgressMeter& progress);

}  // namespace standoff
