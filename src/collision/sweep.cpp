// SPDX-License-Identifier: Apache-2.0
// When do two bodies first touch? One sweep on the CPU, sweeps along a path, many on a device; then the public
// functions, and what they check. The search itself is in sweep_search.cpp, and what it knows of motions in motion.cpp.
#include "collision/sweep.h"

#include <algorithm>
#include <cmath>

#include "collision/collide.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "geometry/triangle_pair.h"

namespace standoff {
namespace collision {
namespace {

// The tolerance asked for, or the least that pose_rounding() lets a sweep keep. Half of it is kept between the bodies.
double tolerance_kept(const QueryPair& pair, const AxisAngleMotion& path, double asked) {
  return std::max(asked, 2 * pose_rounding(pair, path));
}

}  // namespace

SweepResult sweep_exactly(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                          double asked_tolerance, Steps& steps, const Kernels& kernels) {
  const AxisAngleMotion path(motion);
  const QueryPair pair(a, pose_a, b, motion.start, kernels);
  const double tolerance = tolerance_kept(pair, path, asked_tolerance);
  const SweepResult swept = first_contact(pair, path, tolerance, steps);
  if (swept.hit || !swept.finished || !last_pose_may_jump(path, b, tolerance)) return swept;
  const QueryPair end(a, pose_a, b, motion.end, kernels);
  const auto found = find_intersecting_pair(end, 0);
  if (!found) return swept;
  const Corners of_target = end.target.world(found->of_target), of_probe = end.probe.world(found->of_probe);
  const Penetration where = end.swapped ? penetration(of_probe, of_target) : penetration(of_target, of_probe);
  const TrianglesOfBoth triangles = end.triangles_of(found->of_target, found->of_probe);
  return {true, 1, triangles.a, triangles.b, where.point, where.normal};
}

namespace {

// The sweep of a motion that has all the steps.
SweepResult sweep_alone(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                        const SweepOptions& options, const Kernels& kernels) {
  Steps steps(options.max_steps);
  return sweep_exactly(a, pose_a, b, motion, options.tolerance, steps, kernels);
}

// How far a point of the body moves from one pose to another, at most.
double jump_between(const Pose& from, const Pose& to, const BodyData& body) {
  double off_sq = 0;
  for (std::size_t n = 0; n < 9; ++n)
    off_sq += (to.rotation[n] - from.rotation[n]) * (to.rotation[n] - from.rotation[n]);
  return length(apply(to, body.middle) - apply(from, body.middle)) + std::sqrt(off_sq) * body.radius;
}

// How far b jumps where each motion begins: from where the one before ends, and at its end from where its rotation
// leads. Throws an error that names the first motion with too long a jump.
std::vector<double> jumps_of(const Body& b, std::span<const RigidMotion> path, double tolerance) {
  std::vector<double> jumps(path.size());
  for (std::size_t n = 1; n < path.size(); ++n) {
    const Pose &from = path[n - 1].end, &to = path[n].start;
    const double far = length(to.translation) + length(data_of(b).middle) + data_of(b).radius;
    const double allowed = std::max(tolerance, 2 * kPoseRounding * far) / 4;
    const double jump = jumps[n] =
        jump_between(from, to, data_of(b)) + jump_at_end(AxisAngleMotion(path[n - 1]), data_of(b));
    if (!(jump <= allowed))
      throw Error(ErrorCode::usage, "sweep_path: motion " + std::to_string(n) + " does not begin where motion " +
                                        std::to_string(n - 1) + " ends: a point of b jumps by up to " +
                                        number_text(jump) + ", and " + number_text(allowed) +
                                        ", a quarter of the tolerance, is allowed; begin it at the end of the other");
  }
  return jumps;
}

// Motions that go to the device at a time: enough to fill any GPU, at some 200 bytes each.
constexpr std::size_t kMotionsAtOnce = std::size_t{1} << 17;

struct PreparedMotion {
  SweepQuery query;
  bool jumps;  ///< the last pose must be looked at
};

// The CPU sweeps all motions but those that are free and whose last pose does not jump.
bool is_free(const PreparedMotion& motion, const SweepAnswer& answer) {
  return answer.verdict == DeviceVerdict::free && !motion.jumps;
}

}  // namespace

// Motions go to the device in pieces. What is not certainly free the CPU sweeps from the beginning: begun later its
// steps would be others, and with them the time of a hit, and whether a pass within the tolerance counts as one.
std::vector<SweepResult> sweep_on_device(const DeviceRow& row, const Body& a, const Pose& pose_a, const Body& b,
                                         std::span<const RigidMotion> motions, const SweepOptions& options,
                                         const Execution& execution, BatchReport& report, int stack) {
  std::vector<SweepResult> results;
  results.reserve(motions.size());
  const Kernels& kernels = kernels_for(execution.simd, "sweep");
  const QueryPair bodies(a, pose_a, b, {}, kernels);  // which of them gives its field does not depend on motions
  for (std::size_t first = 0; first < motions.size(); first += kMotionsAtOnce) {
    const auto piece = motions.subspan(first, std::min(kMotionsAtOnce, motions.size() - first));
    const auto prepared = for_each<PreparedMotion>(piece.size(), execution.threads, [&](std::size_t n) {
      const AxisAngleMotion path(piece[n]);
      const QueryPair pair(a, pose_a, b, piece[n].start, kernels);
      const double kept = tolerance_kept(pair, path, options.tolerance);
      return PreparedMotion{{relative_motion(pair, path), distance_kept(pair, path, kept)},
                            last_pose_may_jump(path, b, kept)};
    });
    std::vector<SweepQuery> queries;
    queries.reserve(prepared.size());
    for (const PreparedMotion& one : prepared) queries.push_back(one.query);
    std::vector<SweepAnswer> answers(piece.size());
    row.sweep({.target = *bodies.target.body,
               .probe = *bodies.probe.body,
               .queries = queries,
               .answers = answers,
               .device = execution.device,
               .stack = stack});
    const auto found = for_each<SweepResult>(piece.size(), execution.threads, [&](std::size_t n) {
      return is_free(prepared[n], answers[n]) ? SweepResult{} : sweep_alone(a, pose_a, b, piece[n], options, kernels);
    });
    results.insert(results.end(), found.begin(), found.end());
    for (std::size_t n = 0; n < answers.size(); ++n) {
      const bool overflowed = answers[n].verdict == DeviceVerdict::overflow;
      report.on_device += is_free(prepared[n], answers[n]);
      report.undecided += !overflowed && !is_free(prepared[n], answers[n]);
      report.overflowed += overflowed;
    }
  }
  return results;
}

namespace {

void check(const SweepOptions& options) {
  if (!(options.tolerance >= 0) || !(options.tolerance <= kMaxMargin))
    throw Error(ErrorCode::usage, "sweep: the tolerance must be from 0 to " + number_text(kMaxMargin) +
                                      "; give a small part of the bodies' size, or 0 for the automatic one");
  if (options.max_steps < 0)
    throw Error(ErrorCode::usage, "sweep: max_steps must not be negative; give 0 for no limit");
}

}  // namespace

double checked_tolerance(const Body& a, const Body& b, const SweepOptions& options) {
  check(options);
  return options.tolerance == 0 ? automatic_tolerance(a, b) : options.tolerance;
}

namespace {

// Checks what was asked, and sets the tolerance where it is automatic.
SweepOptions checked(const Body& a, const Body& b, std::span<const RigidMotion> motions, SweepOptions options) {
  options.tolerance = checked_tolerance(a, b, options);
  for (const RigidMotion& motion : motions) {
    validate("sweep", motion);
    check_length(a, b, motion, options.tolerance);
  }
  return options;
}

}  // namespace

}  // namespace collision

double automatic_tolerance(const Body& a, const Body& b) {
  const auto [smaller, larger] = std::minmax({a.bounds().longest_side(), b.bounds().longest_side()});
  // Two points have no size: take the least tolerance that rounding allows.
  return std::max({collision::kSweepTolerance * smaller, collision::kLeastSweepTolerance * larger, 1e-100});
}

SweepResult sweep(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                  const SweepOptions& options) try {
  const SweepOptions asked = collision::checked(a, b, {&motion, 1}, options);
  validate(pose_a);
  return collision::sweep_alone(a, pose_a, b, motion, asked, collision::best_kernels());
} catch (...) {
  throw_as_error("sweep");
}

PathSweepResult sweep_path(const Body& a, const Pose& pose_a, const Body& b, std::span<const RigidMotion> path,
                           const SweepOptions& options) try {
  if (path.empty())
    throw Error(ErrorCode::usage, "sweep_path: the path has no motion; give at least one, even if b rests in it");
  const SweepOptions asked = collision::checked(a, b, path, options);
  validate(pose_a);
  const std::vector<double> jumps = collision::jumps_of(b, path, asked.tolerance);
  collision::Steps steps(asked.max_steps);
  PathSweepResult found;
  for (std::size_t n = 0; n < path.size(); ++n) {
    found.motion = static_cast<std::int64_t>(n);
    // Bodies that part from within the tolerance may be so near that the jump passes through one.
    if (jumps[n] > 0) {
      const DistanceResult nearest = distance(a, pose_a, b, path[n].start, {.limit = 2 * jumps[n]});
      if (nearest.upper <= jumps[n]) return {found.motion, collision::hit_at(0, nearest)};
    }
    found.sweep = collision::sweep_exactly(a, pose_a, b, path[n], asked.tolerance, steps, collision::best_kernels());
    if (found.sweep.hit || !found.sweep.finished) break;
  }
  return found;
} catch (...) {
  throw_as_error("sweep_path");
}

BatchResult<SweepResult> sweep_all(const Body& a, const Pose& pose_a, const Body& b,
                                   std::span<const RigidMotion> motions, const SweepOptions& options,
                                   const Execution& execution) try {
  const SweepOptions asked = collision::checked(a, b, motions, options);
  validate("sweep", execution, Runs::everywhere);
  validate(pose_a);
  const collision::Kernels& kernels = collision::kernels_for(execution.simd, "sweep");
  const collision::DeviceRow* const row = collision::find_device(execution.backend, motions.size());
  BatchReport report{name_of(row ? row->backend : Backend::cpu), row ? row->device_name(execution.device) : ""};
  auto results = row ? collision::sweep_on_device(*row, a, pose_a, b, motions, asked, execution, report)
                     : collision::for_each<SweepResult>(motions.size(), execution.threads, [&](std::size_t n) {
                         return collision::sweep_alone(a, pose_a, b, motions[n], asked, kernels);
                       });
  return {std::move(results), std::move(report)};
} catch (...) {
  throw_as_error("sweep");
}

}  // namespace standoff
