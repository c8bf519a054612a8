// SPDX-License-Identifier: Apache-2.0
// The parts of collide(): the verdict of the fields alone, the search for a pair of triangles that intersect, which
// other queries begin with too, the test of which body is inside the other, and batches of poses on a device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "collision/device.h"
#include "collision/query_pair.h"
#include "standoff/collision.h"

namespace standoff::collision {

/// The verdict of the target's distance field alone: free, hit (only if the margin is positive) or ambiguous.
Verdict certify(const QueryPair& pair, double margin);

/// Two triangles by their BVH indices.
struct IntersectingPair {
  std::uint32_t of_target, of_probe;
};

/// A pair of triangles that intersect or are within the margin; nothing if there is none, or if the steps were spent
/// before one was found.
std::optional<IntersectingPair> find_intersecting_pair(const QueryPair& pair, double margin, Steps& steps);
inline std::optional<IntersectingPair> find_intersecting_pair(const QueryPair& pair, double margin) {
  Steps unlimited(0);
  return find_intersecting_pair(pair, margin, unlimited);
}

/// The side of a closed surface that a point is on.
enum class Side { unknown, outside, inside };

/// Finds the side of a point from the fields; near the surface it is unknown. A known side is certain: if a sample is
/// nearer to x than to the surface, it is on the same side, because the segment between the two does not cross the
/// surface. `x` is relative to the body's middle; `slack` bounds the sum of the errors of x, the surface and the
/// samples' values. Requires a closed body.
Side side_of(const BodyData& body, Vec3 x, double slack);

/// Tests whether points of the world are inside a closed body. The answer is exact for the body's surface with its
/// corners rounded to world coordinates, the same surface that verdicts are about.
class InsideTest {
 public:
  /// Requires a closed body, which must outlive the test.
  explicit InsideTest(const PlacedBody& container);

  /// Whether another body is certainly outside this one's box.
  bool is_apart(const PlacedBody& other) const;
  /// Whether the winding number at a point of the world is positive. Requires a point that is not on the surface.
  bool is_inside(Vec3 point) const;
  /// The same by a ray, without the fields.
  bool is_inside_by_ray(Vec3 point) const { return winding(point, container_.body->bvh.top(), 0) > 0; }

 private:
  Vec3 in_body(Vec3 point) const { return rotate_back(container_.pose, point - middle_); }
  int winding(Vec3 point, int level, std::uint32_t packet) const;

  const PlacedBody& container_;
  Vec3 middle_;          // the container's middle in the world
  double slack_;         // error of points in the container's coordinates
  double sphere_slack_;  // error of its bounding spheres in the world
};

/// Throws Error{input} unless at least one of the bodies is closed.
void require_closed(const Body& a, const Body& b);

/// Requires surfaces that do not intersect.
Containment containment(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b);

/// Exact collide() for many poses at once. The device decides most poses, the CPU decides the others; `report` counts
/// both. Requires poses that collide_all() has checked.
std::vector<CollisionResult> collide_on_device(const DeviceRow& row, const Body& a, const Pose& pose_a, const Body& b,
                                               std::span<const Pose> poses_b, double margin, const Execution& execution,
                                               BatchReport& report, int stack = kDeviceStack);

}  // namespace standoff::collision
