// SPDX-License-Identifier: Apache-2.0
#include "sign/methods.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/diagnose.h"
#include "sign/flood/flood.h"
#include "sign/normal/normal_signs.h"
#include "sign/open_winding/open_winding.h"
#include "sign/rows/row_crossings.h"
#include "standoff/error.h"

namespace standoff {

// How each method is planned.

SignPlan plan_of_closed(SignMethod method) {
  SignPlan plan;
  plan.report.method = method;
  plan.report.why = method == SignMethod::parity ? "each edge has an even number of triangles"
                                                 : "the mesh is closed and consistently oriented";
  return plan;
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

void plan_nothing(SignPlan&, MeshView, const SignOptions&, ProgressMeter&) {}

Closed closed_of(MeshView mesh, ProgressMeter& progress) {
  const Closed closed = is_closed(mesh);
  progress.check();
  return closed;
}

void plan_parity(SignPlan& plan, MeshView mesh, const SignOptions&, ProgressMeter& progress) {
  if (!closed_of(mesh, progress).unoriented)
    fail_at_plan(
        "the mesh is not closed (some edge belongs to an odd number of triangles), so crossings have no parity; repair "
        "the mesh, or take the sign method winding or flood");
  plan = plan_of_closed(SignMethod::parity);
}

void take_as_it_is(SignPlan& plan, MeshView mesh) {
  take(plan, {}, net_boundary({mesh}, MeshEdges(mesh)));
  plan.report.sure = false;
  plan.report.why = "the mesh is open as it is oriented (" + counted(plan.report.boundary_edges, "edge", "edges") +
                    " do not cancel), so the generalised winding number decides";
}

void plan_winding(SignPlan& plan, MeshView mesh, const SignOptions& options, ProgressMeter& progress) {
  const Closed closed = closed_of(mesh, progress);
  // Skip the diagnosis, as most meshes need none.
  if (closed.oriented && (options.as_oriented || faces_outwards(mesh))) {
    plan = plan_of_closed(SignMethod::winding);
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

void plan_normal(SignPlan& plan, MeshView mesh, const SignOptions& options, ProgressMeter& progress) {
  const Closed closed = closed_of(mesh, progress);
  if (!options.as_oriented && !(closed.oriented && faces_outwards(mesh))) orient_for(plan, mesh);
  plan.report.sure = false;  // it is right only where no parts overlap and no two faces are one
  plan.report.why = "front and back of the nearest triangle decide";
}

void plan_facet(SignPlan& plan, MeshView mesh, const SignOptions& options, ProgressMeter& progress) {
  plan_normal(plan, mesh, options, progress);
  plan.report.why = "the plane of the nearest triangle decides, which is wrong beside many edges and vertices";
}

void plan_flood(SignPlan& plan, MeshView mesh, const SignOptions&, ProgressMeter& progress) {
  plan.report.sure = closed_of(mesh, progress).unoriented;
  plan.report.why = plan.report.sure ? "the mesh is closed" : "outside is what a flood reaches; the mesh has gaps";
}

void plan_shell(SignPlan& plan, MeshView, const SignOptions&, ProgressMeter&) {
  plan.report.why = "the mesh is a sheet of that thickness";
}

// How the signs of samples are made.

using Made = std::unique_ptr<SampleSigns>;

Made winding_signs(const OrientedMesh& mesh, SignPlan& plan, const SignOptions& options, const UnsignedField& field,
                   ProgressMeter& progress) {
  if (plan.boundary.edges.empty())
    return std::make_unique<IntegerWinding>(mesh, field.grid, options.rule, progress, field.crossing_bytes);
  if (!plan.caps) plan.caps = std::make_shared<const Caps>(plan.boundary, progress);
  return std::make_unique<OpenWinding>(mesh, plan.caps, field.grid, options.rule, progress, field.crossing_bytes);
}

Made parity_signs(const OrientedMesh& mesh, SignPlan&, const SignOptions&, const UnsignedField& field,
                  ProgressMeter& progress) {
  return std::make_unique<IntegerWinding>(mesh, field.grid, WindingRule::odd, progress, field.crossing_bytes);
}

template <SideOfNearest (*kSideOf)(const OrientedMesh&)>
Made signs_by_nearest(const OrientedMesh& mesh, SignPlan&, const SignOptions&, const UnsignedField& field,
                      ProgressMeter& progress) {
  return std::make_unique<NormalSigns>(mesh.mesh, kSideOf(mesh), field.grid, field.thickness, field.nearest, progress);
}

Made flood_signs(const OrientedMesh& mesh, SignPlan& plan, const SignOptions& options, const UnsignedField& field,
                 ProgressMeter& progress) {
  if (plan.flood) return std::make_unique<Flood>(mesh.mesh, field.grid, plan.flood);
  auto signs = std::make_unique<Flood>(mesh.mesh, field.grid, progress);
  if (!signs->leaks()) {
    plan.flood = signs->sides();
    return signs;
  }
  plan.report.sure = false;
  plan.report.why += "; the flood comes everywhere, so nothing is inside: the gaps are too wide for this grid";
  expect_sure(plan, options);
  if (options.method != SignMethod::automatic) {
    plan.flood = signs->sides();
    return signs;
  }
  plan.report.method = SignMethod::none;
  return nullptr;
}

constexpr SignMethodSteps kMethodSteps[] = {
    {SignMethod::automatic, plan_winding},
    {SignMethod::winding, plan_winding, winding_signs},
    {SignMethod::parity, plan_parity, parity_signs},
    {SignMethod::normal, plan_normal, signs_by_nearest<by_pseudonormals>, SignScope::field, true},
    {SignMethod::facet, plan_facet, signs_by_nearest<by_planes>, SignScope::field, true},
    {SignMethod::flood, plan_flood, flood_signs, SignScope::grid},
    {SignMethod::shell, plan_shell},
    {SignMethod::none, plan_nothing},
};

// Each method of the public table has its steps.
static_assert(std::ranges::all_of(kSignMethods, [](const SignMethodInfo& info) {
  return std::ranges::count(kMethodSteps, info.method, &SignMethodSteps::method) == 1;
}));

}  // namespace

const SignMethodSteps& steps_of(SignMethod method) {
  return *std::ranges::find(kMethodSteps, method, &SignMethodSteps::method);
}

std::unique_ptr<SampleSigns> make_signs(MeshView mesh, SignPlan& plan, const SignOptions& options,
                                        const UnsignedField& field, ProgressMeter& progress) {
  return steps_of(plan.report.method).make({mesh, plan.use}, plan, options, field, progress);
}

std::unique_ptr<SampleSigns> make_signs_of_window(const OrientedMesh& part, SignPlan& plan, const SignOptions& options,
                                                  const UnsignedField& window, ProgressMeter& progress) {
  return steps_of(plan.report.method).make(part, plan, options, window, progress);
}

}  // namespace standoff
