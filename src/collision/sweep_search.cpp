// SPDX-License-Identifier: Apache-2.0
// Conservative advancement on the CPU: for a pair of triangles, in the world and in double precision; and for the
// probe's BVH in the target's distance field.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "collision/sweep.h"
#include "geometry/triangle_pair.h"

namespace standoff::collision {
namespace {

// Finds when a triangle in motion comes within the tolerance of a resting one. Between the two lies a slab
// (geometry/triangle_pair.h), and its normal gives two lower bounds of the time until they touch; each step takes the
// later one.
class TriangleSweep {
 public:
  TriangleSweep(const QueryPair& pair, const AxisAngleMotion& path, double tolerance);

  /// The first contact of two triangles, given by their BVH indices, at a time in [from, until).
  std::optional<SweepResult> first_contact(std::uint32_t target_index, std::uint32_t probe_index, double from,
                                           double until) const;

 private:
  double time_to_reserve(const Corners& moving, double t, const Slab& slab, double reserve, double acceleration) const;
  SweepResult hit(double t, std::uint32_t target_index, std::uint32_t probe_index, Vec3 point, Vec3 normal) const;
  SweepResult hit(double t, std::uint32_t target_index, std::uint32_t probe_index, const ClosestPair& pair) const;

  const QueryPair& pair_;
  const AxisAngleMotion& path_;
  const double tolerance_;
  const double sure_direction_from_;  // at smaller distances, rounding decides the direction between closest points
};

TriangleSweep::TriangleSweep(const QueryPair& pair, const AxisAngleMotion& path, double tolerance)
    : pair_(pair),
      path_(path),
      tolerance_(tolerance),
      sure_direction_from_(std::max(kSureDirection * tolerance, pose_rounding(pair, path))) {}

// Along the normal n of the slab, the speed of approach of the corners is at most `approach`, -n.v + |n x w| * (their
// distance from the axis). If it is not positive, the triangles separate. If there is no slab, they approach no faster
// than the fastest corner moves.
std::optional<SweepResult> TriangleSweep::first_contact(std::uint32_t target_index, std::uint32_t probe_index,
                                                        double from, double until) const {
  const Corners resting = pair_.swapped ? pair_.probe.world(probe_index) : pair_.target.world(target_index);
  const Corners& moving =
      pair_.swapped ? pair_.target.body->corners[target_index] : pair_.probe.body->corners[probe_index];
  const AxisAngle& rotation = path_.rotation;
  const RigidMotion& poses = path_.poses;
  const double rate = rotation.angle_rad;
  double radius = 0;  // the largest distance of a corner from the axis
  if (rate != 0)
    for (const Vec3& corner : moving)
      radius = std::max(radius, length(cross(rotation.axis, rotate(poses.start, corner - poses.center))));
  const double fastest = length(path_.velocity) + rate * radius;
  for (double t = from; t < until;) {
    const Pose pose = path_.at(t);
    const Corners at{apply(pose, moving[0]), apply(pose, moving[1]), apply(pose, moving[2])};
    if (t == 0 && triangles_intersect(resting, at))
      return hit(t, target_index, probe_index, penetration(resting, at).point, {});
    const ClosestPair pair = closest_points(resting, at);
    const double apart = std::sqrt(pair.distance_sq);
    const Slab slab = slab_between(resting, at, pair);
    const double by_rotation = rotation_speed_along(triple_of(slab.normal), triple_of(rotation.axis), rate, radius);
    const double approach = by_rotation - dot(slab.normal, path_.velocity);
    if (apart > sure_direction_from_ && slab.thickness > 0 && !(approach > 0)) return {};  // they separate
    if (!(apart > tolerance_)) return hit(t, target_index, probe_index, pair);
    // Keep a reserve: rounding of the time must not carry them past each other.
    const double reserve = std::max(tolerance_ / 2, kTimeRounding * approach);
    double step = std::max(0.0, approach > 0 ? (slab.thickness - reserve) / approach : 0);
    if (!(slab.thickness > reserve) && fastest > 0)
      step = std::max(step, (apart - kDistanceRounding * extent_of(resting, at) - reserve) / fastest);
    if (rate != 0) step = std::max(step, time_to_reserve(at, t, slab, reserve, by_rotation * rate));
    const double later = t + step;
    if (!(later > t)) return hit(t, target_index, probe_index, pair);
    t = later;
  }
  return {};
}

// The least time until a corner above the slab has come down to the reserve. A rotation that slides along a surface
// hardly approaches it now, and `acceleration` bounds the acceleration of all corners along the normal. So in a time s
// a corner approaches by at most its present speed times s, plus acceleration * s^2 / 2.
double TriangleSweep::time_to_reserve(const Corners& moving, double t, const Slab& slab, double reserve,
                                      double acceleration) const {
  if (!(slab.thickness > reserve)) return 0;
  const Vec3 center = path_.center + path_.velocity * t;
  double time = kNever;
  for (int k = 0; k < 3; ++k) {
    const Vec3 velocity = path_.velocity + cross(path_.rotation.axis, moving[k] - center) * path_.rotation.angle_rad;
    const double speed = -dot(slab.normal, velocity), height = slab.height[k] - reserve;
    const double root = std::sqrt(speed * speed + 2 * acceleration * height);
    // Both branches compute the same number; each form loses digits where the other does not.
    if (speed > 0)
      time = std::min(time, 2 * height / (speed + root));
    else if (acceleration > 0)
      time = std::min(time, (root - speed) / acceleration);
  }
  return time;
}

SweepResult TriangleSweep::hit(double t, std::uint32_t target_index, std::uint32_t probe_index, Vec3 point,
                               Vec3 normal) const {
  const TrianglesOfBoth triangles = pair_.triangles_of(target_index, probe_index);
  return {true, t, triangles.a, triangles.b, point, normal};
}

SweepResult TriangleSweep::hit(double t, std::uint32_t target_index, std::uint32_t probe_index,
                               const ClosestPair& pair) const {
  const double apart = std::sqrt(pair.distance_sq);
  return hit(t, target_index, probe_index, pair.on_p + pair.separation * 0.5,
             apart > 0 ? pair.separation * (1 / apart) : Vec3{});
}

// Bounding spheres are advanced until the field no longer shows that they are free; their children start from there.
// The sphere that stops at the earliest time comes first. A triangle whose sphere has stopped is tested against the
// target's triangles that overlap the box of its next stretch.
class SweepSearch {
 public:
  SweepSearch(const QueryPair& pair, const AxisAngleMotion& path, double tolerance)
      : pair_(pair),
        motion_(relative_motion(pair, path)),
        kernels_(pair.kernels),
        triangles_(pair, path, tolerance),
        keep_(distance_kept(pair, path, tolerance)),
        enough_(static_cast<float>(pair.target.body->field.spacing)) {}

  SweepResult run() {
    visit(pair_.probe.body->bvh.top(), 0, 0);
    return result_;
  }

 private:
  // The spheres of a packet, each with its time.
  struct Lanes {
    MovingSphere sphere[kLanes];
    alignas(64) float gap[kLanes];
    alignas(64) float radius[kLanes];
    bool active[kLanes];
  };

  double end() const { return result_.time; }  // a later contact is not the first
  bool done(double time) const { return time >= end(); }

  void visit(int level, std::uint32_t packet, double start) {
    const Sphere16& spheres = pair_.probe.body->bvh.spheres[level][packet];
    Lanes lanes;
    for (int n = 0; n < kLanes; ++n) {
      const Triple<double> offset = motion_.offset({spheres.center[0][n], spheres.center[1][n], spheres.center[2][n]});
      lanes.sphere[n] = {offset, motion_.speed(offset), start};
      lanes.radius[n] = spheres.radius[n];
      lanes.active[n] = spheres.radius[n] >= 0;
    }
    advance(lanes, level);
    int order[kLanes], stopped = 0;
    for (int n = 0; n < kLanes; ++n)
      if (spheres.radius[n] >= 0 && lanes.sphere[n].time < end()) order[stopped++] = n;
    std::sort(order, order + stopped, [&lanes](int a, int b) {
      const double at_a = lanes.sphere[a].time, at_b = lanes.sphere[b].time;
      return at_a != at_b ? at_a < at_b : lanes.gap[a] < lanes.gap[b];
    });
    for (int k = 0; k < stopped; ++k) {
      const int n = order[k];
      const double time = lanes.sphere[n].time;
      if (done(time)) return;
      const std::uint32_t child = packet * kLanes + n;
      if (level > 0)
        visit(level - 1, child, time);
      else
        follow(child, time);
    }
  }

  // Advances all lanes until their steps are no longer worthwhile.
  void advance(Lanes& lanes, int level) {
    const float least = level == 0 ? kWorthwhileTriangleStep * enough_ : 0;
    alignas(64) float center[3][kLanes] = {};
    for (;;) {
      bool any = false;
      for (int n = 0; n < kLanes; ++n) {
        if (!lanes.active[n]) continue;
        const Triple<double> x = motion_.at(lanes.sphere[n].offset, lanes.sphere[n].time);
        center[0][n] = static_cast<float>(x.x), center[1][n] = static_cast<float>(x.y),
        center[2][n] = static_cast<float>(x.z);
        any = true;
      }
      if (!any) return;
      kernels_.gaps_at(pair_.target.body->view, center, lanes.radius, enough_, lanes.gap);
      for (int n = 0; n < kLanes; ++n)
        if (lanes.active[n])
          lanes.active[n] =
              lanes.sphere[n].step(lanes.gap[n], keep_, end(), std::max(kWorthwhileStep * lanes.radius[n], least));
    }
  }

  // Follows a triangle from time `from` on, against all target triangles near its path.
  void follow(std::uint32_t probe_index, double from) {
    Triple<double> corner[3];
    for (int k = 0; k < 3; ++k)
      corner[k] = triple_of(pair_.probe.body->corners[probe_index][k] - pair_.probe.body->middle);
    const MovingTriangle triangle = moving_triangle(motion_, corner);
    for (double t = from; !done(t);) {
      // Look ahead at least to the next number after t: short steps must not end the search.
      const double ahead = look_ahead(t, triangle.speed, pair_.target.body->field.spacing);
      const double until = std::min(end(), std::max(ahead, std::nextafter(t, kNever)));
      FloatBox box;
      swept_bounds(motion_, triangle, t, until, keep_, box.low, box.high);
      from_ = t, until_ = until;
      descend(pair_.target.body->bvh.top(), 0, probe_index, box);
      t = until;
      if (!done(t)) t = jump(probe_index, t);
    }
  }

  // The time until which the field shows the triangle's sphere to be free, from a time at which the triangle is free.
  double jump(std::uint32_t probe_index, double t) {
    const Sphere16& spheres = pair_.probe.body->bvh.spheres[0][probe_index / kLanes];
    const int n = static_cast<int>(probe_index % kLanes);
    const Triple<double> offset = motion_.offset({spheres.center[0][n], spheres.center[1][n], spheres.center[2][n]});
    return advanced({offset, motion_.speed(offset), t}, spheres.radius[n], motion_, pair_.target.body->view, keep_,
                    end(), kWorthwhileTriangleStep * enough_);
  }

  void descend(int level, std::uint32_t node, std::uint32_t probe_index, const FloatBox& box) {
    for (std::uint32_t mask = kernels_.overlapping(pair_.target.body->bvh.boxes(level)[node], box); mask != 0;
         mask &= mask - 1) {
      const std::uint32_t child = node * kLanes + std::countr_zero(mask);
      if (level > 0)
        descend(level - 1, child, probe_index, box);
      else if (const auto contact = triangles_.first_contact(child, probe_index, from_, until_))
        result_ = *contact, until_ = std::min(until_, contact->time);
    }
  }

  const QueryPair& pair_;
  const RelativeMotion motion_;
  const Kernels& kernels_;
  const TriangleSweep triangles_;
  const float keep_;             // the distance left after every step
  const float enough_;           // steps this long are taken without sampling the fine field
  double from_ = 0, until_ = 0;  // the interval in which follow() looks for contacts
  SweepResult result_;           // the first contact so far
};

}  // namespace

SweepResult first_contact(const QueryPair& pair, const AxisAngleMotion& path, double tolerance) {
  return SweepSearch(pair, path, tolerance).run();
}

}  // namespace standoff::collision
