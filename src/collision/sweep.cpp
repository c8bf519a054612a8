// SPDX-License-Identifier: Apache-2.0
// When do two bodies first touch? The public functions, and what they check.
#include "collision/sweep.h"

#include <algorithm>
#include <cmath>

#include "collision/batch.h"
#include "collision/find_intersecting.h"
#include "collision/sweep_on_device.h"
#include "collision/sweep_rounding.h"
#include "collision/sweep_search.h"
#include "collision/tolerances.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "geometry/triangle_pair.h"

namespace standoff {
namespace collision {
namespace {

void check(const SweepOptions& options) {
  if (!(options.tolerance >= 0) || !(options.tolerance <= kMaxMargin))
    throw Error(ErrorCode::usage, "sweep: the tolerance must be from 0 to " + number_text(kMaxMargin) +
                                      "; give a small part of the bodies' size, or 0 for the automatic one");
}

void check(const RigidMotion& motion) {
  validate(motion.from);
  validate(motion.to);
  const Vec3 c = motion.center;
  if (!is_finite(c) || max_norm(c) > kMaxPosition)
    throw Error(ErrorCode::usage, "sweep: the motion's center is not finite or past " + number_text(kMaxPosition) +
                                      "; give a point of the body");
}

// Times are rounded. Where that alone moves a body by a good part of its size, no path is left to follow.
void check_length(const CollisionModel& a, const CollisionModel& b, const RigidMotion& motion, double tolerance) {
  const double distance = length(apply(motion.to, motion.center) - apply(motion.from, motion.center));
  if (kTimeRounding * distance <= std::max(tolerance, (data_of(a).radius + data_of(b).radius) / 8)) return;
  throw Error(ErrorCode::usage,
              "sweep: the motion is so long that rounding alone moves bodies of this size by a good part of it; "
              "sweep it in pieces");
}

// Checks what was asked; returns the tolerance.
double checked_tolerance(const CollisionModel& a, const CollisionModel& b, std::span<const RigidMotion> motions,
                         const SweepOptions& options) {
  check(options);
  const double tolerance = options.tolerance > 0 ? options.tolerance : automatic_tolerance(a, b);
  for (const RigidMotion& motion : motions) {
    check(motion);
    check_length(a, b, motion, tolerance);
  }
  return tolerance;
}

}  // namespace

SweepResult sweep_exactly(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                          const RigidMotion& motion, double asked, const Kernels& kernels) {
  const AxisAngleMotion path(motion);
  const QueryPair pair(a, pose_a, b, motion.from, kernels);
  const double tolerance = tolerance_kept(pair, path, asked);
  const SweepResult swept = first_contact(pair, path, tolerance);
  if (swept.hit || !last_pose_may_jump(path, b, tolerance)) return swept;
  const QueryPair end(a, pose_a, b, motion.to, kernels);
  const auto found = find_intersecting_pair(end, 0);
  if (!found) return swept;
  const Corners of_target = end.target.world(found->of_target), of_probe = end.probe.world(found->of_probe);
  const Penetration where = end.swapped ? penetration(of_probe, of_target) : penetration(of_target, of_probe);
  const TrianglesOfBoth triangles = end.triangles_of(found->of_target, found->of_probe);
  return {true, 1, triangles.a, triangles.b, where.point, where.normal};
}

}  // namespace collision

double automatic_tolerance(const CollisionModel& a, const CollisionModel& b) {
  const auto [smaller, larger] = std::minmax({a.bounds().longest_side(), b.bounds().longest_side()});
  // Two points have no size: only what rounding leaves counts.
  return std::max({collision::kSweepTolerance * smaller, collision::kLeastSweepTolerance * larger, 1e-100});
}

SweepResult sweep(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const RigidMotion& motion,
                  const SweepOptions& options) try {
  const double tolerance = collision::checked_tolerance(a, b, {&motion, 1}, options);
  validate(pose_a);
  return collision::sweep_exactly(a, pose_a, b, motion, tolerance, collision::best_kernels());
} catch (...) {
  throw_as_error("sweep");
}

std::vector<SweepResult> sweep_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                   std::span<const RigidMotion> motions, const SweepOptions& options,
                                   const Execution& execution, BatchReport* report) try {
  const double tolerance = collision::checked_tolerance(a, b, motions, options);
  validate("sweep", execution, Runs::everywhere);
  validate(pose_a);
  const collision::Kernels& kernels = collision::kernels_for(execution.simd, "sweep");
  const collision::DeviceRow* const row = collision::find_device(execution.backend, motions.size());
  BatchReport done{row ? row->name : "cpu", row ? row->device_name(execution.device) : ""};
  auto results = row ? collision::sweep_on_device(*row, a, pose_a, b, motions, tolerance, execution, done)
                     : collision::for_each<SweepResult>(motions.size(), execution.threads, [&](std::size_t n) {
                         return collision::sweep_exactly(a, pose_a, b, motions[n], tolerance, kernels);
                       });
  if (report) *report = done;
  return results;
} catch (...) {
  throw_as_error("sweep");
}

}  // namespace standoff
