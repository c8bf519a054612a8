// SPDX-License-Identifier: Apache-2.0
#include "sign/plan.h"

#include <cmath>
#include <string>
#include <utility>

#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/diagnose.h"
#include "standoff/error.h"

namespace standoff {

void validate(const SignOptions& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  const auto is = [&](SignMethod method) { return options.method == method; };
  // Reject numbers that were cast to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  if (!one_of(options.method, SignMethod::automatic) || !one_of(options.rule, WindingRule::odd))
    fail("there is no such sign method or winding rule; take one of enum SignMethod and of WindingRule");
  if (options.rule != WindingRule::positive && !is(SignMethod::winding) && !is(SignMethod::automatic))
    fail("a winding rule is for the sign methods winding and automatic; leave it out");
  if (options.invert && is(SignMethod::none)) fail("a field without a sign cannot be inverted; choose a sign method");
  if (options.as_oriented &&
      (is(SignMethod::none) || is(SignMethod::parity) || is(SignMethod::flood) || is(SignMethod::shell)))
    fail("this sign method does not look at the orientation of triangles; leave out that it is taken as it is");
  if (options.strict && is(SignMethod::none))
    fail("a field without a sign has none to be strict about; choose a sign method");
  if (options.outer && !is(SignMethod::winding) && !is(SignMethod::automatic))
    fail("outer is for the sign methods winding and automatic; leave it out");
  if (is(SignMethod::shell) && !(options.shell > 0 && std::isfinite(options.shell)))
    fail("the thickness of a shell must be positive and finite; give it in world units");
  if (!is(SignMethod::shell) && options.shell != 0)
    fail("a shell's thickness is for the sign method shell; leave it out");
}

namespace {

[[noreturn]] void fail_at_plan(const std::string& what) { throw Error(ErrorCode::input, "compute: " + what); }

void take(SignPlan& plan, Orientation orientation, Boundary boundary) {
  plan.use = std::move(orientation.use);
  plan.boundary = std::move(boundary);
  plan.report.flipped = orientation.flipped;
  plan.report.left_out = orientation.left_out;
  plan.report.boundary_edges = static_cast<std::int64_t>(plan.boundary.edges.size());
}

void orient_for(SignPlan& plan, MeshView mesh) {
  const MeshEdges edges(mesh);
  Orientation found = orient(mesh, edges);
  Boundary boundary = net_boundary({mesh, found.use}, edges);
  take(plan, std::move(found), std::move(boundary));
}

void plan_parity(SignPlan& plan, const Closed& closed) {
  if (!closed.unoriented)
    fail_at_plan(
        "the mesh is not closed (some edge belongs to an odd number of triangles), so crossings have no parity; repair "
        "the mesh, or take the sign method winding or flood");
  plan.report.why = "each edge has an even number of triangles";
}

void take_as_it_is(SignPlan& plan, MeshView mesh) {
  take(plan, {}, net_boundary({mesh}, MeshEdges(mesh)));
  plan.report.sure = false;
  plan.report.why = "the mesh is open as it is oriented (" + counted(plan.report.boundary_edges, "edge", "edges") +
                    " do not cancel), so the generalised winding number decides";
}

void plan_winding(SignPlan& plan, MeshView mesh, const Closed& closed, const SignOptions& options,
                  ProgressMeter& progress) {
  // Skip the diagnosis, as most meshes need none.
  if (closed.oriented && (options.as_oriented || faces_outwards(mesh))) {
    plan.report.method = SignMethod::winding;
    plan.report.why = "the mesh is closed and consistently oriented";
    return;
  }
  if (options.as_oriented && options.method == SignMethod::winding) return take_as_it_is(plan, mesh);
  Diagnosis found = diagnose(mesh, MeshEdges(mesh, progress), progress);
  const bool fits = found.report.method == SignMethod::winding;
  plan.report.sure = found.report.sure;
  plan.report.why = found.report.why;
  if (options.method == SignMethod::automatic) {
    plan.report.method = found.report.method;
    plan.report.boundary_edges = found.report.boundary_edges;
    if (!fits) return;
    if (options.as_oriented) return take_as_it_is(plan, mesh);
  } else if (!fits) {
    plan.report.sure = false;
    plan.report.why = "the generalised winding number decides, although " + found.report.why;
  }
  take(plan, std::move(found.orientation), std::move(found.boundary));
}

void plan_normal(SignPlan& plan, MeshView mesh, const Closed& closed, const SignOptions& options) {
  if (!options.as_oriented && !(closed.oriented && faces_outwards(mesh))) orient_for(plan, mesh);
  plan.report.sure = false;  // it is right only where no parts overlap and no two faces are one
  plan.report.why = "front and back of the nearest triangle decide";
}

void plan_flood(SignPlan& plan, const Closed& closed) {
  plan.report.sure = closed.unoriented;
  plan.report.why = plan.report.sure ? "the mesh is closed" : "outside is what a flood reaches; the mesh has gaps";
}

}  // namespace

void expect_sure(const SignPlan& plan, const SignOptions& options) {
  if (!options.strict || plan.report.sure) return;
  throw Error(ErrorCode::doubt, "compute: the sign is not certain (" + plan.report.why +
                                    "), and strict allows no doubt; repair the mesh, or allow it");
}

bool needs_diagnosis(MeshView mesh, const SignOptions& options) {
  const SignMethod method = options.method;
  if (method == SignMethod::normal) return true;
  if (method != SignMethod::winding && method != SignMethod::automatic) return false;
  return options.outer || !is_closed(mesh).oriented || !(options.as_oriented || faces_outwards(mesh));
}

SignPlan plan_sign(MeshView mesh, const SignOptions& options, ProgressMeter& progress) {
  SignPlan plan;
  plan.report.method = options.method;
  if (options.method == SignMethod::none) return plan;
  if (options.method == SignMethod::shell) {
    plan.report.why = "the mesh is a sheet of that thickness";
    return plan;
  }
  const Closed closed = is_closed(mesh);
  progress.check();
  switch (options.method) {
    case SignMethod::parity:
      plan_parity(plan, closed);
      break;
    case SignMethod::normal:
      plan_normal(plan, mesh, closed, options);
      break;
    case SignMethod::flood:
      plan_flood(plan, closed);
      break;
    default:
      plan_winding(plan, mesh, closed, options, progress);
  }
  expect_sure(plan, options);
  return plan;
}

}  // namespace standoff
