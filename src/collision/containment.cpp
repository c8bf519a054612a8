// SPDX-License-Identifier: Apache-2.0
// A connected component of one surface that does not intersect the other surface lies on one side of it: a single
// corner tells which. If no component lies inside the other solid, the solids have no point in common: the boundary of
// what they share would be a part of both surfaces' components, and lie inside or on the other solid.
#include "collision/containment.h"

#include "collision/inside_test.h"

namespace standoff::collision {
namespace {

// How much of a surface is inside.
struct Share {
  bool some = false, all = false;
};

Share inside_share(const PlacedModel& container, const PlacedModel& content) {
  if (!container.body->field.has_sign()) return {};
  const InsideTest test(container);
  const ModelData& body = *content.body;
  if (test.is_apart(content)) return {};
  Share share{false, true};
  for (const std::uint32_t triangle : body.components) {
    const Vec3 corner = body.mesh.vertices[body.mesh.triangles[triangle][0]];
    const bool inside = test.is_inside(content.moved ? apply(content.pose, corner) : corner);
    share.some |= inside;
    share.all &= inside;
  }
  return share;
}

}  // namespace

void require_closed(const CollisionModel& a, const CollisionModel& b) {
  if (!a.closed() && !b.closed())
    throw Error(ErrorCode::input,
                "collide: neither body is closed and consistently oriented, so nothing can be inside one; repair a "
                "mesh, or leave out containment");
}

Containment containment(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b) {
  const PlacedModel placed_a(data_of(a), pose_a), placed_b(data_of(b), pose_b);
  const Share of_b = inside_share(placed_a, placed_b);
  if (of_b.all) return Containment::b_in_a;
  const Share of_a = inside_share(placed_b, placed_a);
  if (of_a.all) return Containment::a_in_b;
  return of_a.some || of_b.some ? Containment::partly : Containment::none;
}

}  // namespace standoff::collision
