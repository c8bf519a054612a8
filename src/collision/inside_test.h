// SPDX-License-Identifier: Apache-2.0
// Whether points of the world are inside a closed body.
#pragma once

#include <cstdint>

#include "collision/query_pair.h"

namespace standoff::collision {

/// Exact: the winding number is that of the body's surface with its corners in world coordinates, as the verdicts are.
class InsideTest {
 public:
  /// Requires a closed body, which must outlive the test.
  explicit InsideTest(const PlacedModel& container);

  /// Whether another body is certainly outside this one's box.
  bool is_apart(const PlacedModel& other) const;
  /// Whether the winding number at a point of the world is positive. Requires a point that is not on the surface.
  bool is_inside(Vec3 point) const;
  /// The same without the fields: by a ray.
  bool is_inside_by_ray(Vec3 point) const { return winding(point, container_.body->bvh.top(), 0) > 0; }

 private:
  Vec3 in_body(Vec3 point) const { return rotate_back(container_.pose, point - middle_); }
  int winding(Vec3 point, int level, std::uint32_t packet) const;

  const PlacedModel& container_;
  Vec3 middle_;          // of the container, in the world
  double slack_;         // of points in the container's coordinates
  double sphere_slack_;  // of its bounding spheres in the world
};

}  // namespace standoff::collision
