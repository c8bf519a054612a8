// SPDX-License-Identifier: Apache-2.0
// What is decided about the sign before any distance is computed: which method, and in which orientation.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "sign/nearest_triangles.h"
#include "sign/oriented_mesh.h"
#include "sign/sides.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/sign.h"

namespace standoff {

/// The name of a method in options and in the provenance of fields; empty for none.
const char* name_of(SignMethod method);

struct SignPlan {
  SignReport report;
  std::vector<std::int8_t> use;  ///< OrientedMesh::use

  bool has_sign() const { return report.method != SignMethod::none; }
};

/// Throws Error{input} where the method does not fit the mesh, Error{doubt} where it fits and `strict` forbids it.
/// Requires a valid mesh and valid options. Runs on the threads of the calling TBB arena.
SignPlan plan_sign(MeshView mesh, const SignOptions& options);

/// What decides the sides of a grid's samples by this plan. `thickness` and `nearest` are the field's; only
/// SignMethod::normal needs nearest triangles. Requires plan.has_sign(), and not SignMethod::shell (shell.h). Throws
/// Error{interrupted}.
std::unique_ptr<Sides> make_sides(MeshView mesh, const SignPlan& plan, const SignOptions& options, const Grid& grid,
                                  double thickness, const NearestTriangles& nearest, ProgressMeter& progress);

}  // namespace standoff
