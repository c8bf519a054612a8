// SPDX-License-Identifier: Apache-2.0
// Conservative advancement on the CPU: of pairs of triangles, in the world; of pairs of nodes of both BVHs; and of the
// probe's BVH in the target's distance field.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "collision/moving_nodes.h"
#include "collision/sweep.h"
#include "core/threads.h"
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

// Pairs of nodes wait in the order of the times until which they are apart, and the earliest is advanced, opened or, if
// both nodes are leaves, followed: so nothing behind the first contact is looked at. Where the probe is small, the
// target's field first advances the probe's spheres against the whole target.
class SweepSearch {
 public:
  SweepSearch(const QueryPair& pair, const AxisAngleMotion& path, double tolerance, Steps& steps)
      : pair_(pair),
        triangles_(pair, path, tolerance),
        nodes_(pair, path, reserve_of_nodes(pair, path, tolerance)),
        field_pays_(pair.probe_is_small()),
        motion_(relative_motion(pair, path)),
        keep_(distance_kept(pair, path, tolerance)),
        enough_(static_cast<float>(pair.target.body->field.spacing)),
        steps_(steps),
        before_(steps.taken()) {}

  SweepResult run() {
    waiting_->clear();
    push(with_target(pair_.probe.body->bvh.top(), 0, 0));
    while (!waiting_->empty()) {
      const MovingNodes next = pop();
      if (done(next.time)) break;
      if (steps_.are_spent()) {
        // All others that wait are apart until later.
        SweepResult unfinished;
        unfinished.time = next.time;
        unfinished.finished = false;
        return unfinished;
      }
      steps_.take();
      if (steps_.taken() - before_ > kWorthOrbits * nodes_.leaves() && !knows_orbits_) {
        nodes_.find_orbits();
        knows_orbits_ = true;
      }
      if (nodes_.stay_apart(next)) continue;
      if (field_pays_ && has_whole_target(next))
        advance_by_field(next);
      else
        advance_by_boxes(next);
    }
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

  void push(const MovingNodes& nodes) {
    if (done(nodes.time)) return;
    waiting_->push_back(nodes);
    std::ranges::push_heap(*waiting_, std::ranges::greater{}, &MovingNodes::time);
  }
  MovingNodes pop() {
    std::ranges::pop_heap(*waiting_, std::ranges::greater{}, &MovingNodes::time);
    const MovingNodes next = waiting_->back();
    waiting_->pop_back();
    return next;
  }

  void advance_by_boxes(MovingNodes nodes) {
    const bool another_pays = nodes_.advance(nodes);
    if (another_pays || done(nodes.time)) return push(nodes);
    if (nodes.is_leaf()) return follow(nodes);
    std::array<MovingNodes, kLanes> children;
    const int count = nodes_.open(nodes, end(), children);
    for (int n = 0; n < count; ++n) push(children[static_cast<std::size_t>(n)]);
  }

  // Follows the triangles of two leaves for a while: a shorter one if too many pairs may meet in it.
  void follow(MovingNodes leaves) {
    const double from = leaves.time, all = nodes_.time_of_size(leaves);
    nodes_.take(leaves);
    if (!nodes_.may_meet()) return;
    MovingNodePairs::LeafPairs pairs;
    double until = 0;
    for (bool shorter = true; shorter;) {
      // At least to the next number: short times must not end the search.
      until = std::min(end(), std::max(from + leaves.share * all, std::nextafter(from, kNever)));
      const int count = nodes_.approaching(until - from, pairs);
      shorter = count > kPairsAtOnce && leaves.share > kLeastShare;
      if (shorter)
        leaves.share /= 2;
      else if (count < kPairsAtOnce / 4)
        leaves.share = std::min(1.0f, 2 * leaves.share);
    }
    leaves.time = until;
    leaves.stuck = false;
    for (std::uint32_t n = 0; n < kLanes; ++n)
      for (std::uint32_t left = pairs[n]; left != 0; left &= left - 1) {
        std::uint32_t of_target = leaves.resting * kLanes + n,
                      of_probe = leaves.moving * kLanes + static_cast<std::uint32_t>(std::countr_zero(left));
        if (pair_.swapped) std::swap(of_target, of_probe);
        steps_.take();
        if (const auto contact = triangles_.first_contact(of_target, of_probe, from, until))
          result_ = *contact, until = std::min(until, contact->time);
      }
    push(leaves);
  }

  // A node of the probe with the whole target.
  MovingNodes with_target(int level, std::uint32_t node, double time) const {
    const auto whole = static_cast<std::int8_t>(pair_.target.body->bvh.top()), part = static_cast<std::int8_t>(level);
    return pair_.swapped ? MovingNodes{time, node, 0, part, whole} : MovingNodes{time, 0, node, whole, part};
  }
  bool has_whole_target(const MovingNodes& nodes) const {
    return (pair_.swapped ? nodes.moving_level : nodes.resting_level) == pair_.target.body->bvh.top();
  }

  // Advances the spheres around a node's children.
  void advance_by_field(const MovingNodes& nodes) {
    const int level = pair_.swapped ? nodes.resting_level : nodes.moving_level;
    const std::uint32_t node = pair_.swapped ? nodes.resting : nodes.moving;
    const Sphere16& spheres = pair_.probe.body->bvh.spheres[static_cast<std::size_t>(level)][node];
    Lanes lanes;
    for (int n = 0; n < kLanes; ++n) {
      const Triple<double> offset = motion_.offset({spheres.center[0][n], spheres.center[1][n], spheres.center[2][n]});
      lanes.sphere[n] = {offset, motion_.speed(offset), nodes.time};
      lanes.radius[n] = spheres.radius[n];
      lanes.active[n] = spheres.radius[n] >= 0;
    }
    advance(lanes, level == 0 ? kWorthwhileTriangleStep * enough_ : 0);
    double first = end();
    for (int n = 0; n < kLanes; ++n) {
      if (spheres.radius[n] < 0) continue;
      if (level > 0) push(with_target(level - 1, node * kLanes + static_cast<std::uint32_t>(n), lanes.sphere[n].time));
      first = std::min(first, lanes.sphere[n].time);
    }
    // A leaf stays apart as long as all its triangles do.
    if (level == 0 && !done(first)) advance_by_boxes(with_target(0, node, first));
  }

  // Advances all lanes until their steps are no longer worthwhile.
  void advance(Lanes& lanes, float least) const {
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
      pair_.kernels.gaps_at(pair_.target.body->view, center, lanes.radius, enough_, lanes.gap);
      for (int n = 0; n < kLanes; ++n)
        if (lanes.active[n])
          lanes.active[n] =
              lanes.sphere[n].step(lanes.gap[n], keep_, end(), std::max(kWorthwhileStep * lanes.radius[n], least));
    }
  }

  const QueryPair& pair_;
  const TriangleSweep triangles_;
  MovingNodePairs nodes_;
  const bool field_pays_;
  const RelativeMotion motion_;  // of the probe
  const float keep_;             // the distance that spheres leave after every step
  const float enough_;           // steps this long are taken without sampling the fine field
  SweepResult result_;           // the first contact so far
  Steps& steps_;                 // pairs of nodes and of triangles
  const std::int64_t before_;    // the steps of the motions before
  bool knows_orbits_ = false;
  const KeptByThread<std::vector<MovingNodes>> waiting_;
};

}  // namespace

SweepResult first_contact(const QueryPair& pair, const AxisAngleMotion& path, double tolerance, Steps& steps) {
  return SweepSearch(pair, path, tolerance, steps).run();
}

}  // namespace standoff::collision
