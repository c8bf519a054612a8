// SPDX-License-Identifier: Apache-2.0
// The probe's bounding spheres against the target's field, nearest first; triangles where the field cannot decide.
#include "collision/find_intersecting.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/close_pairs.h"
#include "collision/pair_batch.h"

namespace standoff::collision {
namespace {

class IntersectionSearch {
 public:
  IntersectionSearch(const QueryPair& pair, double margin)
      : pair_(pair),
        kernels_(pair.kernels),
        margin_(margin),
        limit_(pair.limit(margin)),
        close_(pair, limit_),
        batch_(pair) {}

  std::optional<IntersectingPair> run() {
    if (pair_.apart(margin_) || !visit(pair_.probe.body->bvh.top(), 0)) return {};
    return found_;
  }

 private:
  bool visit(int level, std::uint32_t packet) {
    if (level == 0) {
      // The packet reaches the surface: its triangles' boxes tell more than the field would.
      const bool none =
          close_.visit(packet, ClosePairs::kAllLanes, [this](std::uint32_t target_index, std::uint32_t probe_index) {
            batch_.add(target_index, probe_index);
            return !batch_.full() || settle();
          });
      return !(none && settle());
    }
    alignas(64) float gap[kLanes];
    const BvhLevel& nodes = pair_.probe.body->bvh.levels[level];
    kernels_.gaps(pair_.target.body->view, pair_.transform, nodes.spheres[packet], limit_, gap);
    int lanes[kLanes];
    const int count = lanes_within(gap, limit_, lanes);
    for (int n = 0; n < count; ++n)
      if (visit(level - 1, packet * kLanes + lanes[n])) return true;
    return false;
  }

  // False when one of the pairs intersects.
  bool settle() {
    return batch_.settle([this](std::uint32_t target_index, std::uint32_t probe_index, bool intersecting, auto&&) {
      bool hit = intersecting;
      if (!hit && margin_ > 0) {
        const Corners p = pair_.target.world(target_index), q = pair_.probe.world(probe_index);
        hit = closest_points(p, q).distance_sq <= margin_ * margin_;
      }
      if (hit) found_ = {target_index, probe_index};
      return !hit;
    });
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;  // spheres and boxes farther away than this are farther than the margin
  ClosePairs close_;
  PairBatch batch_;
  IntersectingPair found_{};
};

}  // namespace

std::optional<IntersectingPair> find_intersecting_pair(const QueryPair& pair, double margin) {
  // Bodies of one shape at one pose have the same first triangle.
  if (pair.relative == Pose{} && triangles_intersect(pair.target.world(0), pair.probe.world(0)))
    return IntersectingPair{0, 0};
  return IntersectionSearch(pair, margin).run();
}

}  // namespace standoff::collision
