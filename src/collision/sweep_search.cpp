// SPDX-License-Identifier: Apache-2.0
// Bounding spheres are advanced until the field no longer shows that they are free, those that stop first first; their
// children start from there. A triangle whose sphere has stopped is tested against the target triangles that overlap
// the box it sweeps next.
#include "collision/sweep_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/body/sphere_bound.h"
#include "collision/conservative_advancement.h"
#include "collision/sweep_rounding.h"
#include "collision/sweep_triangles.h"

namespace standoff::collision {
namespace {

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
  // The spheres of one packet, each with its time.
  struct Lanes {
    MovingSphere sphere[kLanes];
    alignas(64) float gap[kLanes];
    alignas(64) float radius[kLanes];
    bool active[kLanes];
  };

  double end() const { return result_.time; }  // nothing later is of interest
  bool done(double time) const { return time >= end(); }

  void visit(int level, std::uint32_t packet, double start) {
    const Sphere16& spheres = pair_.probe.body->bvh.levels[level].spheres[packet];
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

  // One triangle from time `from` on, against all target triangles near its path.
  void follow(std::uint32_t probe_index, double from) {
    Triple<double> corner[3];
    for (int k = 0; k < 3; ++k)
      corner[k] = triple_of(pair_.probe.body->corners[probe_index][k] - pair_.probe.body->middle);
    const MovingTriangle triangle = moving_triangle(motion_, corner);
    for (double t = from; !done(t);) {
      // At least to the next number after t: short steps must not end the search.
      const double ahead = look_ahead(t, triangle.speed, pair_.target.body->field.spacing);
      const double until = std::min(end(), std::max(ahead, std::nextafter(t, kNever)));
      FloatBox box;
      swept_bounds(motion_, triangle, t, until, keep_, box.min, box.max);
      from_ = t, until_ = until;
      descend(pair_.target.body->bvh.top(), 0, probe_index, box);
      t = until;
      if (!done(t)) t = jump(probe_index, t);
    }
  }

  // As far as the field lets the triangle's sphere go from a time at which the triangle is free.
  double jump(std::uint32_t probe_index, double t) {
    const Sphere16& spheres = pair_.probe.body->bvh.levels[0].spheres[probe_index / kLanes];
    const int n = static_cast<int>(probe_index % kLanes);
    const Triple<double> offset = motion_.offset({spheres.center[0][n], spheres.center[1][n], spheres.center[2][n]});
    return advanced({offset, motion_.speed(offset), t}, spheres.radius[n], motion_, pair_.target.body->view, keep_,
                    end(), kWorthwhileTriangleStep * enough_);
  }

  void descend(int level, std::uint32_t node, std::uint32_t probe_index, const FloatBox& box) {
    for (std::uint32_t mask = kernels_.overlaps(pair_.target.body->bvh.levels[level].boxes[node], box); mask != 0;
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
  const float keep_;             // distance left after every step
  const float enough_;           // steps this long are taken without asking the fine field
  double from_ = 0, until_ = 0;  // the interval in which follow() looks for contacts
  SweepResult result_;           // the first contact so far
};

}  // namespace

SweepResult first_contact(const QueryPair& pair, const AxisAngleMotion& path, double tolerance) {
  return SweepSearch(pair, path, tolerance).run();
}

}  // namespace standoff::collision
