// SPDX-License-Identifier: Apache-2.0
// The two bodies of a query: the probe's bounding spheres sample the target's distance field. And a loop that spreads
// many queries over threads.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "collision/body/body.h"
#include "collision/cpu/kernels.h"
#include "collision/tolerances.h"
#include "core/threads.h"
#include "standoff/error.h"
#include "standoff/pose.h"

namespace standoff::collision {

/// A pose in the form of the kernels.
inline DoubleTransform transform_of(const Pose& pose) {
  DoubleTransform transform;
  for (int n = 0; n < 9; ++n) transform.rotation[n] = pose.rotation[n];
  transform.translation[0] = pose.translation.x;
  transform.translation[1] = pose.translation.y;
  transform.translation[2] = pose.translation.z;
  return transform;
}

/// A body with its pose in the world.
struct PlacedBody {
  const BodyData* body;
  Pose pose;
  bool moved;  ///< the pose is not the identity

  PlacedBody(const BodyData& data, const Pose& at) : body(&data), pose(at), moved(!(at == Pose{})) {}
  /// The corners of a triangle in the world, by its index in the BVH. All exact answers are about these corners.
  Corners world(std::uint32_t index) const {
    const Corners& c = body->corners[index];
    if (!moved) return c;
    return {apply(pose, c[0]), apply(pose, c[1]), apply(pose, c[2])};
  }
};

/// The pose with its matrix made orthonormal, up to rounding.
Pose orthonormal(Pose pose);

/// Takes coordinates relative to `middle` of a body at a pose to coordinates relative to the point `origin` of the
/// world in an orthonormal frame.
Pose relative_pose(const Pose& frame, const Vec3& origin, const Pose& pose, const Vec3& middle);

/// A triangle of body a and one of body b, by their indices in the meshes.
struct TrianglesOfBoth {
  std::uint32_t a, b;
};

/// The target is the larger body. `transform` and `relative` take coordinates of the probe to coordinates of the
/// target, both relative to the bodies' middles.
struct QueryPair {
  PlacedBody target, probe;
  bool swapped;  ///< whether a is the probe
  /// The target's pose with an orthonormal rotation. So errors of the pose's matrix grow with the size of the body, not
  /// with its distance from the other one.
  Pose frame;
  Pose relative;
  FloatTransform transform;
  /// A bound of the coordinates in the transforms of both bodies to the world.
  double far;
  /// The error of bounds in single precision in the target's frame, compared with the world: docs/collision.md.
  float slack;
  /// The part of it that does not come from single precision: poses that are only nearly rigid, and the double
  /// precision of the world.
  double pose_slack;
  const Kernels& kernels;

  QueryPair(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, const Kernels& with_kernels);

  /// The triangles of a and b, by their indices in the BVHs of target and probe.
  TrianglesOfBoth triangles_of(std::uint32_t target_index, std::uint32_t probe_index) const {
    const std::uint32_t first = target.body->bvh.order()[target_index], second = probe.body->bvh.order()[probe_index];
    return swapped ? TrianglesOfBoth{second, first} : TrianglesOfBoth{first, second};
  }

  /// Whether the target's field, which covers the whole target at once, gives better bounds for the probe's spheres
  /// than boxes do.
  bool probe_is_small() const { return kSmallProbe * probe.body->radius < target.body->radius; }
  /// A lower bound of the distance: from the probe's bounding sphere to the target's box.
  double root_gap() const;
  /// If spheres or boxes are farther apart than this in single precision, they are farther apart than the margin.
  float limit(double margin) const { return static_cast<float>(margin) * kRoundUp + slack; }
  /// Whether root_gap() or the bodies' boxes show that they are farther apart than the margin.
  bool apart(double margin) const { return root_gap() > margin + slack || boxes_apart(margin + slack); }
  /// Whether a face of one of the bodies' oriented boxes separates them by more than `by`.
  bool boxes_apart(double by) const;
  /// The probe's box in the target's frame, grown by `by`.
  FloatBox region(float by) const;
};

/// Counts the steps of a query, or of the sweeps along a path together: pairs of BVH nodes that are looked at and pairs
/// of triangles that are tested or measured. The count depends on the bodies and the poses alone, never on the
/// instruction set.
class Steps {
 public:
  /// 0: no limit.
  explicit Steps(std::int64_t most) : most_(most == 0 ? std::numeric_limits<std::int64_t>::max() : most) {}
  void take(std::int64_t count = 1) { taken_ += count; }
  std::int64_t taken() const { return taken_; }
  bool are_spent() const { return taken_ >= most_; }

 private:
  std::int64_t most_, taken_ = 0;
};

/// Writes the lanes whose gap is at most `limit`, the nearest first; returns their number.
inline int lanes_within(const float (&gap)[kLanes], float limit, int (&lanes)[kLanes]) {
  int count = 0;
  for (int n = 0; n < kLanes; ++n)
    if (gap[n] <= limit) lanes[count++] = n;
  std::sort(lanes, lanes + count, [&gap](int a, int b) { return gap[a] < gap[b]; });
  return count;
}

/// Throws Error{usage} that names the first pose that is not rigid.
inline void validate_all(std::span<const Pose> poses) {
  for (std::size_t n = 0; n < poses.size(); ++n) try {
      validate(poses[n]);
    } catch (const Error& error) {
      throw Error(error.code(), std::string(error.what()) + " (pose " + std::to_string(n) + ")", error.details());
    }
}

/// The results of query(0) to query(count - 1), in this order. Threads take queries in small groups, as some take a
/// thousand times as long as others.
template <class Result, class Query>
std::vector<Result> for_each(std::size_t count, int threads, Query query) {
  std::vector<Result> results(count);
  if (count == 1) {
    results[0] = query(0);
    return results;
  }
  Threads(threads).run([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) results[n] = query(n);
    });
  });
  return results;
}

}  // namespace standoff::collision
