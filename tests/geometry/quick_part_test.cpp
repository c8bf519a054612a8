// SPDX-License-Identifier: Apache-2.0
// The closest point by regions, and that of points over the inside of a triangle, against the one by comparison of all
// edges and the face.
#include "geometry/closest_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace standoff {
namespace {

using CornerPoints = std::array<Triple<double>, 3>;

struct Found {
  bool sound;
  QuickPart<double, bool> quick;
  ClosestPart<double> exact;
};
Found look_at(const CornerPoints& c) {
  Found found;
  found.quick = quick_part(quick_triangle(c[0], c[1], c[2]), Triple<double>{} - c[0]);
  found.sound = found.quick.is_sound;
  found.exact = closest_part(c[0], c[1], c[2]);
  return found;
}

double farthest(const CornerPoints& c) {
  double most = 0;
  for (const Triple<double>& v : c) most = std::max(most, std::sqrt(dot(v, v)));
  return most;
}

// In units of the farthest corner's distance. What closest_part() gives is the nearest of points whose distances hardly
// differ: only the distance is compared for those on the border of a feature.
void expect_same(const CornerPoints& c, const Found& found) {
  const double extent = farthest(c);
  EXPECT_NEAR(std::sqrt(found.quick.distance_sq), std::sqrt(found.exact.distance_sq), 1e-12 * extent);
  const Triple<double> w = weights_of(found.quick);
  const double sum = w.x + w.y + w.z;
  EXPECT_NEAR(sum, 1, 1e-12);
  const Triple<double> made = c[0] * w.x + c[1] * w.y + c[2] * w.z, off = made - found.quick.point;
  EXPECT_LE(std::sqrt(dot(off, off)), 1e-12 * extent);
  for (const double share : {w.x, w.y, w.z}) {
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 1);
    if (share != 0 && share < 1e-6) return;
  }
  EXPECT_EQ(feature_of(found.quick), found.exact.feature);
  const Triple<double> between = found.quick.point - found.exact.point;
  EXPECT_LE(std::sqrt(dot(between, between)), 1e-7 * extent);
}

TEST(QuickPart, AsTheClosestOfAllParts) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::array<int, 7> features{};
  int sound = 0;
  constexpr int kCases = 100000;
  for (int n = 0; n < kCases; ++n) {
    const double size = std::exp2(6 * unit(random) - 2), flat = n % 3 == 0 ? std::exp2(10 * unit(random) - 10) : 1;
    const Triple<double> at{2 * unit(random), 2 * unit(random), 2 * unit(random)};
    CornerPoints c;
    for (Triple<double>& v : c)
      v = at + Triple<double>{size * unit(random), size * unit(random), flat * size * unit(random)};
    const Found found = look_at(c);
    if (!found.sound) continue;
    ++sound;
    ++features[static_cast<std::size_t>(feature_of(found.quick))];
    expect_same(c, found);
  }
  EXPECT_GT(sound, kCases * 9 / 10);
  for (const int count : features) EXPECT_GT(count, kCases / 100);
}

using Corner = Triple<double>;
bool is_sound(const Corner& a, const Corner& b, const Corner& c) { return look_at({a, b, c}).sound; }

TEST(QuickPart, SaysWhereItIsNotSound) {
  const Triple<double> a{1, 0, 0.5}, b{-1, 1, 0.5}, c{-1, -1, 0.5};
  EXPECT_TRUE(is_sound(a, b, c));
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_sound(a, b, b)) << "a segment";
  EXPECT_FALSE(is_sound(a, a, a)) << "a point";
  EXPECT_FALSE(is_sound(a, b, (a + b) * 0.5 + Triple<double>{0, 1e-5, 0})) << "a needle";
  const Corner away{9e3, 0, 0};
  EXPECT_FALSE(is_sound(a + away, b + away, c + away)) << "far away";
  const Triple<double> down{0, 0, -0.5}, little{0, 0, 1e-8};
  EXPECT_FALSE(is_sound(a + down, b + down, c + down)) << "on the face";
  EXPECT_FALSE(is_sound(a + down + little, b + down + little, c + down + little)) << "near the face";
  EXPECT_FALSE(is_sound({0, 0, 0.5}, b, c)) << "on a border";
  for (const double wild : {inf, -inf, nan, 1e200, -1e60}) {
    EXPECT_FALSE(is_sound({wild, 0, 0.5}, b, c));
    EXPECT_FALSE(is_sound(a, {-1, wild, 0.5}, c));
    EXPECT_FALSE(is_sound(a, b, {-1, -1, wild}));
  }
  EXPECT_FALSE(is_sound(a * 1e-60, b * 1e-60, c * 1e-60)) << "tiny";
}

QuickFaceAt<double, bool> face_at_origin(const CornerPoints& c) {
  const QuickFace<double> face = quick_face(c[0], c[1], c[2], 1.5 * dot(c[0], c[0]));
  return quick_face_at(face, Triple<double>{} - c[0]);
}

TEST(QuickFace, AsTheClosestOfAllParts) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  int inside = 0, faces = 0;
  for (int n = 0; n < 100000; ++n) {
    const double size = std::exp2(6 * unit(random) - 2), flat = n % 3 == 0 ? std::exp2(10 * unit(random) - 10) : 1;
    const Triple<double> at{unit(random), unit(random), unit(random)};
    CornerPoints c;
    for (Triple<double>& v : c)
      v = at + Triple<double>{size * unit(random), size * unit(random), flat * size * unit(random)};
    const ClosestPart<double> exact = closest_part(c[0], c[1], c[2]);
    const auto found = face_at_origin(c);
    faces += exact.feature == 0;
    // On the border of a feature both may be right.
    const double least = std::min(exact.weights.x, std::min(exact.weights.y, exact.weights.z));
    if (!found.is_inside || (exact.feature == 0 && least < 1e-6)) continue;
    ++inside;
    EXPECT_EQ(exact.feature, 0);
    const double extent = farthest(c);
    EXPECT_NEAR(std::abs(found.height), std::sqrt(exact.distance_sq), 1e-12 * extent);
    EXPECT_NEAR(found.v, exact.weights.y, 1e-9);
    EXPECT_NEAR(found.w, exact.weights.z, 1e-9);
    const Triple<double> normal = quick_face(c[0], c[1], c[2], dot(c[0], c[0])).normal,
                         off = normal * -found.height - exact.point;
    EXPECT_LE(std::sqrt(dot(off, off)), 1e-12 * extent);
  }
  EXPECT_GT(inside, faces * 9 / 10);
  EXPECT_GT(faces, 5000);
}

TEST(QuickFace, SaysWhereItIsNotSound) {
  const Triple<double> a{1, 0, 0.5}, b{-1, 1, 0.5}, c{-1, -1, 0.5};
  EXPECT_TRUE(face_at_origin({a, b, c}).is_inside);
  const Triple<double> down{0, 0, -0.5}, little{0, 0, 1e-8}, aside{1.1, 0, 0};
  EXPECT_FALSE(face_at_origin({a + aside, b + aside, c + aside}).is_inside) << "over an edge";
  EXPECT_FALSE(face_at_origin({a - aside - aside, b - aside - aside, c - aside - aside}).is_inside) << "over a corner";
  EXPECT_FALSE(face_at_origin({a + down, b + down, c + down}).is_inside) << "on the face";
  EXPECT_FALSE(face_at_origin({a + down + little, b + down + little, c + down + little}).is_inside) << "near the face";
  EXPECT_FALSE(face_at_origin({a, b, b}).is_inside) << "a segment";
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wild : {inf, -inf, nan, 1e200, -1e60}) {
    EXPECT_FALSE(face_at_origin({{{wild, 0, 0.5}, b, c}}).is_inside);
    EXPECT_FALSE(face_at_origin({{a, {-1, wild, 0.5}, c}}).is_inside);
    EXPECT_FALSE(face_at_origin({{a, b, {-1, -1, wild}}}).is_inside);
  }
}

}  // namespace
}  // namespace standoff
