// SPDX-License-Identifier: Apache-2.0
#include "sign/outer/outer.h"

#include <string>
#include <utility>

#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "sign/options.h"
#include "sign/outer/exposed.h"
#include "standoff/error.h"
#include "standoff/exposed.h"

namespace standoff {
namespace {

void expect_closed(const SignPlan& plan, const char* who) {
  if (plan.report.method == SignMethod::winding && plan.report.boundary_edges == 0) return;
  throw Error(ErrorCode::input,
              std::string(who) + ": the mesh is not closed (" + plan.report.why +
                  "), so no triangle can be told to be inside it; repair the mesh, or take all its triangles");
}

}  // namespace

void plan_outer(MeshView mesh, const SignOptions& options, SignPlan& plan, ProgressMeter& progress) {
  expect_closed(plan, "outer");
  const Exposures found = find_exposed({mesh, plan.use}, options.rule, progress);
  plan.report.internal = found.internal;
  plan.report.cut = found.cut;
  if (found.internal == 0) return;
  plan.exposed.reserve(found.of.size() - static_cast<std::size_t>(found.internal));
  for (std::uint32_t t = 0; t < found.of.size(); ++t)
    if (found.of[t] != Exposure::internal) plan.exposed.push_back(t);
}

ExposedTriangles exposed_triangles(MeshView mesh, const SignOptions& sign, const Execution& execution) try {
  validate("exposed", execution, Runs::on_the_cpu);
  validate(sign);
  if (sign.method != SignMethod::winding && sign.method != SignMethod::automatic)
    throw Error(ErrorCode::usage, "exposed: inside must be by the winding number; take the sign method winding");
  validate(mesh);
  return Threads(execution.threads).run([&] {
    ProgressMeter unwatched;
    SignPlan plan = plan_sign(mesh, sign, unwatched);
    expect_closed(plan, "exposed");
    Exposures found = find_exposed({mesh, plan.use}, sign.rule, unwatched);
    plan.report.internal = found.internal;
    plan.report.cut = found.cut;
    return ExposedTriangles{std::move(found.of), found.internal, found.cut, std::move(plan.report)};
  });
} catch (...) {
  throw_as_error("exposed", "provide more memory");
}

}  // namespace standoff
