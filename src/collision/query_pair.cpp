// SPDX-License-Identifier: Apache-2.0
// Places the two bodies of a query in one frame, and bounds the rounding errors there.
#include "collision/query_pair.h"

#include <cmath>

namespace standoff::collision {
namespace {

// The error of a pose's matrix as a rotation, as validate() measures it.
double rigid_error(const Pose& pose) {
  const auto& r = pose.rotation;
  const Vec3 rows[3] = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}};
  double off = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) off = std::max(off, std::abs(dot(rows[i], rows[j]) - (i == j ? 1 : 0)));
  return off;
}

}  // namespace

Pose orthonormal(Pose pose) {
  if (!(rigid_error(pose) > kOrthonormal)) return pose;
  auto& r = pose.rotation;
  const Vec3 first{r[0], r[1], r[2]}, second{r[3], r[4], r[5]};
  const Vec3 x = first * (1 / length(first)), across = second - x * dot(x, second);
  const Vec3 y = across * (1 / length(across)), z = cross(x, y);
  r = {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
  return pose;
}

Pose relative_pose(const Pose& frame, const Vec3& origin, const Pose& pose, const Vec3& middle) {
  Pose relative;
  for (int column = 0; column < 3; ++column) {
    const auto& r = pose.rotation;
    const Vec3 rotated = rotate_back(frame, {r[column], r[3 + column], r[6 + column]});
    relative.rotation[column] = rotated.x, relative.rotation[3 + column] = rotated.y,
    relative.rotation[6 + column] = rotated.z;
  }
  relative.translation = rotate_back(frame, apply(pose, middle) - origin);
  return relative;
}

QueryPair::QueryPair(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, const Kernels& with_kernels)
    : target(data_of(a), pose_a),
      probe(data_of(b), pose_b),
      swapped(probe.body->box.longest_side() > target.body->box.longest_side()),
      kernels(with_kernels) {
  if (swapped) std::swap(target, probe);
  // relative = frame^-1 (the probe's pose), for coordinates relative to the middles.
  const Pose &f = target.pose, &t = probe.pose;
  const double off = rigid_error(f);
  frame = orthonormal(f);
  relative = relative_pose(frame, apply(f, target.body->middle), t, probe.body->middle);
  const Vec3 d = relative.translation;
  for (int n = 0; n < 9; ++n) transform.rotation[n] = static_cast<float>(relative.rotation[n]);
  transform.translation[0] = static_cast<float>(d.x);
  transform.translation[1] = static_cast<float>(d.y);
  transform.translation[2] = static_cast<float>(d.z);
  // The slack covers three errors. In single precision: transforming a sphere (four roundings of numbers no larger than
  // `reach`), sampling and subtracting (about ten more), and the rounding of the middles. Matrices that are only nearly
  // rotations. In double precision: coordinates far from the world's origin.
  const double reach = target.body->radius + 2 * probe.body->radius + target.body->field.thickness();
  far = max_norm(f.translation) + max_norm(t.translation) + max_norm(target.body->middle) +
        max_norm(probe.body->middle) + target.body->radius + probe.body->radius;
  pose_slack = 4 * (off + rigid_error(t)) * reach + kDoublePrecisionSlack * far;
  slack = static_cast<float>(kSinglePrecisionSlack * reach + pose_slack);
}

double QueryPair::root_gap() const {
  const Vec3 d = relative.translation;
  const Box& box = target.body->field.box;
  const Vec3 out = max(max(box.min - d, d - box.max), Vec3{0, 0, 0});
  return length(out) - probe.body->radius;
}

// Axes in single precision are off by 2 roundings, along a vector between two corners and in its projections 6 in all:
// of the radii `slack` covers 14 twice (kSinglePrecisionSlack), of the gap kRoundDown does.
bool QueryPair::boxes_apart(double by) const {
  const auto root_of = [](const PlacedBody& placed) { return placed.body->bvh.box_of(placed.body->bvh.top(), 0); };
  const auto vec = [](const float* v) { return Vec3{v[0], v[1], v[2]}; };
  const Obb resting = root_of(target), moved = root_of(probe);
  const Vec3 offset = apply(relative, vec(moved.center)) - vec(resting.center);
  const Vec3 axis[3] = {vec(resting.axis[0]), vec(resting.axis[1]), vec(resting.axis[2])};
  double cosine[3][3];  // of the angles between the axes, their magnitudes
  double gap = 0;       // the largest, before rounding
  for (int j = 0; j < 3; ++j) {
    const Vec3 along = rotate(relative, vec(moved.axis[j]));
    double reach = moved.half[j];
    for (int k = 0; k < 3; ++k) reach += resting.half[k] * (cosine[k][j] = std::abs(dot(along, axis[k])));
    gap = std::max(gap, std::abs(dot(along, offset)) - reach);
  }
  for (int k = 0; k < 3; ++k) {
    double reach = resting.half[k];
    for (int j = 0; j < 3; ++j) reach += moved.half[j] * cosine[k][j];
    gap = std::max(gap, std::abs(dot(axis[k], offset)) - reach);
  }
  return gap * kRoundDown > by;
}

FloatBox QueryPair::region(float by) const {
  const Vec3 half = probe.body->box.extent() * 0.5, offset = probe.body->box.center() - probe.body->middle;
  const Vec3 center = apply(relative, offset);
  const double at[3] = {center.x, center.y, center.z};
  FloatBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const double* r = &relative.rotation[3 * axis];
    const double reach = std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z;
    // The slack covers the error of the placement.
    box.low[axis] = static_cast<float>(at[axis] - reach) - by - slack;
    box.high[axis] = static_cast<float>(at[axis] + reach) + by + slack;
  }
  return box;
}

}  // namespace standoff::collision
