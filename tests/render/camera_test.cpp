// SPDX-License-Identifier: Apache-2.0
// Where things fall on pictures, at any size a double can hold.
#include "render/camera.h"

#include <gtest/gtest.h>

#include <random>

namespace standoff {
namespace {

PictureOptions from(double azimuth, double elevation, Axis up = Axis::z, bool perspective = true) {
  return {.azimuth_deg = azimuth, .elevation_deg = elevation, .perspective = perspective, .up = up};
}

float apart(Float3 a, Float3 b) { return length(a - b); }

// From the front, with the given axis up: the picture's right and up in the world.
TEST(Camera, LooksAtTheFront) {
  struct Case {
    Axis up;
    Float3 right, upwards;
  };
  for (const Case& test : {Case{Axis::z, {1, 0, 0}, {0, 0, 1}}, Case{Axis::y, {1, 0, 0}, {0, 1, 0}},
                           Case{Axis::x, {0, 1, 0}, {1, 0, 0}}}) {
    const Camera camera(from(0, 0, test.up));
    EXPECT_LT(apart(camera.turned(test.right), {1, 0, 0}), 1e-6F);
    EXPECT_LT(apart(camera.turned(test.upwards), {0, 1, 0}), 1e-6F);
  }
}

// What points at the eye has a positive third number.
TEST(Camera, TurnsWithAzimuthAndElevation) {
  EXPECT_NEAR(Camera(from(90, 0)).turned({1, 0, 0}).z, 1, 1e-6);
  EXPECT_NEAR(Camera(from(-90, 0)).turned({-1, 0, 0}).z, 1, 1e-6);
  EXPECT_NEAR(Camera(from(180, 0)).turned({0, 1, 0}).z, 1, 1e-6);
  EXPECT_NEAR(Camera(from(0, 90)).turned({0, 0, 1}).z, 1, 1e-6);
}

// Its sines are its own.
TEST(Camera, TurnsByExactlyTheAngle) {
  for (double turn = -400; turn <= 400; turn += 7.3) {
    const Float3 right = Camera(from(turn, 0)).turned_back({1, 0, 0});
    EXPECT_NEAR(right.x, std::cos(turn * 3.14159265358979323846 / 180), 1e-7) << turn;
    EXPECT_NEAR(right.y, std::sin(turn * 3.14159265358979323846 / 180), 1e-7) << turn;
  }
  // So that parallel edges stay parallel to the pixels.
  EXPECT_EQ(Camera(from(90, 0)).turned_back({1, 0, 0}).x, 0);
}

TEST(Camera, NearerIsDeeper) {
  for (const bool perspective : {false, true}) {
    const Camera camera(from(0, 0, Axis::z, perspective));
    const Camera::Seen near = camera.seen({-0.5F, -0.5F, 0}), far = camera.seen({-0.5F, 0.5F, 0});
    EXPECT_GT(near.depth, far.depth);
    EXPECT_GT(far.depth, 0);
    // In perspective what is near is drawn larger.
    if (perspective) {
      EXPECT_LT(near.u, far.u);
    } else {
      EXPECT_EQ(near.u, far.u);
    }
  }
}

// Everything that is fitted is in the room, and touches it on two sides.
TEST(Camera, FillsTheRoom) {
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<float>(random() % 2001) / 1000 - 1; };
  for (int round = 0; round < 200; ++round) {
    const Camera camera(from(number() * 360, number() * 90, static_cast<Axis>(round % 3), round % 2 == 0));
    std::vector<Camera::Seen> seen;
    double least_u = 1e9, least_v = 1e9, most_u = -1e9, most_v = -1e9;
    for (int n = 0; n < 20; ++n) {
      seen.push_back(camera.seen(unit_or({number(), number(), number()}, {1, 0, 0}) * std::abs(number())));
      least_u = std::min<double>(least_u, seen.back().u);
      most_u = std::max<double>(most_u, seen.back().u);
      least_v = std::min<double>(least_v, seen.back().v);
      most_v = std::max<double>(most_v, seen.back().v);
    }
    const Framing framing(least_u, least_v, most_u, most_v, {10, 5, 80, 50}, 1);
    std::int32_t left = 1 << 30, right = 0, top = 1 << 30, bottom = 0;
    for (const Camera::Seen& s : seen) {
      const ScreenPoint p = framing.on_picture(s);
      left = std::min(left, p.x), right = std::max(right, p.x);
      top = std::min(top, p.y), bottom = std::max(bottom, p.y);
    }
    EXPECT_GE(left, 10 * kSubpixels - 1);
    EXPECT_LE(right, 90 * kSubpixels + 1);
    EXPECT_GE(top, 5 * kSubpixels - 1);
    EXPECT_LE(bottom, 55 * kSubpixels + 1);
    EXPECT_TRUE((left <= 10 * kSubpixels + 1 && right >= 90 * kSubpixels - 1) ||
                (top <= 5 * kSubpixels + 1 && bottom >= 55 * kSubpixels - 1));
  }
}

// Squares of the extent overflow past 2^512 and vanish below 2^-512, and a sum of bounds past 2^1023. A power of two
// changes no other bit.
TEST(UnitSpace, ThingsOfAnySizeAreTheSame) {
  const Box box{{-1, -3, 0.5}, {2, 1, 0.75}};
  const Vec3 point{0.3, -2.2, 0.6};
  const Float3 expected = UnitSpace(box).placed(point);
  EXPECT_LE(length(expected), 1);
  for (const int power : {-900, -520, 520, 900, 1021}) {
    const double s = std::ldexp(1.0, power);
    const UnitSpace space({box.min * s, box.max * s});
    EXPECT_EQ(space.placed(point * s).x, expected.x) << power;
    EXPECT_EQ(space.placed(point * s).y, expected.y) << power;
    EXPECT_EQ(space.placed(point * s).z, expected.z) << power;
    EXPECT_LT(length(space.world(expected) / Vec3{s, s, s} - point), 1e-6) << power;
  }
  constexpr double kMost = std::numeric_limits<double>::max();
  EXPECT_LE(length(UnitSpace({Vec3{-1, -1, -1} * kMost, Vec3{1, 1, 1} * kMost}).placed(Vec3{1, 1, 1} * kMost)), 1.001F);
  EXPECT_EQ(length(UnitSpace({{2, 3, 4}, {2, 3, 4}}).placed({2, 3, 4})), 0);
}

}  // namespace
}  // namespace standoff
