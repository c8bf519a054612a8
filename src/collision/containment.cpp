// SPDX-License-Identifier: Apache-2.0
// Decides which points and which bodies are inside a closed body.
//
// Away from the surface, the field decides. Near it, a ray decides, from the point along +x in the world: the winding
// number is the sum of its crossings, each of which is exact (src/sign/rows/ray_crossing.h).
//
// If surfaces do not intersect, a connected component of one lies on one side of the other: a single corner decides
// which. If no component lies inside the other solid, the solids have no point in common: otherwise the boundary of
// their intersection would belong to components of both surfaces, and lie inside or on the other solid.
#include <algorithm>
#include <cmath>

#include "collision/collide.h"
#include "sign/rows/ray_crossing.h"

namespace standoff::collision {
namespace {

// The sample of a grid that is nearest to a point, and their distance.
struct NearestSample {
  std::int64_t i, j, k;
  double off;
};

NearestSample nearest_sample(Vec3 x, Vec3 origin, double spacing, Size3 size) {
  const Vec3 u = (x - origin) * (1 / spacing);
  const auto nearest = [](double at, std::int64_t count) {
    return static_cast<std::int64_t>(std::clamp(at, 0.0, static_cast<double>(count - 1)) + 0.5);
  };
  const NearestSample at{nearest(u.x, size.x), nearest(u.y, size.y), nearest(u.z, size.z), 0};
  const Vec3 position = origin + Vec3{double(at.i), double(at.j), double(at.k)} * spacing;
  return {at.i, at.j, at.k, length(x - position)};
}

std::size_t coarse_sample(const FieldBounds& field, std::int64_t i, std::int64_t j, std::int64_t k) {
  return static_cast<std::size_t>((k * field.coarse_size.y + j) * field.coarse_size.x + i);
}

Side side_of_bit(const HugePageVector<std::uint8_t>& bits, std::size_t n) {
  return (bits[n / 8] >> n % 8 & 1) != 0 ? Side::inside : Side::outside;
}

Side side_of_coarse(const FieldBounds& field, std::int64_t i, std::int64_t j, std::int64_t k) {
  return side_of_bit(field.coarse_inside, coarse_sample(field, i, j, k));
}

// A tile that is not stored is farther from the surface than the band's half-width, and the nearest coarse sample, at
// most two spacings away along each axis, is nearer than that.
static_assert(kCoarseStep * kCoarseStep * 3 < 4 * kBandSamples * kBandSamples);
Side side_of_fine(const FieldBounds& field, std::int32_t i, std::int32_t j, std::int32_t k, std::int32_t slot) {
  constexpr std::int32_t kHalf = kCoarseStep / 2;
  if (slot == 0)
    return side_of_coarse(field, (i + kHalf) / kCoarseStep, (j + kHalf) / kCoarseStep, (k + kHalf) / kCoarseStep);
  const auto tile = static_cast<std::size_t>(slot), within = static_cast<std::size_t>(index_in_tile(i, j, k));
  return side_of_bit(field.inside, DistanceField::kTileSamples * tile + within);
}

}  // namespace

Side side_of(const BodyData& body, Vec3 x, double slack) {
  const FieldBounds& field = body.field;
  const Vec3 out = max(field.box.min - x, x - field.box.max);
  if (std::max({out.x, out.y, out.z}) > slack) return Side::outside;
  const NearestSample coarse = nearest_sample(x, field.origin, kCoarseStep * field.spacing, field.coarse_size);
  if (field.coarse[coarse_sample(field, coarse.i, coarse.j, coarse.k)] > coarse.off + slack)
    return side_of_coarse(field, coarse.i, coarse.j, coarse.k);
  const NearestSample fine = nearest_sample(x, field.origin, field.spacing, field.size);
  const auto i = static_cast<std::int32_t>(fine.i), j = static_cast<std::int32_t>(fine.j),
             k = static_cast<std::int32_t>(fine.k);
  const std::int32_t tile = tile_of(body.view, i, j, k), within = index_in_tile(i, j, k);
  if (fine_sample(body.view, tile, within) * field.thickness() / kClampedSample > fine.off + slack)
    return side_of_fine(field, i, j, k, field.slots[static_cast<std::size_t>(tile)]);
  return Side::unknown;
}

namespace {

static_assert(4 * kSinglePrecisionSlack > (3 * 1.8 + 1) * gamma_float(8));

// A bound of the coordinates in the transform of a body.
double far(const PlacedBody& placed) {
  return max_norm(placed.pose.translation) + max_norm(placed.body->middle) + placed.body->radius;
}

}  // namespace

InsideTest::InsideTest(const PlacedBody& container)
    : container_(container), middle_(apply(container.pose, container.body->middle)) {
  const BodyData& body = *container.body;
  slack_ = kInverseSlack * (body.radius + body.field.thickness()) + kDoublePrecisionSlack * far(container);
  // The spheres hold corners that were rounded to single precision, and placing them takes 8 operations in it, on
  // numbers no larger than three radii.
  sphere_slack_ = 4 * kSinglePrecisionSlack * body.radius + kDoublePrecisionSlack * far(container);
}

bool InsideTest::is_apart(const PlacedBody& other) const {
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
  const BodyData& body = *container_.body;
  const Sphere16& spheres = body.bvh.spheres[static_cast<std::size_t>(level)][packet];
  // The pose maps a sphere into one that is hardly larger, around the image of its centre. The radius of an empty
  // sphere is minus infinity, so no point reaches it. The loop has no branches, so that compilers vectorise it.
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

namespace {

// The share of a surface that is inside.
struct Share {
  bool some = false, all = false;
};

Share inside_share(const PlacedBody& container, const PlacedBody& content) {
  if (!container.body->field.has_sign()) return {};
  const InsideTest test(container);
  const BodyData& body = *content.body;
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

void require_closed(const Body& a, const Body& b) {
  if (!a.has_inside() && !b.has_inside())
    throw Error(ErrorCode::input,
                "collide: neither body is closed and consistently oriented, so nothing can be inside one; repair a "
                "mesh, or leave out containment");
}

Containment containment(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b) {
  const PlacedBody placed_a(data_of(a), pose_a), placed_b(data_of(b), pose_b);
  const Share of_b = inside_share(placed_a, placed_b);
  if (of_b.all) return Containment::b_in_a;
  const Share of_a = inside_share(placed_b, placed_a);
  if (of_a.all) return Containment::a_in_b;
  return of_a.some || of_b.some ? Containment::partly : Containment::none;
}

}  // namespace standoff::collision
