#include "collision/pair.h"

#include <cmath>

namespace standoff::collision {
namespace {

// How far a pose's matrix is from a rotation, as validate() measures it.
double rigid_error(const Pose& pose) {
  const auto& r = pose.rotation;
  const Vec3 rows[3] = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}};
  double off = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) off = std::max(off, std::abs(dot(rows[i], rows[j]) - (i == j ? 1 : 0)));
  return off;
}

// Distances in a frame that is off by less are off by less than 1e-14 of coordinates, for which the slack has room.
constexpr double kRigid = 4e-15;

// The pose with a rotation to rounding, by making its rows perpendicular to one another.
Pose orthonormal(Pose pose) {
  auto& r = pose.rotation;
  const Vec3 first{r[0], r[1], r[2]}, second{r[3], r[4], r[5]};
  const Vec3 x = first * (1 / length(first)), across = second - x * dot(x, second);
  const Vec3 y = across * (1 / length(across)), z = cross(x, y);
  r = {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
  return pose;
}

double magnitude(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

double size_of(const CollisionModel& model) {
  const Vec3 e = data_of(model).box.extent();
  return std::max({e.x, e.y, e.z});
}

}  // namespace

Pair::Pair(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b)
    : field(data_of(a), pose_a), tree(data_of(b), pose_b), swapped(size_of(b) > size_of(a)) {
  if (swapped) std::swap(field, tree);
  // relative = frame^-1 (tree's pose), between coordinates relative to where the middles are in the world.
  const Pose &f = field.pose, &t = tree.pose;
  const double off = rigid_error(f);
  frame = off > kRigid ? orthonormal(f) : f;
  for (int column = 0; column < 3; ++column) {
    const auto& r = t.rotation;
    const Vec3 turned = rotate_back(frame, {r[column], r[3 + column], r[6 + column]});
    relative.rotation[column] = turned.x, relative.rotation[3 + column] = turned.y,
    relative.rotation[6 + column] = turned.z;
  }
  const Vec3 world_middle = apply(t, tree.body->middle) - apply(f, field.body->middle);
  relative.translation = rotate_back(frame, world_middle);
  const Vec3 d = relative.translation;
  for (int n = 0; n < 9; ++n) place.rotation[n] = static_cast<float>(relative.rotation[n]);
  place.translation[0] = static_cast<float>(d.x);
  place.translation[1] = static_cast<float>(d.y);
  place.translation[2] = static_cast<float>(d.z);
  // What is lost: single precision in placing a ball (four roundings of numbers no larger than `reach`), in looking up
  // and subtracting (about ten more), the middles' own rounding; a matrix that is a rotation only nearly; and double
  // rounding of coordinates far from the world's origin. A unit of single precision is 6e-8.
  const double reach = field.body->radius + 2 * tree.body->radius + field.body->field.band();
  far = magnitude(f.translation) + magnitude(t.translation) + magnitude(field.body->middle) +
        magnitude(tree.body->middle) + field.body->radius + tree.body->radius;
  slack = static_cast<float>((2e-6 + 4 * (off + rigid_error(t))) * reach + 1e-14 * far);
}

double Pair::root_gap() const {
  const Vec3 d = relative.translation;
  const Box& box = field.body->field.box;
  const Vec3 out = max(max(box.min - d, d - box.max), Vec3{0, 0, 0});
  return length(out) - tree.body->radius;
}

FloatBox Pair::region(float by) const {
  const Vec3 half = tree.body->box.extent() * 0.5, offset = tree.body->box.center() - tree.body->middle;
  const Vec3 center = apply(relative, offset);
  const double at[3] = {center.x, center.y, center.z};
  FloatBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const double* r = &relative.rotation[3 * axis];
    const double reach = std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z;
    // Beyond `by`, what it holds may be placed off by the slack.
    box.min[axis] = static_cast<float>(at[axis] - reach) - by - slack;
    box.max[axis] = static_cast<float>(at[axis] + reach) + by + slack;
  }
  return box;
}

FloatBox Pair::box_of(std::uint32_t place_in_tree) const {
  FloatBox box;
  for (const Vec3& corner : tree.body->corners[place_in_tree]) {
    const Vec3 p = apply(relative, corner - tree.body->middle);
    const float at[3] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    box.include(at);
  }
  return box;
}

}  // namespace standoff::collision
