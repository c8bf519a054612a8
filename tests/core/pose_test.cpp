// SPDX-License-Identifier: Apache-2.0
// Poses from an axis and an angle, and what is no pose.
#include "standoff/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "standoff/error.h"
#include "tests/support/expect_error.h"

namespace standoff {
namespace {

// Squares of axes shorter than 1e-162 are zero, of those longer than 1e154 infinite: once the rotation was none.
TEST(Pose, AnAxisMayHaveAnyLength) {
  const Pose expected = make_pose({1, 2, -3}, 0.7, {4, 5, 6});
  validate(expected);
  for (const int exponent : {-1070, -600, -540, -1, 1, 300, 512, 1000}) {
    const auto scaled = [&](double c) { return std::scalbn(c, exponent); };
    const Pose pose = make_pose({scaled(1), scaled(2), scaled(-3)}, 0.7, {4, 5, 6});
    EXPECT_EQ(pose, expected) << exponent;
  }
  const double least = std::numeric_limits<double>::denorm_min(), most = 0x1p1023;
  EXPECT_EQ(make_pose({0, least, 0}, 0.7, {}), make_pose({0, 1, 0}, 0.7, {}));
  EXPECT_EQ(make_pose({most, most, most}, 0.7, {}), make_pose({1, 1, 1}, 0.7, {}));
  // The lesser components need not have squares either.
  EXPECT_EQ(make_pose({1e-300, 1, least}, 0.7, {}).rotation[4], 1);
}

TEST(Pose, AnAxisNeedsADirection) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const Vec3 axis : {Vec3{}, Vec3{-0.0, 0, 0}, Vec3{kInfinity, 0, 0}, Vec3{std::nan(""), 1, 0}})
    expect_error([&] { make_pose(axis, 1, {}); }, ErrorCode::usage, "the axis needs a direction");
  expect_error([] { make_pose({1, 0, 0}, kInfinity, {}); }, ErrorCode::usage, "all numbers must be finite");
}

TEST(Pose, MessagesShowNumbersOfAnySizeInAFewDigits) {
  Pose pose;
  pose.rotation[0] = 1e20;
  expect_error([&] { validate(pose); }, ErrorCode::usage, "right angles by 1e+40; take scaling");
  pose.rotation[0] = 1 + 1e-6;
  expect_error([&] { validate(pose); }, ErrorCode::usage, "right angles by 2e-06; take scaling");
}

}  // namespace
}  // namespace standoff
