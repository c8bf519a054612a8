// SPDX-License-Identifier: Apache-2.0
#include "sign/plan.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/diagnosis_bytes.h"
#include "sign/methods.h"
#include "standoff/error.h"

namespace standoff {

void validate(const SignOptions& options) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("compute: ") + what); };
  const auto is = [&](SignMethod method) { return options.method == method; };
  // Reject numbers that were cast to an enumeration.
  const auto one_of = [](auto value, auto last) { return value >= decltype(value){} && value <= last; };
  const SignMethodInfo* const info = find_info(options.method);
  if (!info || !one_of(options.rule, WindingRule::odd))
    fail("there is no such sign method or winding rule; take one of enum SignMethod and of WindingRule");
  if (options.rule != WindingRule::positive && !is(SignMethod::winding) && !is(SignMethod::automatic))
    fail("a winding rule is for the sign methods winding and automatic; leave it out");
  if (options.invert && is(SignMethod::none)) fail("a field without a sign cannot be inverted; choose a sign method");
  if (options.as_oriented && !info->by_orientation)
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

void expect_sure(const SignPlan& plan, const SignOptions& options) {
  if (!options.strict || plan.report.sure) return;
  throw Error(ErrorCode::doubt, "the sign is not certain (" + plan.report.why +
                                    "), and strict allows no doubt; repair the mesh, or allow it");
}

namespace {

bool is_winding(SignMethod method) { return method == SignMethod::winding || method == SignMethod::automatic; }

SignMemory memory_of(const MeshCounts& mesh, const SignOptions& options) {
  const std::int64_t boundary = mesh.most_boundary(options.as_oriented),
                     kept = kept_plan_bytes(mesh.triangles, boundary);
  SignMemory memory{diagnosis_bytes(mesh, options.as_oriented), kept, is_winding(options.method) ? boundary : 0};
  // Both orientations are in memory, that of the diagnosis and the mesh's own.
  if (options.as_oriented) memory.planning += kept;
  // Not counted step by step: what else looks at the whole mesh.
  if (options.outer || !is_winding(options.method))
    memory.planning = std::max(memory.planning, 256 * mesh.triangles + (std::int64_t{4} << 20));
  return memory;
}

}  // namespace

SignMemory most_sign_memory(std::int64_t triangles, const SignOptions& options, int threads) {
  return options.method == SignMethod::none ? SignMemory{} : memory_of(most_counts(triangles, threads), options);
}

SignMemory sign_memory(MeshView mesh, const SignOptions& options, int threads) {
  if (options.method == SignMethod::none) return {};
  if (!find_info(options.method)->by_orientation) return {.planning = closed_bytes(mesh)};
  if (is_winding(options.method) && !options.outer && is_closed(mesh).oriented) {
    if (options.as_oriented) return {.planning = closed_bytes(mesh)};
    if (faces_outwards(mesh)) return {.planning = std::max(closed_bytes(mesh), outward_bytes(mesh))};
  }
  return memory_of(count_mesh(mesh, threads), options);
}

SignPlan plan_sign(MeshView mesh, const SignOptions& options, ProgressMeter& progress) {
  SignPlan plan;
  plan.report.method = options.method;
  steps_of(options.method).plan(plan, mesh, options, progress);
  expect_sure(plan, options);
  return plan;
}

}  // namespace standoff
