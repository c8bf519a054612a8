// SPDX-License-Identifier: Apache-2.0
// The field decides away from the surface. Near it a ray does, from the point along +x in the world: the winding number
// is the sum of its crossings, each of them exact (src/sign/rows/ray_crossing.h).
#include "collision/inside_test.h"

#include <algorithm>
#include <cmath>

#include "collision/body/field_side.h"
#include "sign/rows/ray_crossing.h"

namespace standoff::collision {
namespace {

static_assert(4 * kSinglePrecisionSlack > (3 * 1.8 + 1) * gamma_float(8));

// A bound of the coordinates that placing a body goes through.
double far(const PlacedModel& placed) {
  return max_norm(placed.pose.translation) + max_norm(placed.body->middle) + placed.body->radius;
}

}  // namespace

InsideTest::InsideTest(const PlacedModel& container)
    : container_(container), middle_(apply(container.pose, container.body->middle)) {
  const ModelData& body = *container.body;
  slack_ = kInverseSlack * (body.radius + body.field.thickness()) + kDoublePrecisionSlack * far(container);
  // The spheres hold corners that were rounded to single precision, and are placed in it: 8 operations on numbers no
  // larger than three radii.
  sphere_slack_ = 4 * kSinglePrecisionSlack * body.radius + kDoublePrecisionSlack * far(container);
}

bool InsideTest::is_apart(const PlacedModel& other) const {
  const Vec3 x = in_body(apply(other.pose, other.body->middle));
  const Box& box = container_.body->field.box;
  const Vec3 out = max(max(box.min - x, x - box.max), Vec3{0, 0, 0});
  return length(out) > (1 + kInverseSlack) * other.body->radius + slack_ + kDoublePrecisionSlack * far(other);
}

bool InsideTest::is_inside(Vec3 point) const {
  const Side side = side_of(*container_.body, in_body(point), slack_);
  return side == Side::unknown ? is_inside_by_ray(point) : side == Side::inside;
}

int InsideTest::winding(Vec3 point, int level, std::uint32_t packet) const {
  const ModelData& body = *container_.body;
  const Sphere16& spheres = body.bvh.levels[static_cast<std::size_t>(level)].spheres[packet];
  // The pose maps a sphere into one that is hardly larger, around the image of its centre. Nothing reaches an empty
  // one: its radius is minus infinity. Without branches, so that compilers take several lanes at a time.
  float r[9];
  std::ranges::transform(container_.pose.rotation, r, [](double entry) { return static_cast<float>(entry); });
  const Vec3 offset = middle_ - point;
  const auto dx = static_cast<float>(offset.x), dy = static_cast<float>(offset.y), dz = static_cast<float>(offset.z);
  const auto round_up = static_cast<float>(kRigidRoundUp), slack = static_cast<float>(sphere_slack_);
  std::uint32_t reached[kLanes];
  for (int n = 0; n < kLanes; ++n) {
    const float cx = spheres.center[0][n], cy = spheres.center[1][n], cz = spheres.center[2][n];
    const float x = r[0] * cx + r[1] * cy + r[2] * cz + dx, y = r[3] * cx + r[4] * cy + r[5] * cz + dy,
                z = r[6] * cx + r[7] * cy + r[8] * cz + dz;
    const float reach = round_up * spheres.radius[n] + slack;
    reached[n] = std::uint32_t{x > -reach} & std::uint32_t{y * y + z * z < reach * reach};
  }
  int sum = 0;
  for (int n = 0; n < kLanes; ++n) {
    if (reached[n] == 0) continue;
    const std::uint32_t child = packet * kLanes + static_cast<std::uint32_t>(n);
    if (level > 0) {
      sum += winding(point, level - 1, child);
      continue;
    }
    const RayTriangle triangle(container_.world(child));
    const int crossing = triangle.crossing(point.y, point.z);
    if (crossing != 0 && !triangle.is_past(point, crossing)) sum += crossing;
  }
  return sum;
}

}  // namespace standoff::collision
