// When two bodies first touch. Balls of the tree move along until the field no longer tells them free, first those that
// stop first; their children start from there. Triangles that stop are followed exactly, against the triangles their
// way may meet.
//
// A ball (c, r) whose centre is L or more from the surface at time t is free until t + (L - r - tolerance) / speed,
// `speed` being no less than its centre's: distance is 1-Lipschitz, and a ball does not change as it turns about its
// own centre. So a child may start at the time up to which its parent is free: it lies within it, but for rounding,
// which the slack covers.
#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/batch.h"
#include "collision/body/ball_bound.h"
#include "collision/find_intersecting.h"
#include "collision/rigid_motion.h"
#include "collision/sweep_on_device.h"
#include "core/execution.h"
#include "core/guarded.h"
#include "geometry/intersection.h"
#include "geometry/slab.h"

namespace standoff {
namespace collision {
namespace {

// A pose on the way goes through some 12 roundings of coordinates this large, a corner in it through 4: by so much
// bodies jump from one time to the next.
double jump_on_way(const Pair& pair, const Course& course) {
  return 16 * 0x1p-53 * (pair.far + length(course.center) + length(course.velocity));
}

// What automatic_tolerance() promises. Powers of two, so that scaling both bodies scales it exactly.
constexpr double kSweepTolerance = 0x1p-15, kLeastSweepTolerance = 0x1p-40;

// Times near 1 are rounded by 1e-16. In terms of the speed.
constexpr double kTimeRounding = 4e-16;

class Follow {
 public:
  Follow(const Pair& pair, const Course& course, double tolerance)
      : pair_(pair),
        course_(course),
        relative_(pair, course),
        kernels_(kernels()),
        tolerance_(tolerance),
        direction_sure_from_(std::max(1e-3 * tolerance, jump_on_way(pair, course))),
        keep_(distance_kept(pair, course, tolerance)),
        enough_(static_cast<float>(pair.field.body->field.spacing)) {}

  SweepResult run() {
    visit(pair_.tree.body->tree.top(), 0, 0);
    return result_;
  }

 private:
  // Balls of one packet, each with its time.
  struct Lanes {
    MovingBall ball[kLanes];
    alignas(64) float gap[kLanes];
    alignas(64) float radius[kLanes];
    bool active[kLanes];
  };

  double end() const { return result_.time; }  // nothing later is of interest

  void visit(int level, std::uint32_t packet, double start) {
    const Balls& balls = pair_.tree.body->tree.levels[level].balls[packet];
    Lanes lanes;
    for (int n = 0; n < kLanes; ++n) {
      const Way& way = relative_.way();
      const Triple<double> offset = way.offset({balls.center[0][n], balls.center[1][n], balls.center[2][n]});
      lanes.ball[n] = {offset, way.speed(offset), start, balls.radius[n]};
      lanes.radius[n] = balls.radius[n];
      lanes.active[n] = balls.radius[n] >= 0;
    }
    advance(lanes, level);
    int order[kLanes], stopped = 0;
    for (int n = 0; n < kLanes; ++n)
      if (balls.radius[n] >= 0 && lanes.ball[n].time < end()) order[stopped++] = n;
    std::sort(order, order + stopped, [&lanes](int a, int b) {
      const double at_a = lanes.ball[a].time, at_b = lanes.ball[b].time;
      return at_a != at_b ? at_a < at_b : lanes.gap[a] < lanes.gap[b];
    });
    for (int k = 0; k < stopped; ++k) {
      const int n = order[k];
      const double time = lanes.ball[n].time;
      if (done(time)) return;
      const std::uint32_t child = packet * kLanes + n;
      if (level > 0)
        visit(level - 1, child, time);
      else
        follow(child, time);
    }
  }

  bool done(double time) const { return time >= end(); }

  // Moves all lanes on until their steps are not worth it.
  void advance(Lanes& lanes, int level) {
    const float least = level == 0 ? kWorthATrianglesStep * enough_ : 0;
    alignas(64) float center[3][kLanes] = {};
    for (;;) {
      bool any = false;
      for (int n = 0; n < kLanes; ++n) {
        if (!lanes.active[n]) continue;
        const Triple<double> x = relative_.way().at(lanes.ball[n].offset, lanes.ball[n].time);
        center[0][n] = static_cast<float>(x.x), center[1][n] = static_cast<float>(x.y),
        center[2][n] = static_cast<float>(x.z);
        any = true;
      }
      if (!any) return;
      kernels_.gaps_at(pair_.field.body->view, center, lanes.radius, enough_, lanes.gap);
      for (int n = 0; n < kLanes; ++n)
        if (lanes.active[n]) lanes.active[n] = lanes.ball[n].step(lanes.gap[n], keep_, end(), least);
    }
  }

  // One triangle from time `from` on, against all that its way may meet.
  void follow(std::uint32_t tree_place, double from) {
    Vec3 offset[3];
    double speed = 0, acceleration = 0;
    for (int k = 0; k < 3; ++k) {
      offset[k] = relative_.offset(pair_.tree.body->corners[tree_place][k] - pair_.tree.body->middle);
      speed = std::max(speed, relative_.speed(offset[k]));
      acceleration = std::max(acceleration, relative_.acceleration(offset[k]));
    }
    const double ahead = kAhead * pair_.field.body->field.spacing;
    for (double t = from; !done(t);) {
      const double until = std::min(end(), speed > 0 ? std::max(t + ahead / speed, std::nextafter(t, 2)) : 2);
      // A way between two times leaves the chord by an eighth of the acceleration times the time squared at the most.
      FloatBox box;
      for (const Vec3& o : offset)
        for (const double time : {t, until}) {
          const Vec3 x = relative_.at(o, time);
          const float at[3] = {static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)};
          box.include(at);
        }
      const double bend = acceleration * (until - t) * (until - t) / 8;
      box.grow(keep_ + static_cast<float>(bend) * 1.000001f);
      from_ = t, until_ = until;
      descend(pair_.field.body->tree.top(), 0, tree_place, box);
      t = until;
      if (!done(t)) t = jump(tree_place, t);
    }
  }

  // As far as the field lets the triangle's ball go from a time at which it is free.
  double jump(std::uint32_t tree_place, double t) {
    const Balls& balls = pair_.tree.body->tree.levels[0].balls[tree_place / kLanes];
    const int n = static_cast<int>(tree_place % kLanes);
    const Vec3 offset = relative_.offset({balls.center[0][n], balls.center[1][n], balls.center[2][n]});
    const double speed = relative_.speed(offset);
    if (!(speed > 0)) return 2;
    const float radius = balls.radius[n];
    while (t < end()) {
      const Vec3 x = relative_.at(offset, t);
      const float gap = gap_of_ball(pair_.field.body->view, static_cast<float>(x.x), static_cast<float>(x.y),
                                    static_cast<float>(x.z), radius, enough_);
      const float step = gap * (1 - 1e-6f) - keep_;
      if (step > 0) t += step / speed;
      if (!(step > kWorthATrianglesStep * enough_)) break;
    }
    return t;
  }

  void descend(int level, std::uint32_t node, std::uint32_t tree_place, const FloatBox& box) {
    for (std::uint32_t mask = kernels_.overlaps(pair_.field.body->tree.levels[level].boxes[node], box); mask != 0;
         mask &= mask - 1) {
      const std::uint32_t child = node * kLanes + std::countr_zero(mask);
      if (level > 0)
        descend(level - 1, child, tree_place, box);
      else
        meet(child, tree_place);
    }
  }

  // The motion of b's triangle towards a's, step by step. Along the normal n of the slab between both, the corners come
  // nearer by no more than `approach` per time, -n.v + |n x w| * (their distance from the axis): the next time to look.
  // Where that is not positive they only part. Where there is no such slab they come nearer no faster than the fastest
  // corner moves.
  void meet(std::uint32_t field_place, std::uint32_t tree_place) {
    const Corners resting = pair_.swapped ? pair_.tree.world(tree_place) : pair_.field.world(field_place);
    const Corners& moving =
        pair_.swapped ? pair_.field.body->corners[field_place] : pair_.tree.body->corners[tree_place];
    const double rate = course_.turn.angle_rad;
    double away = 0;
    if (rate != 0)
      for (const Vec3& corner : moving)
        away = std::max(away,
                        length(cross(course_.turn.axis, rotate(course_.motion.from, corner - course_.motion.center))));
    const double fastest = length(course_.velocity) + rate * away;
    for (double t = from_; t < until_;) {
      const Pose pose = course_.at(t);
      const Corners at{apply(pose, moving[0]), apply(pose, moving[1]), apply(pose, moving[2])};
      if (t == 0 && triangles_touch(resting, at))
        return record(t, field_place, tree_place, overlap(resting, at).point, {});
      const ClosestPair pair = closest_points(resting, at);
      const double apart = std::sqrt(pair.distance_sq);
      const Slab slab = slab_between(resting, at, pair);
      const double across = rate == 0 ? 0 : length(cross(slab.normal, course_.turn.axis)) * rate * away;
      const double approach = across - dot(slab.normal, course_.velocity);
      // However near, they only part.
      if (apart > direction_sure_from_ && slab.thickness > 0 && !(approach > 0)) return;
      if (!(apart > tolerance_)) return record(t, field_place, tree_place, pair);
      // Rounding of the time must not carry them past each other.
      const double reserve = std::max(tolerance_ / 2, kTimeRounding * approach);
      double step = std::max(0.0, approach > 0 ? (slab.thickness - reserve) / approach : 0);
      if (!(slab.thickness > reserve) && fastest > 0)
        step = std::max(step, (apart - kDistanceRounding * extent_of(resting, at) - reserve) / fastest);
      if (rate != 0) step = std::max(step, turning_step(at, t, slab, reserve, across * rate));
      const double later = t + step;
      if (!(later > t)) return record(t, field_place, tree_place, pair);
      t = later;
    }
  }

  // How long it takes at least until a corner over the slab has come down to the reserve. A turn that slides along
  // hardly comes nearer now, and what it does later is known: along the normal no corner is accelerated by more than
  // `bend`. So a corner comes nearer by no more than its approach now times s, plus bend s^2 / 2.
  double turning_step(const Corners& at, double t, const Slab& slab, double reserve, double bend) const {
    if (!(slab.thickness > reserve)) return 0;
    const Vec3 center = course_.center + course_.velocity * t;
    double step = 2;
    for (int k = 0; k < 3; ++k) {
      const Vec3 velocity = course_.velocity + cross(course_.turn.axis, at[k] - center) * course_.turn.angle_rad;
      const double nearing = -dot(slab.normal, velocity), above = slab.height[k] - reserve;
      const double root = std::sqrt(nearing * nearing + 2 * bend * above);
      // The same number twice; each loses its digits where the other does not.
      if (nearing > 0)
        step = std::min(step, 2 * above / (nearing + root));
      else if (bend > 0)
        step = std::min(step, (root - nearing) / bend);
    }
    return step;
  }

  void record(double t, std::uint32_t field_place, std::uint32_t tree_place, const ClosestPair& pair) {
    const double apart = std::sqrt(pair.distance_sq);
    record(t, field_place, tree_place, pair.on_p + pair.way * 0.5, apart > 0 ? pair.way * (1 / apart) : Vec3{});
  }
  void record(double t, std::uint32_t field_place, std::uint32_t tree_place, Vec3 point, Vec3 normal) {
    std::uint32_t a = pair_.field.triangle(field_place), b = pair_.tree.triangle(tree_place);
    if (pair_.swapped) std::swap(a, b);
    result_ = {true, t, a, b, point, normal};
    until_ = std::min(until_, t);
  }

  const Pair& pair_;
  const Course& course_;
  const RelativeMotion relative_;
  const Kernels& kernels_;
  const double tolerance_;
  const double direction_sure_from_;  // nearer than this, the direction between closest points is one of rounding
  const float keep_;                  // distance left after every step
  const float enough_;                // steps this long are taken without asking the fine field
  double from_ = 0, until_ = 0;
  SweepResult result_;
};

void check(const SweepOptions& options) {
  if (!(options.tolerance >= 0) || !(options.tolerance <= 1e30))
    throw Error(ErrorCode::usage,
                "sweep: the tolerance must be from 0 to 1e30; give a small part of the bodies' size, or 0 for the "
                "automatic one");
}

void check(const RigidMotion& motion) {
  validate(motion.from);
  validate(motion.to);
  const Vec3 c = motion.center;
  if (!is_finite(c) || std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) > 1e15)
    throw Error(ErrorCode::usage, "sweep: the motion's center is not finite or past 1e15; give a point of the body");
}

// Times are rounded, and where that alone moves a body by a good part of its size there is nothing left to follow.
void check_length(const CollisionModel& a, const CollisionModel& b, const RigidMotion& motion, double tolerance) {
  const double way = length(apply(motion.to, motion.center) - apply(motion.from, motion.center));
  if (kTimeRounding * way <= std::max(tolerance, (data_of(a).radius + data_of(b).radius) / 8)) return;
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

// How far a point of the body is at the end from where the even turn leads it: rotations need only nearly be some.
double jump_at_end(const Course& course, const ModelData& body) {
  const RigidMotion& m = course.motion;
  if (m.from.rotation == m.to.rotation) return 0;
  double off_sq = 0;
  for (int column = 0; column < 3; ++column) {
    const auto of = [column](const Pose& pose) {
      return Vec3{pose.rotation[column], pose.rotation[3 + column], pose.rotation[6 + column]};
    };
    const Vec3 off = of(m.to) - turned(of(m.from), course.turn.axis, course.turn.angle_rad);
    off_sq += dot(off, off);
  }
  return std::sqrt(off_sq) * (length(body.middle - m.center) + body.radius);
}

}  // namespace

// Half a tolerance is kept between the bodies.
double tolerance_kept(const Pair& pair, const Course& course, double asked) {
  return std::max(asked, 2 * jump_on_way(pair, course));
}

// Times near 1 are rounded by 1e-16, which counts on very long ways: so much the place of a body on its way is
// uncertain.
float distance_kept(const Pair& pair, const Course& course, double tolerance) {
  const double turning = course.turn.angle_rad * length(course.motion.center);
  const double rounding = 4 * kTimeRounding * (length(course.velocity) + length(course.center) + turning);
  return pair.limit(tolerance) + static_cast<float>(rounding);
}

// All the way they were half the tolerance apart; what jumps less has not met.
bool may_jump_at_end(const Course& course, const CollisionModel& moving, double tolerance) {
  return !(jump_at_end(course, data_of(moving)) < tolerance / 4);
}

SweepResult sweep_exactly(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                          const RigidMotion& motion, double asked) {
  const Course course(motion);
  const Pair pair(a, pose_a, b, motion.from);
  const double tolerance = tolerance_kept(pair, course, asked);
  const SweepResult swept = Follow(pair, course, tolerance).run();
  if (swept.hit || !may_jump_at_end(course, b, tolerance)) return swept;
  const Pair end(a, pose_a, b, motion.to);
  const auto found = find_touching(end, 0);
  if (!found) return swept;
  const Corners of_field = end.field.world(found->of_field), of_tree = end.tree.world(found->of_tree);
  const Overlap where = end.swapped ? overlap(of_tree, of_field) : overlap(of_field, of_tree);
  std::uint32_t of_a = end.field.triangle(found->of_field), of_b = end.tree.triangle(found->of_tree);
  if (end.swapped) std::swap(of_a, of_b);
  return {true, 1, of_a, of_b, where.point, where.normal};
}

}  // namespace collision

double automatic_tolerance(const CollisionModel& a, const CollisionModel& b) {
  const auto size = [](const CollisionModel& model) {
    const Vec3 extent = model.bounds().extent();
    return std::max({extent.x, extent.y, extent.z});
  };
  const auto [smaller, larger] = std::minmax(size(a), size(b));
  // Two points have no size: then what rounding leaves counts.
  return std::max({collision::kSweepTolerance * smaller, collision::kLeastSweepTolerance * larger, 1e-100});
}

SweepResult sweep(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const RigidMotion& motion,
                  const SweepOptions& options) try {
  const double tolerance = collision::checked_tolerance(a, b, {&motion, 1}, options);
  validate(pose_a);
  return collision::sweep_exactly(a, pose_a, b, motion, tolerance);
} catch (...) {
  throw_as_error("sweep");
}

std::vector<SweepResult> sweep_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                   std::span<const RigidMotion> motions, const SweepOptions& options,
                                   const Execution& execution, BatchReport* report) try {
  const double tolerance = collision::checked_tolerance(a, b, motions, options);
  validate("sweep", execution, Runs::everywhere);
  validate(pose_a);
  const collision::DeviceRow* const row = collision::find_device(execution.backend, motions.size());
  BatchReport done{row ? row->name : "cpu", row ? row->device_name(execution.device) : ""};
  auto results = row ? collision::sweep_on_device(*row, a, pose_a, b, motions, tolerance, execution, done)
                     : collision::for_each<SweepResult>(motions.size(), execution.threads, [&](std::size_t n) {
                         return collision::sweep_exactly(a, pose_a, b, motions[n], tolerance);
                       });
  if (report) *report = done;
  return results;
} catch (...) {
  throw_as_error("sweep");
}

}  // namespace standoff
