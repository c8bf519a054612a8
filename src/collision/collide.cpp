// SPDX-License-Identifier: Apache-2.0
// Do two bodies intersect? The public functions.
#include "collision/collide.h"

#include "collision/batch.h"
#include "collision/certified.h"
#include "collision/collide_on_device.h"
#include "collision/containment.h"
#include "collision/find_intersecting.h"
#include "core/guarded.h"
#include "core/number_text.h"

namespace standoff {

CollisionResult collision::collide_exactly(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                           const Pose& pose_b, double margin, const Kernels& kernels) {
  const QueryPair pair(a, pose_a, b, pose_b, kernels);
  const auto found = find_intersecting_pair(pair, margin);
  if (!found) return {};
  const TrianglesOfBoth triangles = pair.triangles_of(found->of_target, found->of_probe);
  return {Verdict::hit, triangles.a, triangles.b};
}

namespace {

void check(const CollideOptions& options) {
  if (options.mode != CollideMode::exact && options.mode != CollideMode::certified)
    throw Error(ErrorCode::usage, "collide: unknown mode; take CollideMode::exact or CollideMode::certified");
  if (!(options.margin >= 0) || !(options.margin <= kMaxMargin))
    throw Error(ErrorCode::usage,
                "collide: the margin must be from 0 to " + number_text(kMaxMargin) + "; give it in world units");
  if (options.containment && options.mode != CollideMode::exact)
    throw Error(ErrorCode::usage, "collide: containment is not for certified mode; take CollideMode::exact");
}

// A free result becomes a hit where one body is inside the other.
CollisionResult with_containment(CollisionResult result, const CollisionModel& a, const Pose& pose_a,
                                 const CollisionModel& b, const Pose& pose_b) {
  if (result.hit()) return result;
  result.containment = collision::containment(a, pose_a, b, pose_b);
  if (result.containment != Containment::none) result.verdict = Verdict::hit;
  return result;
}

CollisionResult collide_checked(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                const Pose& pose_b, const CollideOptions& options, const collision::Kernels& kernels) {
  if (options.mode == CollideMode::exact)
    return collision::collide_exactly(a, pose_a, b, pose_b, options.margin, kernels);
  return {.verdict = collision::certify(collision::QueryPair(a, pose_a, b, pose_b, kernels), options.margin)};
}

}  // namespace

CollisionResult collide(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                        const CollideOptions& options) try {
  check(options);
  if (options.containment) collision::require_closed(a, b);
  validate(pose_a);
  validate(pose_b);
  const CollisionResult result = collide_checked(a, pose_a, b, pose_b, options, collision::best_kernels());
  return options.containment ? with_containment(result, a, pose_a, b, pose_b) : result;
} catch (...) {
  throw_as_error("collide");
}

std::vector<CollisionResult> collide_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                         std::span<const Pose> poses_b, const CollideOptions& options,
                                         const Execution& execution, BatchReport* report) try {
  const bool certified = options.mode == CollideMode::certified;
  check(options);
  validate(certified ? "collide: certified mode" : "collide", execution,
           certified ? Runs::on_the_cpu : Runs::everywhere);
  if (options.containment) collision::require_closed(a, b);
  validate(pose_a);
  collision::validate_all(poses_b);
  const collision::Kernels& kernels = collision::kernels_for(execution.simd, "collide");
  const Backend backend = certified ? Backend::cpu : execution.backend;
  const collision::DeviceRow* const row = collision::find_device(backend, poses_b.size());
  BatchReport done{row ? row->name : "cpu", row ? row->device_name(execution.device) : ""};
  auto results = row ? collision::collide_on_device(*row, a, pose_a, b, poses_b, options.margin, execution, done)
                     : collision::for_each<CollisionResult>(poses_b.size(), execution.threads, [&](std::size_t n) {
                         return collide_checked(a, pose_a, b, poses_b[n], options, kernels);
                       });
  if (options.containment)
    results = collision::for_each<CollisionResult>(results.size(), execution.threads, [&](std::size_t n) {
      return with_containment(results[n], a, pose_a, b, poses_b[n]);
    });
  if (report) *report = done;
  return results;
} catch (...) {
  throw_as_error("collide");
}

}  // namespace standoff
