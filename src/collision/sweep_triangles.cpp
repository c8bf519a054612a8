// SPDX-License-Identifier: Apache-2.0
#include "collision/sweep_triangles.h"

#include <algorithm>
#include <cmath>

#include "collision/conservative_advancement.h"
#include "collision/sweep_rounding.h"
#include "geometry/triangle_pair.h"

namespace standoff::collision {

TriangleSweep::TriangleSweep(const QueryPair& pair, const AxisAngleMotion& path, double tolerance)
    : pair_(pair),
      path_(path),
      tolerance_(tolerance),
      sure_direction_from_(std::max(kSureDirection * tolerance, pose_rounding(pair, path))) {}

// Along the normal n of the slab the corners approach by no more than `approach` per time, -n.v + |n x w| * (their
// distance from the axis). Where that is not positive the triangles separate. Where there is no slab they approach no
// faster than the fastest corner moves.
std::optional<SweepResult> TriangleSweep::first_contact(std::uint32_t target_index, std::uint32_t probe_index,
                                                        double from, double until) const {
  const Corners resting = pair_.swapped ? pair_.probe.world(probe_index) : pair_.target.world(target_index);
  const Corners& moving =
      pair_.swapped ? pair_.target.body->corners[target_index] : pair_.probe.body->corners[probe_index];
  const AxisAngle& rotation = path_.rotation;
  const RigidMotion& poses = path_.poses;
  const double rate = rotation.angle_rad;
  double radius = 0;  // of the corners about the axis
  if (rate != 0)
    for (const Vec3& corner : moving)
      radius = std::max(radius, length(cross(rotation.axis, rotate(poses.from, corner - poses.center))));
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
    if (apart > sure_direction_from_ && slab.thickness > 0 && !(approach > 0)) return {};  // however near
    if (!(apart > tolerance_)) return hit(t, target_index, probe_index, pair);
    // Rounding of the time must not carry them past each other.
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
// hardly approaches it now, and what it does later is bounded: along the normal no corner is accelerated by more than
// `acceleration`. So a corner approaches by its speed now times s, plus acceleration * s^2 / 2, at the most.
double TriangleSweep::time_to_reserve(const Corners& moving, double t, const Slab& slab, double reserve,
                                      double acceleration) const {
  if (!(slab.thickness > reserve)) return 0;
  const Vec3 center = path_.center + path_.velocity * t;
  double time = kNever;
  for (int k = 0; k < 3; ++k) {
    const Vec3 velocity = path_.velocity + cross(path_.rotation.axis, moving[k] - center) * path_.rotation.angle_rad;
    const double speed = -dot(slab.normal, velocity), height = slab.height[k] - reserve;
    const double root = std::sqrt(speed * speed + 2 * acceleration * height);
    // The same number in two forms; each loses digits where the other does not.
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

}  // namespace standoff::collision
