// SPDX-License-Identifier: Apache-2.0
// What is decided about the sign before any distance is computed: which method, and in which orientation.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "sign/oriented_mesh.h"
#include "sign/sides.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/sign.h"

namespace standoff {

struct SignPlan {
  SignReport report;
  std::vector<std::int8_t> use;  ///< OrientedMesh::use

  bool has_sign() const { return report.method != SignMethod::none; }
};

/// Throws Error{input} where the method does not fit the mesh, Error{doubt} where it fits and `strict` forbids it.
/// Requires a valid mesh and valid options. Runs on the threads of the calling TBB arena.
SignPlan plan_sign(MeshView mesh, const SignOptions& options);

/// What decides the sides of a grid's samples by this plan. `crossing_bytes`: what may be held of crossings at a
/// time (RowCrossings), where they can be found again. Requires plan.has_sign(). Throws Error{interrupted}.
std::unique_ptr<Sides> make_sides(MeshView mesh, const SignPlan& plan, const SignOptions& options, const Grid& grid,
                                  ProgressMeter& progress,
                                  std::int64_t crossing_bytes = std::numeric_limits<std::int64_t>::max());

}  // namespace standoff
