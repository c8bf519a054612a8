// SPDX-License-Identifier: Apache-2.0
// Where meshes fall on pictures, at any size a double can hold.
#include "render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "render/mesh_picture.h"
#include "standoff/error.h"

namespace standoff {
namespace {

PictureOptions small_picture(double azimuth = 35, double elevation = 25) {
  PictureOptions options;
  options.width = 96;
  options.height = 64;
  options.azimuth_deg = azimuth;
  options.elevation_deg = elevation;
  return options;
}

// A box's corners, with triangles enough to use them all.
Mesh corners_of(Vec3 low, Vec3 high) {
  Mesh mesh;
  for (const double z : {low.z, high.z})
    for (const double y : {low.y, high.y})
      for (const double x : {low.x, high.x}) mesh.vertices.push_back({x, y, z});
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {4, 5, 6}, {5, 7, 6}, {0, 4, 1}, {2, 3, 6}};
  return mesh;
}

Mesh random_triangles(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
  Mesh mesh;
  for (std::uint32_t t = 0; t < 20; ++t) {
    for (int corner = 0; corner < 3; ++corner) mesh.vertices.push_back({number(), 3 * number(), 0.5 * number()});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

Mesh scaled(Mesh mesh, double scale) {
  for (Vec3& v : mesh.vertices) v = v * scale;
  return mesh;
}

// From the front, with the given axis up: the picture's right and up in the world.
TEST(Camera, LooksAtTheFront) {
  struct Case {
    Axis up;
    Vec3 right, upwards;
  };
  for (const Case& test : {Case{Axis::z, {1, 0, 0}, {0, 0, 1}}, Case{Axis::y, {1, 0, 0}, {0, 1, 0}},
                           Case{Axis::x, {0, 1, 0}, {1, 0, 0}}}) {
    PictureOptions options = small_picture(0, 0);
    options.up = test.up;
    options.perspective = false;
    const Camera camera(Box{{-1, -1, -1}, {1, 1, 1}}, options);
    EXPECT_LT(length(camera.turned(test.right) - Vec3{1, 0, 0}), 1e-15);
    EXPECT_LT(length(camera.turned(test.upwards) - Vec3{0, 1, 0}), 1e-15);
  }
}

TEST(Camera, TurnsWithAzimuthAndElevation) {
  // From the right side, and from above: what points at the eye has a positive third number.
  EXPECT_NEAR(Camera(Box{{-1, -1, -1}, {1, 1, 1}}, small_picture(90, 0)).turned({1, 0, 0}).z, 1, 1e-15);
  EXPECT_NEAR(Camera(Box{{-1, -1, -1}, {1, 1, 1}}, small_picture(0, 90)).turned({0, 0, 1}).z, 1, 1e-15);
}

// All of the mesh is in the picture, and touches the margin on two sides.
TEST(Camera, FillsThePicture) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    const Mesh mesh = random_triangles(seed);
    PictureOptions options = small_picture(12.0 * seed, 6.0 * seed - 90);
    options.perspective = seed % 2 == 0;
    options.up = static_cast<Axis>(seed % 3);
    const auto points = Camera(bounds(mesh), options).project(mesh, options.width, options.height);
    const auto [left, right] = std::ranges::minmax(points, {}, &ScreenPoint::x);
    const auto [top, bottom] = std::ranges::minmax(points, {}, &ScreenPoint::y);
    const double margin = 0.04 * 64 * kSubpixels;
    EXPECT_GE(std::min(left.x, top.y), margin - 1);
    EXPECT_LE(right.x, 96 * kSubpixels - margin + 1);
    EXPECT_LE(bottom.y, 64 * kSubpixels - margin + 1);
    EXPECT_TRUE(left.x <= margin + 1 || top.y <= margin + 1);
  }
}

TEST(Camera, NearerIsDeeper) {
  const Mesh mesh = corners_of({-1, -1, -1}, {1, 1, 1});
  for (const bool perspective : {false, true}) {
    PictureOptions options = small_picture(0, 0);
    options.perspective = perspective;
    const auto points = Camera(bounds(mesh), options).project(mesh, 96, 64);
    // Corner 0 is at the front (y = -1), corner 2 behind it.
    EXPECT_GT(points[0].depth, points[2].depth);
    // In perspective what is near is drawn larger.
    if (perspective) {
      EXPECT_LT(points[0].x, points[2].x);
    } else {
      EXPECT_EQ(points[0].x, points[2].x);
    }
  }
}

TEST(Camera, NormalsFaceTheEye) {
  const Camera camera(Box{{-1, -1, -1}, {1, 1, 1}}, small_picture());
  const Mesh mesh = random_triangles(4);
  const MeshView view = mesh;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = view.corner(t, 0), b = view.corner(t, 1), c = view.corner(t, 2);
    const Vec3 normal = camera.facing_normal(a, b, c);
    EXPECT_NEAR(length(normal), 1, 1e-12);
    EXPECT_NEAR(dot(normal, camera.turned(b - a)), 0, 1e-12);
    EXPECT_NEAR(dot(normal, camera.turned(c - a)), 0, 1e-12);
    const Vec3 other = camera.facing_normal(a, c, b);
    EXPECT_LT(length(normal - other), 1e-12);
  }
  EXPECT_EQ(camera.facing_normal({0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5}), (Vec3{0, 0, 1}));
}

// Squares of the extent overflowed past 2^512 and vanished below 2^-512, and a sum of bounds past 2^1023: such meshes
// were refused, or drawn as a point. A power of two changes no other bit, so the pictures must be the same.
TEST(Camera, MeshesOfAnySizeLookAlike) {
  const Mesh mesh = random_triangles(9);
  const Image expected = draw_mesh(mesh, small_picture());
  const auto drawn = [](const Image& image) {
    return std::ranges::count_if(image.pixels, [&](Color c) { return c != image.at(0, 0); });
  };
  ASSERT_GT(drawn(expected), 500);
  for (const int power : {-900, -520, 520, 900, 1021}) {
    const Image image = draw_mesh(scaled(mesh, std::ldexp(1.0, power)), small_picture());
    EXPECT_EQ(image.pixels, expected.pixels) << "2^" << power;
  }
}

TEST(Camera, MeshesAtTheEndsOfDoubleAreDrawn) {
  constexpr double kMost = std::numeric_limits<double>::max(), kLeast = std::numeric_limits<double>::denorm_min();
  for (const Mesh& mesh : {corners_of(Vec3{-1, -1, -1} * kMost, Vec3{1, 1, 1} * kMost),
                           corners_of(Vec3{0.5, 0.5, 0.5} * kMost, Vec3{1, 1, 1} * kMost),
                           corners_of({0, 0, 0}, Vec3{1000, 1000, 1000} * kLeast)}) {
    const Image image = draw_mesh(mesh, small_picture());
    EXPECT_GT(std::ranges::count_if(image.pixels, [&](Color c) { return c != image.at(0, 0); }), 500);
  }
}

TEST(MeshPicture, HasTheSizeAskedForAndAMargin) {
  const Image image = draw_mesh(random_triangles(2), small_picture());
  ASSERT_EQ(image.width, 96);
  ASSERT_EQ(image.height, 64);
  for (int x = 0; x < image.width; ++x) {
    EXPECT_EQ(image.at(x, 0), image.at(0, 0));
    EXPECT_EQ(image.at(x, image.height - 1), image.at(0, 0));
  }
}

TEST(MeshPicture, BothSidesOfATriangleLookAlike) {
  Mesh mesh = random_triangles(5);
  const Image one = draw_mesh(mesh, small_picture());
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(draw_mesh(mesh, small_picture()).pixels, one.pixels);
}

TEST(MeshPicture, PointsAndLinesDrawNothing) {
  for (const Mesh& mesh : {corners_of({2, 3, 4}, {2, 3, 4}), corners_of({2, 3, 4}, {9, 3, 4})}) {
    const Image image = draw_mesh(mesh, small_picture());
    EXPECT_EQ(std::ranges::count(image.pixels, image.at(0, 0)), std::ssize(image.pixels));
  }
}

// What no triangle uses may be anything: it must neither be drawn nor crash.
TEST(MeshPicture, UnusedVerticesDoNotMatter) {
  Mesh mesh = random_triangles(6);
  const Image expected = draw_mesh(mesh, small_picture());
  mesh.vertices.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  mesh.vertices.push_back({std::numeric_limits<double>::infinity(), 0, 0});
  mesh.vertices.push_back({1e300, -1e300, std::numeric_limits<double>::max()});
  EXPECT_EQ(draw_mesh(mesh, small_picture()).pixels, expected.pixels);
}

TEST(MeshPicture, RefusesWhatItCannotDraw) {
  const Mesh mesh = random_triangles(7);
  const auto code_of = [&](auto change) {
    PictureOptions options = small_picture();
    change(options);
    try {
      draw_mesh(mesh, options);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code_of([](auto& o) { o.width = 15; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o) { o.height = 8193; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o) { o.azimuth_deg = std::numeric_limits<double>::infinity(); }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o) { o.elevation_deg = 90.5; }), ErrorCode::usage);
  EXPECT_THROW(draw_mesh(Mesh{}, small_picture()), Error);
}

}  // namespace
}  // namespace standoff
