// SPDX-License-Identifier: Apache-2.0
#include "sign/plan.h"

#include <algorithm>
#include <string>

#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/diagnosis_bytes.h"
#include "sign/methods.h"
#include "standoff/error.h"

namespace standoff {

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
