// SPDX-License-Identifier: Apache-2.0
#include "sign/plan.h"

#include <string>

#include "sign/closed.h"
#include "sign/integer_winding.h"
#include "standoff/error.h"

namespace standoff {

SignPlan plan_sign(MeshView mesh, const SignOptions& options) {
  SignPlan plan;
  plan.report.method = options.method;
  if (options.method == SignMethod::none) return plan;
  const Closed closed = is_closed(mesh);
  if (options.method == SignMethod::parity ? closed.unoriented : closed.oriented) return plan;
  if (!closed.unoriented)
    throw Error(
        ErrorCode::input,
        "compute: the mesh is not closed (some edge belongs to an odd number of triangles), so it has no inside; "
        "repair the mesh, or leave out the sign");
  throw Error(ErrorCode::input,
              "compute: neighbouring triangles of the mesh are not oriented alike, so its winding number is no "
              "integer; orient the mesh, or take the sign method parity");
}

std::unique_ptr<Sides> make_sides(MeshView mesh, const SignPlan& plan, const SignOptions& options, const Grid& grid,
                                  ProgressMeter& progress, std::int64_t crossing_bytes) {
  const WindingRule rule = plan.report.method == SignMethod::parity ? WindingRule::odd : options.rule;
  return std::make_unique<IntegerWinding>(OrientedMesh{mesh, plan.use}, grid, rule, progress, crossing_bytes);
}

}  // namespace standoff
