// SPDX-License-Identifier: Apache-2.0
#include "standoff/pose.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/guarded.h"
#include "core/number_text.h"
#include "standoff/error.h"

namespace standoff {

Pose compose(const Pose& outer, const Pose& inner) {
  Pose result;
  for (int column = 0; column < 3; ++column) {
    const auto& r = inner.rotation;
    const Vec3 turned = rotate(outer, {r[column], r[3 + column], r[6 + column]});
    result.rotation[column] = turned.x, result.rotation[3 + column] = turned.y, result.rotation[6 + column] = turned.z;
  }
  result.translation = apply(outer, inner.translation);
  return result;
}

Pose make_pose(Vec3 axis, double angle_rad, Vec3 translation) try {
  const double largest = max_norm(axis);
  if (!(largest > 0) || !is_finite(axis) || !std::isfinite(angle_rad) || !is_finite(translation))
    throw Error(
        ErrorCode::usage,
        "pose: the axis needs a direction, and all numbers must be finite; give an axis of any length but zero");
  // A power of two changes no digit of the direction, and keeps the squares of the smallest and largest within range.
  const int exponent = -std::ilogb(largest);
  const Vec3 scaled{std::scalbn(axis.x, exponent), std::scalbn(axis.y, exponent), std::scalbn(axis.z, exponent)};
  const Vec3 u = scaled * (1 / length(scaled));
  const double c = std::cos(angle_rad), s = std::sin(angle_rad), k = 1 - c;
  Pose pose;
  pose.rotation = {c + u.x * u.x * k,       u.x * u.y * k - u.z * s, u.x * u.z * k + u.y * s,
                   u.y * u.x * k + u.z * s, c + u.y * u.y * k,       u.y * u.z * k - u.x * s,
                   u.z * u.x * k - u.y * s, u.z * u.y * k + u.x * s, c + u.z * u.z * k};
  pose.translation = translation;
  return pose;
} catch (...) {
  throw_as_error("pose");
}

void validate(const Pose& pose) try {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, "pose: " + what); };
  for (const double r : pose.rotation)
    if (!std::isfinite(r)) fail("the rotation holds a number that is not finite; give nine finite numbers");
  const Vec3 t = pose.translation;
  if (!is_finite(t) || max_norm(t) > kMaxPosition)
    fail("the translation is not finite or past " + number_text(kMaxPosition) +
         "; give three finite numbers, or another unit of length");
  const auto& r = pose.rotation;
  const Vec3 rows[3] = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}};
  double off = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) off = std::max(off, std::abs(dot(rows[i], rows[j]) - (i == j ? 1 : 0)));
  if (!(off <= kRigidTolerance))
    fail("the matrix is no rotation: its rows are off unit length and right angles by " + number_text(off) +
         "; take scaling and shear out of it");
  if (!(dot(cross(rows[0], rows[1]), rows[2]) > 0)) fail("the matrix mirrors; a rigid body cannot, negate one axis");
} catch (...) {
  throw_as_error("pose");
}

}  // namespace standoff
