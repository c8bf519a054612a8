// SPDX-License-Identifier: Apache-2.0
// Whole pictures: what they show, and what must not change them.
// labels: memory threads
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "render/stage.h"
#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "tests/support/error_code.h"

namespace standoff {
namespace {

PictureOptions small_picture(double azimuth = 35, double elevation = 25) {
  return {
      .width = 96, .height = 64, .azimuth_deg = azimuth, .elevation_deg = elevation, .up = Axis::z, .shadows = false};
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

// A square perpendicular to y, which looks at the front.
Mesh square(double y, double half = 1) {
  return {{{-half, y, -half}, {half, y, -half}, {-half, y, half}, {half, y, half}}, {{0, 1, 2}, {1, 3, 2}}};
}

std::int64_t drawn(const Image& image) {
  return std::ranges::count_if(image.pixels, [&](Color c) { return c != image.at(0, 0); });
}

Color middle(const Image& image) { return image.at(image.width / 2, image.height / 2); }

TEST(Picture, HasTheSizeAskedForAndAMargin) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    PictureOptions options = small_picture(31.0 * seed, 15.0 * seed - 90);
    options.perspective = seed % 2 == 0;
    options.up = static_cast<Axis>(seed % 3);
    const Image image = draw_mesh(random_triangles(seed), options);
    ASSERT_EQ(image.width, 96);
    ASSERT_EQ(image.height, 64);
    EXPECT_GT(drawn(image), 300);
    for (int x = 0; x < image.width; ++x)
      EXPECT_TRUE(image.at(x, 0) == image.at(0, 0) && image.at(x, 63) == image.at(0, 0)) << x;
    for (int y = 0; y < image.height; ++y)
      EXPECT_TRUE(image.at(0, y) == image.at(0, 0) && image.at(95, y) == image.at(0, 0)) << y;
  }
}

// All layers at once, on one thread and on several; tiles and chunks are drawn in any order.
TEST(Picture, ThreadsDoNotMatter) {
  const Mesh mesh = scenes::make("box", 12);
  const Grid grid = fit_resolution(bounds(mesh), 24);
  ComputeOptions how{.sign = {.method = SignMethod::automatic}};
  const DistanceField field = compute(mesh, grid, 4 * grid.max_spacing(), how).field;
  const std::vector<Vec3> points(mesh.vertices);
  const Mesh wall = square(-2);
  Drawing drawing{.meshes = {{.mesh = mesh, .edges = true}, {.mesh = wall, .opacity = 0.4}},
                  .slices = {{.field = &field}},
                  .bands = {{.field = &field, .within = grid.max_spacing()}},
                  .points = {{.points = points}},
                  .paths = {{.points = points}},
                  .boxes = {{.box = grid.bounds()}}};
  PictureOptions options{.width = 300, .height = 200, .threads = 1};
  const Image expected = draw_picture(drawing, options);
  EXPECT_GT(drawn(expected), 8000);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    EXPECT_EQ(draw_picture(drawing, options).pixels, expected.pixels) << threads;
  }
}

TEST(Picture, MeshesOfAnySizeLookAlike) {
  const Mesh mesh = random_triangles(9);
  for (const bool shadows : {false, true}) {
    PictureOptions options = small_picture();
    options.shadows = shadows;
    const Image expected = draw_mesh(mesh, options);
    ASSERT_GT(drawn(expected), 500);
    for (const int power : {-900, 520, 1021}) {
      Mesh scaled = mesh;
      for (Vec3& v : scaled.vertices) v = v * std::ldexp(1.0, power);
      EXPECT_EQ(draw_mesh(scaled, options).pixels, expected.pixels) << "2^" << power;
    }
  }
}

TEST(Picture, BothSidesOfATriangleLookAlike) {
  Mesh mesh = random_triangles(5);
  const Image one = draw_mesh(mesh, small_picture());
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(draw_mesh(mesh, small_picture()).pixels, one.pixels);
}

TEST(Picture, PointsAndLinesDrawNothing) {
  for (const Vec3 end : {Vec3{2, 3, 4}, Vec3{9, 3, 4}}) {
    const Mesh mesh{{{2, 3, 4}, end, {0.5 * (2 + end.x), 3, 4}}, {{0, 1, 2}, {0, 0, 1}}};
    PictureOptions options = small_picture();
    options.shadows = true;
    EXPECT_EQ(drawn(draw_mesh(mesh, options)), 0);
  }
}

// What no triangle uses may be anything: it must neither be drawn nor crash.
TEST(Picture, UnusedVerticesDoNotMatter) {
  Mesh mesh = random_triangles(6);
  PictureOptions options = small_picture();
  options.shadows = true;
  const Image expected = draw_mesh(mesh, options);
  mesh.vertices.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  mesh.vertices.push_back({std::numeric_limits<double>::infinity(), 0, 0});
  mesh.vertices.push_back({1e300, -1e300, std::numeric_limits<double>::max()});
  EXPECT_EQ(draw_mesh(mesh, options).pixels, expected.pixels);
}

// The nearer of two squares hides the other, in either order.
TEST(Picture, NearerThingsHideOthers) {
  const Mesh near = square(-1), far = square(1, 3);
  const MeshLayer red{.mesh = near, .color = {255, 0, 0}}, blue{.mesh = far, .color = {0, 0, 255}};
  for (const bool swapped : {false, true}) {
    Drawing drawing{.meshes = {red, blue}};
    if (swapped) std::swap(drawing.meshes[0], drawing.meshes[1]);
    const Image image = draw_picture(drawing, small_picture(0, 0));
    EXPECT_GT(middle(image)[0], 150);
    EXPECT_EQ(middle(image)[2], 0);
  }
}

// From the back to the front, whatever the order of the layers; and what is behind something opaque stays hidden.
TEST(Picture, SeeThroughThingsAreOrderedByDepth) {
  const Mesh front = square(-1), middle_one = square(0), back = square(1);
  std::vector<MeshLayer> layers{{.mesh = front, .color = {255, 0, 0}, .opacity = 0.5},
                                {.mesh = middle_one, .color = {0, 255, 0}, .opacity = 0.5},
                                {.mesh = back, .color = {0, 0, 255}}};
  std::vector<int> order{0, 1, 2};
  Color expected{};
  do {
    Drawing drawing;
    for (const int n : order) drawing.meshes.push_back(layers[n]);
    const Color seen = middle(draw_picture(drawing, small_picture(0, 0)));
    if (order == std::vector{0, 1, 2}) {
      expected = seen;
      EXPECT_GT(seen[0], seen[1]);
      EXPECT_GT(seen[2], 50);
    }
    EXPECT_EQ(seen, expected);
  } while (std::ranges::next_permutation(order).found);
  layers[0].opacity = 1;
  Drawing hidden{.meshes = layers};
  EXPECT_EQ(middle(draw_picture(hidden, small_picture(0, 0)))[1], 0);
}

// Neighbouring see-through triangles cover no sample twice: there is no seam between them.
TEST(Picture, SeeThroughSurfacesHaveNoSeams) {
  const Mesh wall = square(0);
  Drawing drawing{.meshes = {{.mesh = wall, .opacity = 0.5, .shading = Shading::flat}}};
  const Image image = draw_picture(drawing, small_picture(0, 0));
  for (int y = 10; y < 54; ++y)
    for (int x = 30; x < 66; ++x) EXPECT_EQ(image.at(x, y), middle(image)) << x << "," << y;
}

// A ball over a floor darkens it, and the open floor stays as bright as without shadows.
TEST(Picture, ShadowsFallOnTheFloor) {
  Mesh mesh = square(0, 4);
  for (Vec3& v : mesh.vertices) v = {v.x, v.z, 0};
  const Mesh box = scenes::make("box", 12);
  const Box size = bounds(box);
  for (const Triangle& t : box.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const std::uint32_t v : t)
      mesh.vertices.push_back((box.vertices[v] - size.center()) * (1 / size.longest_side()) + Vec3{0, 0, 0.7});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  PictureOptions options = small_picture(0, 89);
  const Image bright = draw_mesh(mesh, options);
  options.shadows = true;
  const Image image = draw_mesh(mesh, options);
  int darker = 0;
  for (std::size_t n = 0; n < image.pixels.size(); ++n) darker += image.pixels[n][0] + 20 < bright.pixels[n][0];
  EXPECT_GT(darker, 100);
  EXPECT_LT(darker, 2000);
  EXPECT_NEAR(image.at(25, 50)[0], bright.at(25, 50)[0], 6);
}

TEST(Picture, SlicesShowTheFieldAndCutMeshes) {
  const Mesh mesh = scenes::make("box", 12);
  const Grid grid = fit_resolution(bounds(mesh), 32);
  const DistanceField field = compute(mesh, grid, kFullField, {.sign = {SignMethod::none}}).field;
  Drawing drawing{.meshes = {{.mesh = mesh}}};
  PictureOptions options = small_picture(0, 0);
  options.legend = false;
  const Color whole = middle(draw_picture(drawing, options));
  drawing.slices = {{.field = &field, .axis = Axis::y, .cuts = false}};
  EXPECT_EQ(middle(draw_picture(drawing, options)), whole);
  drawing.slices[0].cuts = true;
  // Yellow: the greatest distance is in the middle.
  const Color cut = middle(draw_picture(drawing, options));
  EXPECT_GT(cut[0], 150);
  EXPECT_GT(cut[1], 150);
  EXPECT_LT(cut[2], 120);
}

TEST(Picture, NumbersThatAreNotFiniteAreLeftOut) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  DistanceField field({{9, 9, 9}, {-1, -1, -1}, {0.25, 0.25, 0.25}}, kInf);
  auto values = field.store_tile(0, 0, 0);
  for (std::size_t n = 0; n < values.size(); ++n)
    values[n] = n % 3 == 0 ? static_cast<float>(kNan) : n % 3 == 1 ? static_cast<float>(kInf) : 0.5F;
  const std::vector<Vec3> points{{0, 0, 0}, {kNan, 0, 0}, {1, 1, 1}, {0, -kInf, 0}, {1, 0, 1}};
  const std::vector<double> numbers{1, 2, kNan, 4, -kInf};
  Drawing drawing{.slices = {{.field = &field}},
                  .bands = {{.field = &field}},
                  .points = {{.points = points, .values = numbers}},
                  .paths = {{.points = points, .values = numbers}}};
  EXPECT_GT(drawn(draw_picture(drawing, small_picture())), 100);
}

TEST(Picture, RefusesWhatItCannotDraw) {
  const Mesh mesh = random_triangles(7);
  Drawing drawing{.meshes = {{.mesh = mesh}}};
  const auto code_of = [&](auto change) {
    PictureOptions options = small_picture();
    Drawing changed = drawing;
    change(options, changed);
    return testing::code_of([&] { draw_picture(changed, options); });
  };
  const std::vector<Vec3> points(3);
  const std::vector<double> two(2);
  const std::vector<std::size_t> bad_starts{0, 7};
  EXPECT_EQ(code_of([](auto& o, auto&) { o.width = 15; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o, auto&) { o.height = 8193; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o, auto&) { o.azimuth_deg = std::numeric_limits<double>::infinity(); }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o, auto&) { o.elevation_deg = 90.5; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o, auto&) { o.samples = 3; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o, auto&) { o.zoom = 0; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o, auto&) { o.threads = -1; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto& o, auto&) { o.memory_limit = 1000; }), ErrorCode::limit);
  EXPECT_EQ(code_of([](auto&, auto& d) { d = {}; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto&, auto& d) { d.meshes[0].mesh = {}; }), ErrorCode::input);
  EXPECT_EQ(code_of([](auto&, auto& d) { d.meshes[0].opacity = 1.5; }), ErrorCode::usage);
  EXPECT_EQ(code_of([&](auto&, auto& d) { d.meshes[0].values = two; }), ErrorCode::usage);
  EXPECT_EQ(code_of([&](auto&, auto& d) { d.meshes[0].normals = points; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto&, auto& d) { d.slices = {{}}; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto&, auto& d) { d.bands = {{}}; }), ErrorCode::usage);
  EXPECT_EQ(code_of([](auto&, auto& d) { d.boxes = {{}}; }), ErrorCode::usage);
  EXPECT_EQ(code_of([&](auto&, auto& d) { d.points = {{.points = points, .radius = -1}}; }), ErrorCode::usage);
  EXPECT_EQ(code_of([&](auto&, auto& d) { d.points = {{.points = points, .values = two}}; }), ErrorCode::usage);
  EXPECT_EQ(code_of([&](auto&, auto& d) { d.paths = {{.points = points, .starts = bad_starts}}; }), ErrorCode::usage);
}

}  // namespace
}  // namespace standoff
