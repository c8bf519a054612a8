// SPDX-License-Identifier: Apache-2.0
// How far apart are two surfaces? Best first: the probe's bounding spheres against the target's field, nearest first;
// a triangle whose sphere may be nearer than the best pair so far goes down the target's BVH.
#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/close_pairs.h"
#include "collision/collide.h"
#include "core/guarded.h"
#include "geometry/triangle_pair.h"

namespace standoff {
namespace collision {
namespace {

// The best of the bounds s - |x - x_i| from the eight samples around x: of the fine field, or of the coarse one where
// the fine one is clamped. The sample behind x, seen from the surface, loses little, whereas the nearest one loses up
// to sqrt(3)/2 spacings; each look costs as much as all sixteen lanes of the kernel, so it is for spheres that are left
// over.
float bound_from_eight(const FieldView& f, const float* x) {
  const auto best_of = [x, &f](float spacing, float per_spacing, const float* last, auto value) {
    std::int32_t cell[3];
    float at[3];
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = (x[axis] - f.origin[axis]) * per_spacing;
      if (!(at[axis] >= 0 && at[axis] < last[axis])) return -kInfinity;
      cell[axis] = static_cast<std::int32_t>(at[axis]);
    }
    float best = -kInfinity;
    for (int corner = 0; corner < 8; ++corner) {
      const std::int32_t i = cell[0] + (corner & 1), j = cell[1] + (corner >> 1 & 1), k = cell[2] + (corner >> 2);
      const float u = at[0] - static_cast<float>(i), v = at[1] - static_cast<float>(j),
                  w = at[2] - static_cast<float>(k);
      best = std::max(best, value(i, j, k) - spacing * std::sqrt(u * u + v * v + w * w));
    }
    return best;
  };
  bool clamped = false;
  const float fine = best_of(f.spacing, f.per_spacing, f.last, [&](std::int32_t i, std::int32_t j, std::int32_t k) {
    const std::uint8_t sample = fine_sample(f, tile_of(f, i, j, k), index_in_tile(i, j, k));
    clamped = clamped || sample == kClampedSample;
    return static_cast<float>(sample) * f.step;
  });
  if (!clamped) return fine;
  return std::max(fine, best_of(f.coarse_spacing, f.per_coarse_spacing, f.coarse_last,
                                [&](std::int32_t i, std::int32_t j, std::int32_t k) {
                                  return f.coarse[coarse_index(f, i, j, k)];
                                }));
}

class DistanceSearch {
 public:
  DistanceSearch(const QueryPair& pair, double tolerance, double limit)
      : pair_(pair), kernels_(pair.kernels), tolerance_(tolerance), best_(limit), batch_(pair) {
    lower_reach();
  }

  void run() {
    if (pair_.root_gap() > reach_) return;
    visit(pair_.probe.body->bvh.top(), 0);
  }

  double best() const { return best_; }
  bool found() const { return found_; }
  Vec3 on_target, on_probe;                   ///< the closest points
  std::uint32_t of_target = 0, of_probe = 0;  ///< indices in the BVHs' orders

 private:
  // Bounds above this cannot hide a pair that is nearer than the best one by more than the tolerance.
  void lower_reach() {
    reach_ = static_cast<float>(std::min((best_ - tolerance_) * (1 + 1e-6), kMaxMargin)) + pair_.slack;
    reach_sq_ = reach_ < 0 ? -1 : reach_ * reach_ * kRoundUp;
  }

  void visit(int level, std::uint32_t packet) {
    alignas(64) float gap[kLanes];
    const Sphere16& spheres = pair_.probe.body->bvh.spheres[level][packet];
    kernels_.gaps(pair_.target.body->view, pair_.transform, spheres, reach_, gap);
    int lanes[kLanes];
    const int count = lanes_within(gap, reach_, lanes);
    for (int n = 0; n < count && gap[lanes[n]] <= reach_; ++n) {
      if (found_ && level <= 1 && closer_look(spheres, lanes[n]) > reach_) continue;
      const std::uint32_t child = packet * kLanes + lanes[n];
      if (level > 0) {
        visit(level - 1, child);
      } else {
        descend(pair_.target.body->bvh.top(), 0, child, pair_.box_of(child));
      }
    }
    if (level == 0) measure();
  }

  float closer_look(const Sphere16& spheres, int lane) const {
    float x[3];
    for (int axis = 0; axis < 3; ++axis)
      x[axis] =
          transformed(pair_.transform, axis, spheres.center[0][lane], spheres.center[1][lane], spheres.center[2][lane]);
    return bound_from_eight(pair_.target.body->view, x) - spheres.radius[lane];
  }

  void descend(int level, std::uint32_t node, std::uint32_t probe_index, const FloatBox& box) {
    alignas(64) float distance_sq[kLanes];
    kernels_.distances_sq(pair_.target.body->bvh.boxes(level)[node], box, distance_sq);
    int lanes[kLanes], count = 0;
    for (int n = 0; n < kLanes; ++n)
      if (distance_sq[n] <= reach_sq_) lanes[count++] = n;
    std::sort(lanes, lanes + count, [&](int a, int b) { return distance_sq[a] < distance_sq[b]; });
    for (int n = 0; n < count && distance_sq[lanes[n]] <= reach_sq_; ++n) {
      const std::uint32_t child = node * kLanes + lanes[n];
      if (level > 0)
        descend(level - 1, child, probe_index, box);
      else
        add(child, probe_index);
    }
  }

  // While nothing is found every pair counts; later the reach may lag behind a little.
  void add(std::uint32_t target_index, std::uint32_t probe_index) {
    batch_.add(target_index, probe_index);
    if (batch_.full() || !found_) measure();
  }

  void measure() {
    bool nearer = false;
    batch_.measure(
        [&](std::uint32_t target_index, std::uint32_t probe_index, double distance_sq, Vec3 of_p, Vec3 of_q) {
          if (!(distance_sq < best_ * best_)) return;
          best_ = std::sqrt(distance_sq);
          on_target = of_p, on_probe = of_q;
          of_target = target_index, of_probe = probe_index;
          found_ = nearer = true;
        });
    if (nearer) lower_reach();
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const double tolerance_;
  double best_;
  float reach_ = 0, reach_sq_ = 0;
  bool found_ = false;
  PairBatch batch_;
};

DistanceResult distance_checked(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                const Pose& pose_b, const DistanceOptions& options, const Kernels& kernels) {
  const QueryPair pair(a, pose_a, b, pose_b, kernels);
  DistanceResult result;
  std::uint32_t of_target = 0, of_probe = 0;
  Vec3 on_target, on_probe;
  if (const auto intersecting = find_intersecting_pair(pair, 0)) {
    of_target = intersecting->of_target, of_probe = intersecting->of_probe;
    on_target = on_probe = common_point(pair.target.world(of_target), pair.probe.world(of_probe));
  } else {
    DistanceSearch search(pair, options.tolerance, options.limit);
    search.run();
    if (!search.found()) {
      result.lower = options.limit;
      result.upper = std::numeric_limits<double>::infinity();
      return result;
    }
    of_target = search.of_target, of_probe = search.of_probe;
    on_target = search.on_target, on_probe = search.on_probe;
    result.upper = search.best();
    result.lower = std::max(0.0, result.upper - options.tolerance);
  }
  if (pair.swapped) std::swap(on_target, on_probe);
  result.point_a = on_target, result.point_b = on_probe;
  const TrianglesOfBoth triangles = pair.triangles_of(of_target, of_probe);
  result.triangle_a = triangles.a, result.triangle_b = triangles.b;
  return result;
}

void check(const DistanceOptions& options) {
  if (!(options.tolerance >= 0) || !(options.limit >= 0) || !std::isfinite(options.tolerance))
    throw Error(ErrorCode::usage,
                "distance: tolerance and limit must be zero or more, and the tolerance finite; without them the "
                "distance is exact");
}

}  // namespace
}  // namespace collision

DistanceResult distance(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                        const DistanceOptions& options) try {
  collision::check(options);
  validate(pose_a);
  validate(pose_b);
  return collision::distance_checked(a, pose_a, b, pose_b, options, collision::best_kernels());
} catch (...) {
  throw_as_error("distance");
}

std::vector<DistanceResult> distance_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                         std::span<const Pose> poses_b, const DistanceOptions& options,
                                         const Execution& execution) try {
  collision::check(options);
  validate("distance", execution, Runs::on_the_cpu);
  validate(pose_a);
  collision::validate_all(poses_b);
  const collision::Kernels& kernels = collision::kernels_for(execution.simd, "distance");
  return collision::for_each<DistanceResult>(poses_b.size(), execution.threads, [&](std::size_t n) {
    return collision::distance_checked(a, pose_a, b, poses_b[n], options, kernels);
  });
} catch (...) {
  throw_as_error("distance");
}

}  // namespace standoff
