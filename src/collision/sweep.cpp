// SPDX-License-Identifier: Apache-2.0
// When do two bodies first touch? Rigid motions and what rounding does to them, one sweep on the CPU, many on a device;
// then the public functions, and what they check. The search itself is in sweep_search.cpp.
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

// outer^T inner, as matrices.
std::array<double, 9> transposed_times(const std::array<double, 9>& outer, const std::array<double, 9>& inner) {
  std::array<double, 9> product{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) product[3 * i + j] += outer[3 * k + i] * inner[3 * k + j];
  return product;
}
// outer inner^T.
std::array<double, 9> times_transposed(const std::array<double, 9>& outer, const std::array<double, 9>& inner) {
  std::array<double, 9> product{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) product[3 * i + j] += outer[3 * i + k] * inner[3 * j + k];
  return product;
}

AxisAngle axis_angle_of(const std::array<double, 9>& r) {
  const Vec3 skew = Vec3{r[7] - r[5], r[2] - r[6], r[3] - r[1]} * 0.5;  // sin(angle) axis
  const double sine = length(skew), cosine = (r[0] + r[4] + r[8] - 1) / 2;
  AxisAngle rotation;
  rotation.angle_rad = std::atan2(sine, cosine);
  if (cosine > 0 || sine > 1e-3) {
    if (sine > 0) rotation.axis = skew * (1 / sine);
    return rotation;
  }
  // Near half a turn the skew part is lost in rounding; (R + R^T) / 2 = cos + (1 - cos) axis axis^T is not.
  const double square[3] = {r[0] - cosine, r[4] - cosine, r[8] - cosine};
  int largest = 0;
  for (int n = 1; n < 3; ++n)
    if (square[n] > square[largest]) largest = n;
  double column[3];
  for (int n = 0; n < 3; ++n) column[n] = n == largest ? square[n] : (r[3 * n + largest] + r[3 * largest + n]) / 2;
  Vec3 axis{column[0], column[1], column[2]};
  axis = axis * (1 / length(axis));
  if (dot(axis, skew) < 0) axis = axis * -1.0;
  rotation.axis = axis;
  return rotation;
}

// v turned about a unit axis.
Vec3 rotated(Vec3 v, Vec3 axis, double angle_rad) {
  if (angle_rad == 0) return v;
  return vec_of(collision::rotated(triple_of(v), triple_of(axis), std::cos(angle_rad), std::sin(angle_rad)));
}

}  // namespace

AxisAngleMotion::AxisAngleMotion(const RigidMotion& m) : poses(m) {
  if (m.start.rotation == m.end.rotation)
    // Without a rotation all points move on straight lines, and a centre far away would only bring its rounding.
    poses.center = {};
  else
    rotation = axis_angle_of(times_transposed(m.end.rotation, m.start.rotation));
  center = apply(m.start, poses.center);
  velocity = apply(m.end, poses.center) - center;
}

Pose AxisAngleMotion::at(double t) const {
  const auto& [from, to, body_center] = poses;
  if (t <= 0) return from;
  if (t >= 1) return to;
  Pose pose = from;
  if (rotation.angle_rad != 0) {
    const auto& r = from.rotation;
    const double angle = rotation.angle_rad * t;
    for (int column = 0; column < 3; ++column) {
      const Vec3 v = rotated({r[column], r[3 + column], r[6 + column]}, rotation.axis, angle);
      pose.rotation[column] = v.x, pose.rotation[3 + column] = v.y, pose.rotation[6 + column] = v.z;
    }
    pose.translation = center + velocity * t - rotate(pose, body_center);
  } else {
    pose.translation = from.translation + (to.translation - from.translation) * t;
  }
  return pose;
}

RelativeMotion relative_motion(const QueryPair& pair, const AxisAngleMotion& path) {
  // In the pair the target stands at its pose; where it moves, at its pose at time 0.
  const Pose &target = pair.frame, &probe = pair.probe.pose;
  const Vec3 middle = apply(pair.target.pose, pair.target.body->middle);
  const Vec3 velocity = rotate_back(target, path.velocity);
  return {.target_moves = pair.swapped,
          .base = triple_of(rotate_back(target, path.center - middle)),
          .velocity = triple_of(velocity),
          .axis = triple_of(rotate_back(target, path.rotation.axis)),
          .angle_rad = pair.swapped ? -path.rotation.angle_rad : path.rotation.angle_rad,
          .speed_of_base = standoff::length(velocity),
          .start = transform_of({transposed_times(target.rotation, probe.rotation),
                                 rotate_back(target, apply(probe, pair.probe.body->middle) - path.center)})};
}

double pose_rounding(const QueryPair& pair, const AxisAngleMotion& path) {
  return kPoseRounding * (pair.far + length(path.center) + length(path.velocity));
}

namespace {

// The rounding of time moves a body on a very long motion: four such errors add up.
double time_rounding(const AxisAngleMotion& path) {
  const double turning = path.rotation.angle_rad * length(path.poses.center);
  return 4 * kTimeRounding * (length(path.velocity) + length(path.center) + turning);
}

}  // namespace

float distance_kept(const QueryPair& pair, const AxisAngleMotion& path, double tolerance) {
  return pair.limit(tolerance) + static_cast<float>(time_rounding(path));
}

double reserve_of_nodes(const QueryPair& pair, const AxisAngleMotion& path, double tolerance) {
  const double on_the_way = kDoublePrecisionSlack * (length(path.velocity) + length(path.center));
  return kNodeReserve * tolerance + pair.pose_slack + on_the_way + time_rounding(path);
}

namespace {

// How far a point of the body may be at the last pose from where the even rotation ends.
double jump_at_end(const AxisAngleMotion& path, const BodyData& body) {
  const RigidMotion& m = path.poses;
  if (m.start.rotation == m.end.rotation) return 0;
  double off_sq = 0;
  for (int column = 0; column < 3; ++column) {
    const auto of = [column](const Pose& pose) {
      return Vec3{pose.rotation[column], pose.rotation[3 + column], pose.rotation[6 + column]};
    };
    const Vec3 off = of(m.end) - rotated(of(m.start), path.rotation.axis, path.rotation.angle_rad);
    off_sq += dot(off, off);
  }
  return std::sqrt(off_sq) * (length(body.middle - m.center) + body.radius);
}

// The tolerance asked for, or the least that pose_rounding() lets a sweep keep. Half of it is kept between the bodies.
double tolerance_kept(const QueryPair& pair, const AxisAngleMotion& path, double asked) {
  return std::max(asked, 2 * pose_rounding(pair, path));
}

// Whether the last pose must be tested by itself: its matrix may be a rotation only nearly, and lie farther from where
// the even rotation ends than the distance that was kept. The bodies were half the tolerance apart all the time; a jump
// shorter than that touches nothing.
bool last_pose_may_jump(const AxisAngleMotion& path, const Body& moving, double tolerance) {
  return !(jump_at_end(path, data_of(moving)) < tolerance / 4);
}

// sweep() without its checks, on the CPU. The tolerance is positive.
SweepResult sweep_exactly(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                          const SweepOptions& options, const Kernels& kernels) {
  const AxisAngleMotion path(motion);
  const QueryPair pair(a, pose_a, b, motion.start, kernels);
  const double tolerance = tolerance_kept(pair, path, options.tolerance);
  const SweepResult swept = first_contact(pair, path, tolerance, options.max_steps);
  if (swept.hit || !swept.finished || !last_pose_may_jump(path, b, tolerance)) return swept;
  const QueryPair end(a, pose_a, b, motion.end, kernels);
  const auto found = find_intersecting_pair(end, 0);
  if (!found) return swept;
  const Corners of_target = end.target.world(found->of_target), of_probe = end.probe.world(found->of_probe);
  const Penetration where = end.swapped ? penetration(of_probe, of_target) : penetration(of_target, of_probe);
  const TrianglesOfBoth triangles = end.triangles_of(found->of_target, found->of_probe);
  return {true, 1, triangles.a, triangles.b, where.point, where.normal};
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
      return is_free(prepared[n], answers[n]) ? SweepResult{} : sweep_exactly(a, pose_a, b, piece[n], options, kernels);
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

void check(const RigidMotion& motion) {
  validate(motion.start);
  validate(motion.end);
  const Vec3 c = motion.center;
  if (!is_finite(c) || max_norm(c) > kMaxPosition)
    throw Error(ErrorCode::usage, "sweep: the motion's center is not finite or past " + number_text(kMaxPosition) +
                                      "; give a point of the body");
}

// Times are rounded. Where that alone moves a body by a good part of its size, no path is left to follow.
void check_length(const Body& a, const Body& b, const RigidMotion& motion, double tolerance) {
  const double distance = length(apply(motion.end, motion.center) - apply(motion.start, motion.center));
  if (kTimeRounding * distance <= std::max(tolerance, (data_of(a).radius + data_of(b).radius) / 8)) return;
  throw Error(ErrorCode::usage,
              "sweep: the motion is so long that rounding alone moves bodies of this size by a good part of it; "
              "sweep it in pieces");
}

// Checks what was asked, and sets the tolerance where it is automatic.
SweepOptions checked(const Body& a, const Body& b, std::span<const RigidMotion> motions, SweepOptions options) {
  check(options);
  if (options.tolerance == 0) options.tolerance = automatic_tolerance(a, b);
  for (const RigidMotion& motion : motions) {
    check(motion);
    check_length(a, b, motion, options.tolerance);
  }
  return options;
}

}  // namespace

}  // namespace collision

Pose pose_at(const RigidMotion& motion, double t) try {
  validate(motion.start);
  validate(motion.end);
  if (!(t >= 0 && t <= 1))
    throw Error(ErrorCode::usage, "motion: the time must be from 0 to 1; 0 is the start, 1 the end");
  return collision::AxisAngleMotion(motion).at(t);
} catch (...) {
  throw_as_error("motion");
}

double automatic_tolerance(const Body& a, const Body& b) {
  const auto [smaller, larger] = std::minmax({a.bounds().longest_side(), b.bounds().longest_side()});
  // Two points have no size: take the least tolerance that rounding allows.
  return std::max({collision::kSweepTolerance * smaller, collision::kLeastSweepTolerance * larger, 1e-100});
}

SweepResult sweep(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                  const SweepOptions& options) try {
  const SweepOptions asked = collision::checked(a, b, {&motion, 1}, options);
  validate(pose_a);
  return collision::sweep_exactly(a, pose_a, b, motion, asked, collision::best_kernels());
} catch (...) {
  throw_as_error("sweep");
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
                         return collision::sweep_exactly(a, pose_a, b, motions[n], asked, kernels);
                       });
  return {std::move(results), std::move(report)};
} catch (...) {
  throw_as_error("sweep");
}

}  // namespace standoff
