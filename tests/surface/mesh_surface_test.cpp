// SPDX-License-Identifier: Apache-2.0
// Surfaces of meshes: sharp edges come back, damaged meshes become solids, offsets are as far away as asked for.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "scenes/scenes.h"
#include "standoff/points.h"
#include "standoff/pose.h"
#include "standoff/surface.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"
#include "tests/surface/manifold.h"

namespace standoff {
namespace {

using namespace testing;

// A part: an L-shaped profile, extruded. Its edges are concave and convex.
struct Part {
  Mesh mesh;
  std::vector<std::array<Vec3, 2>> edges;
};

Part bracket(const Pose& pose) {
  const std::array<std::array<double, 2>, 6> profile{{{0, 0}, {2, 0}, {2, 0.7}, {0.8, 0.7}, {0.8, 1.9}, {0, 1.9}}};
  Part part;
  for (const double z : {0.0, 1.3})
    for (const auto& [x, y] : profile) part.mesh.vertices.push_back(apply(pose, Vec3{x, y, z}));
  for (const Triangle t : {Triangle{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}}) {
    part.mesh.triangles.push_back({t[0], t[2], t[1]});
    part.mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (std::uint32_t n = 0; n < 6; ++n) {
    const std::uint32_t m = (n + 1) % 6;
    part.mesh.triangles.push_back({n, m, m + 6});
    part.mesh.triangles.push_back({n, m + 6, n + 6});
    const auto& v = part.mesh.vertices;
    part.edges.push_back({v[n], v[m]});
    part.edges.push_back({v[n + 6], v[m + 6]});
    part.edges.push_back({v[n], v[n + 6]});
  }
  return part;
}

// How far the points of the part's sharp edges are from a mesh, in spacings: for each of so many points along an edge.
std::vector<double> missed(const Part& part, const Mesh& mesh, double spacing) {
  std::vector<Vec3> points;
  for (const auto& [a, b] : part.edges)
    for (int n = 0; n <= 400; ++n) points.push_back(a + (b - a) * (n / 400.0));
  std::vector<double> distances;
  for (const ClosestPoint& found : closest_points(mesh, points)) distances.push_back(found.distance / spacing);
  std::ranges::sort(distances);
  return distances;
}

TEST(MeshSurface, SharpEdgesComeBack) {
  const Part part = bracket({});
  const Grid grid = fit_resolution(bounds(part.mesh), 60);
  const SurfaceResult dual =
      surface(part.mesh, grid, {.method = SurfaceMethod::dual, .sign = {SignMethod::automatic}, .examine = true});
  EXPECT_EQ(manifold_fault(dual.mesh), "");
  EXPECT_EQ(dual.report.self_intersections, 0);
  EXPECT_EQ(dual.report.components, 1);
  EXPECT_LT(missed(part, dual.mesh, grid.spacing.x).back(), 1e-3);
  EXPECT_NEAR(volume(dual.mesh), volume(part.mesh), 1e-4);
  const Mesh cubes = surface(part.mesh, grid, {.sign = {SignMethod::automatic}}).mesh;
  EXPECT_GT(missed(part, cubes, grid.spacing.x).back(), 0.1) << "marching cubes cut edges off";
}

// In any position: nearly all of each edge. Where an edge only just passes through a cell without changing the sign of
// a sample, no method that sees samples alone can know of it.
TEST(MeshSurface, SharpEdgesComeBackInAnyPosition) {
  for (int n = 0; n < 4; ++n) {
    const Part part = bracket(make_pose({1, 0.5 * n, 2}, 0.4 + n, {10, 20, 30}));
    const Grid grid = fit_resolution(bounds(part.mesh), 80);
    const SurfaceResult dual =
        surface(part.mesh, grid, {.method = SurfaceMethod::dual, .sign = {SignMethod::automatic}, .examine = true});
    EXPECT_EQ(manifold_fault(dual.mesh), "");
    EXPECT_LT(dual.report.self_intersections, 3);
    const std::vector<double> distances = missed(part, dual.mesh, grid.spacing.x);
    const auto share = [&](double part_of) {
      return distances[static_cast<std::size_t>(part_of * double(distances.size() - 1))];
    };
    EXPECT_LT(share(0.5), 1e-3);
    EXPECT_LT(share(1), 0.5);
    EXPECT_NEAR(volume(dual.mesh) / volume(part.mesh), 1, 1e-3);
    RecordProperty("worst", std::to_string(share(1)));
  }
}

TEST(MeshSurface, OffsetsAreExactDistances) {
  const Mesh ball = sphere(24);
  for (const double at : {-0.3, 0.02, 0.25})
    for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual}) {
      const Grid grid = fit_resolution(bounds(ball).grown(std::max(0.0, at)), 50);
      const Mesh mesh = surface(ball, grid, {.at = at, .method = method, .sign = {SignMethod::winding}}).mesh;
      EXPECT_EQ(manifold_fault(mesh), "");
      EXPECT_EQ(euler_characteristic(mesh), 2);
      double worst = 0;
      for (const ClosestPoint& found : closest_points(ball, mesh.vertices))
        worst = std::max(worst, std::abs(found.distance - std::abs(at)));
      EXPECT_LT(worst, 0.04 * grid.spacing.x) << at;
      EXPECT_EQ(volume(mesh) > volume(ball), at > 0);
    }
}

// The offset of a box inwards is a box: its sharp edges are not the mesh's.
TEST(MeshSurface, OffsetsInwardsHaveSharpEdges) {
  const Part part = bracket(make_pose({0, 0, 1}, 0, {0.01, 0.02, 0.03}));
  const Grid grid = fit_resolution(bounds(part.mesh), 50);
  const Mesh mesh =
      surface(part.mesh, grid, {.at = -0.2, .method = SurfaceMethod::dual, .sign = {SignMethod::winding}}).mesh;
  EXPECT_EQ(manifold_fault(mesh), "");
  // At the concave edge the surface is a quarter of a cylinder, nearer to the edge than the corner of the planes.
  const double round = 0.2 * 0.2 * (1 - std::numbers::pi / 4);
  EXPECT_NEAR(volume(mesh), (1.6 * 0.3 + 0.4 * 1.2 + round) * 0.9, 1e-3);
  std::vector<Vec3> on_edges;
  for (const auto& [x, y] :
       std::array<std::array<double, 2>, 5>{{{0.2, 0.2}, {1.8, 0.2}, {1.8, 0.5}, {0.6, 1.7}, {0.2, 1.7}}})
    for (int n = 0; n <= 90; ++n) on_edges.push_back(Vec3{x, y, 0.2 + 0.01 * n} + Vec3{0.01, 0.02, 0.03});
  for (const ClosestPoint& found : closest_points(mesh, on_edges)) EXPECT_LT(found.distance, 1e-3 * grid.spacing.x);
}

TEST(MeshSurface, AWallMakesAPartHollow) {
  const Part part = bracket(make_pose({1, 1, 0}, 0.3, {}));
  const Grid grid = fit_resolution(bounds(part.mesh), 60);
  for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual}) {
    const SurfaceResult hollow =
        surface(part.mesh, grid, {.wall = 0.15, .method = method, .sign = {SignMethod::automatic}, .examine = true});
    EXPECT_EQ(manifold_fault(hollow.mesh), "");
    EXPECT_EQ(hollow.report.components, 2);
    EXPECT_EQ(hollow.report.self_intersections, 0);
    EXPECT_LT(volume(hollow.mesh), 0.75 * volume(part.mesh));
  }
}

// Whatever the mesh: open, with parts inside each other, inside out. The sign decides what is inside.
TEST(MeshSurface, DamagedMeshesBecomeSolids) {
  std::vector<Mesh> meshes{sphere(12), torus(), bracket({}).mesh};
  for (std::size_t n = 0; n < 3; ++n) {
    Mesh open = meshes[n];
    open.triangles.erase(open.triangles.begin() + 2, open.triangles.begin() + 5);
    meshes.push_back(open);
    std::mt19937 random(7);
    Mesh turned = meshes[n];
    for (Triangle& t : turned.triangles)
      if (random() % 2 == 0) std::swap(t[0], t[1]);
    meshes.push_back(turned);
    Mesh twice = meshes[n];  // and a copy, moved so that they intersect
    for (const Vec3& v : meshes[n].vertices) twice.vertices.push_back(v + Vec3{0.3, 0.2, 0.1});
    for (const Triangle& t : meshes[n].triangles) {
      const auto shift = static_cast<std::uint32_t>(meshes[n].vertices.size());
      twice.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    }
    meshes.push_back(twice);
  }
  for (std::size_t n = 0; n < meshes.size(); ++n)
    for (const SignMethod sign : {SignMethod::winding, SignMethod::flood, SignMethod::automatic})
      for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual})
        for (const bool outer : {false, true}) {
          const Grid grid = fit_resolution(bounds(meshes[n]), 40);
          try {
            const SurfaceResult result =
                surface(meshes[n], grid, {.method = method, .sign = {.method = sign, .outer = outer}});
            EXPECT_EQ(manifold_fault(result.mesh), "") << n << " by sign " << int(sign);
            const bool leaks = sign == SignMethod::flood && n % 3 == 0 && n >= 3;  // a flood fills what has a hole
            EXPECT_EQ(volume(result.mesh) > 0.1, !leaks) << n << " by sign " << int(sign);
          } catch (const Error& error) {
            EXPECT_TRUE(outer || n >= 3) << n << ": " << error.what();
          }
        }
}

TEST(MeshSurface, ScenesBecomeSolids) {
  for (const char* name : {"fly", "box", "our_process_small"}) {
    const Mesh mesh = scenes::make(name, 3000);
    const Grid grid = fit_resolution(bounds(mesh), 64);
    for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual})
      for (const double at : {0.0, 1.5 * grid.spacing.x})
        EXPECT_EQ(manifold_fault(surface(mesh, fit_resolution(bounds(mesh).grown(at), 64),
                                         {.at = at, .method = method, .sign = {SignMethod::automatic}})
                                     .mesh),
                  "")
            << name;
  }
}

TEST(MeshSurface, ASheetHasASurfaceAroundIt) {
  const Mesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const Grid grid = fit_resolution(bounds(sheet).grown(0.2), 40);
  for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual}) {
    const Mesh around = surface(sheet, grid, {.at = 0.2, .method = method, .sign = {SignMethod::none}}).mesh;
    EXPECT_EQ(manifold_fault(around), "");
    const double kRound = std::numbers::pi * 0.04;
    EXPECT_NEAR(volume(around), 0.4 + 4 * kRound / 2 + 4.0 / 3 * 0.2 * kRound, 0.005);
    const Mesh shell =
        surface(sheet, grid, {.method = method, .sign = {.method = SignMethod::shell, .shell = 0.3}}).mesh;
    EXPECT_EQ(manifold_fault(shell), "");
    EXPECT_NEAR(volume(shell), 0.3 + 4 * kRound / 2 * 0.5625 + 4.0 / 3 * 0.15 * kRound * 0.5625, 0.005);
  }
}

TEST(MeshSurface, NoInsideIsAnError) {
  const Mesh sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const Grid grid = fit_resolution(bounds(sheet), 20);
  const auto made = [&](const SignOptions& sign, double at) { return surface(sheet, grid, {.at = at, .sign = sign}); };
  expect_error([&] { made({SignMethod::automatic}, 0); }, ErrorCode::input, "there is no inside");
  expect_error([&] { made({}, -0.1); }, ErrorCode::input, "choose a sign method");
}

TEST(MeshSurface, ThreadsChangeNothing) {
  const Mesh mesh = scenes::make("fly", 2000);
  const Grid grid = fit_resolution(bounds(mesh), 50);
  for (const double at : {0.0, 0.05}) {
    SurfaceOptions options{.at = at, .method = SurfaceMethod::dual, .execution = {.threads = 1}};
    const Mesh one = surface(mesh, grid, options).mesh;
    options.execution.threads = 4;
    const Mesh many = surface(mesh, grid, options).mesh;
    EXPECT_EQ(one.vertices, many.vertices);
    EXPECT_EQ(one.triangles, many.triangles);
  }
}

// A body, a plate of half a spacing that no sample is in, one of two spacings, and a body within the first.
TEST(MeshSurface, SaysWhatIsLost) {
  const Grid grid{{60, 40, 40}, {-0.52, -0.52, -0.52}, {0.1, 0.1, 0.1}};
  const auto box = [](Vec3 low, Vec3 high) { return testing::box(low, high); };
  const Mesh body = testing::joined(box({0, 0, 0}, {1, 1, 1}), box({0.3, 0.3, 0.3}, {0.7, 0.7, 0.7})),
             thin = box({2, 0, 0.01}, {4, 2, 0.06}), thick = box({2, 0, 1}, {4, 2, 1.2});
  const Mesh all = testing::joined(testing::joined(body, thin), thick);
  const SignOptions sign{SignMethod::automatic};
  const SurfaceReport report = surface(all, grid, {.sign = sign}).report;
  EXPECT_EQ(report.parts, 4);
  EXPECT_EQ(report.lost_parts, 1);
  const double areas[] = {6 + 6 * 0.16, 8 + 8 * 0.05, 8 + 8 * 0.2};
  EXPECT_NEAR(report.lost_share, areas[1] / (areas[0] + areas[1] + areas[2]), 1e-3);
  EXPECT_NEAR(report.lost_thickness, 0.05, 0.005);
  EXPECT_NE(report.lost.find("1 of its 4 parts"), std::string::npos) << report.lost;
  EXPECT_NE(report.lost.find("a spacing below 0.04"), std::string::npos) << report.lost;
  EXPECT_EQ(surface(all, grid, {.sign = sign, .execution = {.threads = 1}}).report.lost, report.lost);
  // With what the sentence names, it is there.
  EXPECT_EQ(surface(all, grid, {.at = 0.1, .sign = sign}).report.lost, "");
  SignOptions shell{.method = SignMethod::shell, .shell = 0.2};
  EXPECT_EQ(surface(all, grid, {.sign = shell}).report.lost, "");
  const Grid finer{{150, 100, 100}, {-0.52, -0.52, -0.52}, {0.04, 0.04, 0.04}};
  EXPECT_EQ(surface(all, finer, {.sign = sign}).report.lost, "");
  EXPECT_EQ(surface(testing::joined(body, thick), grid, {.sign = sign}).report.lost, "");
  // What the grid does not reach was not asked for.
  const Grid half{{20, 40, 40}, {-0.52, -0.52, -0.52}, {0.1, 0.1, 0.1}};
  EXPECT_EQ(surface(all, half, {.sign = sign}).report.lost, "");
}

}  // namespace
}  // namespace standoff
