// SPDX-License-Identifier: Apache-2.0
// Compares the signs of many points beside open meshes with the sums of solid angles over all triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "field/reference.h"
#include "geometry/predicates.h"
#include "scenes/scenes.h"
#include "sign/open_winding/caps.h"
#include "sign/signs.h"
#include "standoff/points.h"
#include "tests/sign/shapes.h"
#include "tests/support/reference.h"

namespace standoff::testing {
namespace {

Mesh soup(unsigned seed, std::uint32_t triangles, double size) {
  Random random(seed);
  Mesh mesh;
  for (std::uint32_t n = 0; n < triangles; ++n) {
    const Vec3 at = random.in_cube(1.0);
    for (int corner = 0; corner < 3; ++corner) mesh.vertices.push_back(at + random.in_cube(size));
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

Mesh with_holes(Mesh mesh, unsigned seed, std::uint32_t one_of) {
  Random random(seed);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random.below(one_of) == 0; });
  return mesh;
}

// A half ball within another: the rims are two circles, one inside the other.
Mesh nested_bowls() {
  Mesh mesh = joined(sphere(12), moved(sphere(10), {0.1, 0, 0}, 0.6));
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return mesh.vertices[v].z > 0.25; });
  });
  return mesh;
}

// Sheets above each other, one of them twice: winding numbers exceed 1, and some edges count twice.
Mesh sheets() {
  const Mesh one = terrain(8), above = moved(one, {0.05, 0.02, 0.2});
  return joined(joined(one, above), above);
}

// A disc whose rim has corners in one place, corners in a row, and a needle.
Mesh odd_rim() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0},      {1, 0, 0},  {0.7, 0.7, 0.1}, {0.7, 0.7, 0.1}, {0, 1, 0},
                   {-0.5, 0.5, 0}, {-1, 0, 0}, {-1e-9, -3, 0},  {0, -3, 1e-12}};
  for (std::uint32_t n = 1; n < 8; ++n) mesh.triangles.push_back({0, n, n + 1});
  mesh.triangles.push_back({0, 8, 1});
  mesh.triangles.push_back({4, 4, 5});
  return mesh;
}

struct Settings {
  double spread;  // of the points around each place, as a share of the longest side
  int places, in_each;
};

// Points around corners, which are often on the boundary, and around random places.
std::vector<Vec3> clouds(const Mesh& mesh, unsigned seed, const Settings& settings) {
  Random random(seed);
  const Box box = bounds(mesh);
  std::vector<Vec3> points;
  for (int place = 0; place < settings.places; ++place) {
    const Vec3 amid = place % 4 != 0 ? mesh.vertices[random.below(static_cast<std::uint32_t>(mesh.vertices.size()))]
                                     : box.center() + random.in_cube(box.longest_side());
    const Vec3 middle = amid + random.in_cube(settings.spread * box.longest_side() * random.between(0, 3));
    for (int n = 0; n < settings.in_each; ++n)
      points.push_back(middle + random.in_cube(settings.spread * box.longest_side()));
  }
  return points;
}

// Points whose sign rounding hides do not count. Returns the number of points that count.
int expect_sides(const Mesh& mesh, std::span<const Vec3> points) {
  std::vector<ReferenceWinding> reference;
  for (const Vec3& p : points) reference.push_back(winding_by_angles({mesh}, p));
  std::vector<double> found(points.size());
  int compared = 0, wrong = 0;
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd}) {
    const SignOptions sign{.method = SignMethod::winding, .rule = rule, .as_oriented = true};
    MeshQuery(mesh, {.sign = sign}).distances(points, found);
    for (std::size_t n = 0; n < points.size(); ++n) {
      const auto [value, error, on_surface] = reference[n];
      if (found[n] == 0 || margin(value, rule) <= std::max(error, 1e-9)) continue;
      ++compared;
      if ((found[n] < 0) == is_inside(value, rule) || ++wrong > 5) continue;
      ADD_FAILURE() << "rule " << static_cast<int>(rule) << ", point " << n << ": " << points[n].x << ' ' << points[n].y
                    << ' ' << points[n].z << " at " << found[n] << ", winding number " << value;
    }
  }
  EXPECT_EQ(wrong, 0);
  return compared;
}

// A point's sign does not depend on other points of the call.
void expect_alone_as_together(const Mesh& mesh, std::span<const Vec3> points, std::size_t step = 1) {
  std::vector<double> together(points.size());
  int wrong = 0;
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd}) {
    const MeshQuery query(mesh, {.sign = {.method = SignMethod::winding, .rule = rule, .as_oriented = true}});
    query.distances(points, together);
    for (std::size_t n = 0; n < points.size(); n += step) {
      double alone = 0;
      query.distances({&points[n], 1}, {&alone, 1});
      if (alone == together[n] || ++wrong > 5) continue;
      ADD_FAILURE() << "rule " << static_cast<int>(rule) << ", point " << n << ": " << together[n] << ", alone "
                    << alone;
    }
  }
  EXPECT_EQ(wrong, 0);
}

struct Case {
  const char* name;
  Mesh mesh;
};

std::vector<Case> cases() {
  return {{"terrain", scenes::make("terrain", 500)},
          {"terrain far from the origin", moved(terrain(12), {1e6, -3e7, 2e5})},
          {"small terrain", moved(terrain(12), {}, 1e-20)},
          {"sphere with holes", with_holes(sphere(10), 4, 12)},
          {"half a sphere's triangles", with_holes(sphere(10), 5, 2)},
          {"nested bowls", nested_bowls()},
          {"sheets", sheets()},
          {"moebius", moebius()},
          {"soup", soup(6, 80, 0.3)},
          {"sparse soup", soup(7, 20, 0.05)},
          {"one triangle", scenes::make("one_triangle")},
          {"odd rim", odd_rim()}};
}

TEST(OpenPointSigns, CloudsOfAllSizes) {
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    int compared = 0, asked = 0;
    for (const double spread : {1.0, 0.1, 1e-2, 1e-3, 1e-5}) {
      SCOPED_TRACE(spread);
      const std::vector<Vec3> points = clouds(mesh, 8, {spread, 8, 60});
      compared += expect_sides(mesh, points);
      asked += static_cast<int>(3 * points.size());
    }
    EXPECT_GT(compared, asked / 2);
  }
}

// Points so dense that a single cell decides hundreds: across the surface, and near the boundary.
TEST(OpenPointSigns, ManyPointsInOneCell) {
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    EXPECT_GT(expect_sides(mesh, clouds(mesh, 9, {0.05, 3, 1500})), 0);
    EXPECT_GT(expect_sides(mesh, clouds(mesh, 10, {0.3, 1, 2500})), 0);
  }
}

// Points where the winding number is 1/2: on a surface that the boundary spans, through the middle of a bowl's hole.
TEST(OpenPointSigns, AroundTheThreshold) {
  const Mesh bowl = nested_bowls();
  Random random(11);
  const MeshQuery query(bowl, {.sign = {.method = SignMethod::winding, .as_oriented = true}});
  std::vector<Vec3> points;
  for (int column = 0; column < 40; ++column) {
    Vec3 low{random.between(-0.9, 0.9), random.between(-0.9, 0.9), -0.1}, high = low + Vec3{0, 0, 3};
    if (!(winding_by_angles({bowl}, low).value > 0.5)) continue;
    for (int step = 0; step < 40; ++step) {
      const Vec3 middle = low + (high - low) * 0.5;
      (winding_by_angles({bowl}, middle).value > 0.5 ? low : high) = middle;
    }
    for (const double off : {1e-2, 1e-4, 1e-6, 1e-8, -1e-8, -1e-6, -1e-4, -1e-2})
      points.push_back(low + Vec3{0, 0, off});
  }
  EXPECT_GT(points.size(), 100u);
  EXPECT_GT(expect_sides(bowl, points), 200);
}

TEST(OpenPointSigns, AloneAndTogether) {
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    expect_alone_as_together(mesh, clouds(mesh, 12, {0.1, 4, 300}), 7);
  }
}

// Points from which a ray meets the mesh, and points so far that squares of lengths would overflow.
TEST(OpenPointSigns, FarPoints) {
  const Mesh mesh = nested_bowls();
  std::vector<Vec3> points = clouds(mesh, 14, {30, 1, 500});
  EXPECT_GT(expect_sides(mesh, points), 1000);
  Random random(15);
  for (Vec3& p : points) p = random.in_cube(1e150);
  std::vector<double> found(points.size());
  MeshQuery(mesh, {.sign = {.method = SignMethod::winding, .as_oriented = true}}).distances(points, found);
  EXPECT_EQ(std::ranges::count_if(found, [](double v) { return v < 0; }), 0);
}

// Meshes with a hole in the plane z = 0. Its x and y are between 1 and 2, where sums with binary fractions are exact.
Mesh box_without_lid() {
  Mesh mesh = box({1.125, 1.125, -0.75}, {1.875, 1.875, 0});
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](auto v) { return mesh.vertices[v].z == 0; });
  });
  return mesh;
}

Mesh bowl() {
  Mesh mesh = moved(sphere(20), {1.5, 1.5, 0}, 0.375);
  for (Vec3& v : mesh.vertices)
    if (std::abs(v.z) < 1e-9) v.z = 0;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](auto v) { return mesh.vertices[v].z > 0; });
  });
  return mesh;
}

// The hole is in the middle of the lid: rows inside pass through its corners.
Mesh box_with_a_hole_in_its_lid() {
  Mesh mesh = box_without_lid();
  const auto lid = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const double half : {0.375, 0.125})
    for (const Vec3& to : {Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{1, 1, 0}, Vec3{-1, 1, 0}})
      mesh.vertices.push_back(Vec3{1.5, 1.5, 0} + to * half);
  for (std::uint32_t n = 0; n < 4; ++n) {
    const std::uint32_t here = lid + n, next = lid + (n + 1) % 4;
    mesh.triangles.push_back({here, next, next + 4});
    mesh.triangles.push_back({here, next + 4, here + 4});
  }
  return mesh;
}

// side^3 points whose box has exactly that center, if sums with it are exact.
std::vector<Vec3> lattice(const Vec3& center, double step, int side) {
  std::vector<Vec3> points;
  const auto at = [&](int n) { return (n - 0.5 * (side - 1)) * step; };
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) points.push_back(center + Vec3{at(i), at(j), at(k)});
  return points;
}

// The points may be on a cap's edges.
void expect_winding_numbers(const Mesh& mesh, std::span<const Vec3> points) {
  std::vector<double> found(points.size());
  const MeshQuery query(mesh, {.sign = {.method = SignMethod::winding, .as_oriented = true}});
  query.winding_numbers(points, found);
  for (std::size_t n = 0; n < points.size(); ++n) {
    const auto [value, error, on_surface] = winding_by_angles({mesh}, points[n]);
    if (!on_surface) {
      EXPECT_NEAR(found[n], value, error + 1e-9) << n << (points[n].z == 0 ? ", in the plane" : "");
    }
  }
}

// The side of the cap that a cell's center takes counts for the whole cell. A cap is a fan of triangles around an apex:
// centers are within triangles, on the apex, and on the edges between two. There rounding hides solid angles, so such a
// center is not among the points.
TEST(OpenPointSigns, CentersOfCellsOnCaps) {
  for (const auto& [name, mesh] : {Case{"box", box_without_lid()}, Case{"bowl", bowl()}}) {
    SCOPED_TRACE(name);
    const Rims rims(net_boundary({mesh}, MeshEdges(mesh)));
    std::vector<Vec3> centers = {{1.5, 1.5, 0}, {1.40625, 1.609375, 0}, {1.625, 1.546875, 0}}, on_edges;
    std::size_t exactly = 0;
    for (std::size_t n = 0; n < rims.size(); ++n) {
      const Rim rim = rims[n];
      if (length(rim.apex - Vec3{1.5, 1.5, 0}) > 0.1) continue;  // a small cap beside the boundary
      centers.push_back(rim.apex);
      for (std::size_t corner = 0; corner < rim.corners.size(); corner += 2)
        for (const double way : {0.25, 0.5}) {
          const Vec3 &end = rim.corners[corner], at = rim.apex + (end - rim.apex) * way;
          on_edges.push_back(at);
          exactly += orient2d({rim.apex.x, rim.apex.y}, {end.x, end.y}, {at.x, at.y}) == 0;
        }
    }
    EXPECT_GT(centers.size(), 3u);
    EXPECT_GT(exactly, 0u);
    const auto expect_all = [&mesh = mesh](const Vec3& center, const std::vector<Vec3>& points) {
      SCOPED_TRACE(::testing::Message() << center.x << ' ' << center.y);
      EXPECT_GT(expect_sides(mesh, points), 0);
      expect_alone_as_together(mesh, points);
      expect_winding_numbers(mesh, points);
    };
    for (const Vec3& center : centers) {
      expect_all(center, lattice(center, 0x1p-6, 5));
      expect_all(center, lattice(center, 0x1p-7, 4));
    }
    for (const Vec3& center : on_edges) {
      std::vector<Vec3> points = lattice(center, 0x1p-6, 5);
      std::erase(points, center);
      expect_all(center, points);
    }
  }
}

// Rows along the axes that pass exactly through corners and edges: of the mesh between points of a cell, and of the
// hole's rim beyond them.
TEST(OpenPointSigns, RowsThroughCornersAndEdges) {
  const Mesh open = box_without_lid(), round = bowl(), holed = box_with_a_hole_in_its_lid();
  const auto expect_all = [](const Mesh& mesh, const Vec3& center, double step) {
    SCOPED_TRACE(::testing::Message() << center.x << ' ' << center.y << ' ' << center.z << ", step " << step);
    const std::vector<Vec3> points = lattice(center, step, 5);
    EXPECT_GT(expect_sides(mesh, points), 30);
    expect_alone_as_together(mesh, points);
  };
  for (const double step : {0x1p-4, 0x1p-8}) {
    for (const Vec3& center : {Vec3{1.125, 1.125, -0.75}, Vec3{1.875, 1.5, -0.75}, Vec3{1.5, 1.5, -0.75}})
      for (const Mesh* mesh : {&open, &holed}) expect_all(*mesh, center, step);
    for (const double x : {1.375, 1.5, 1.625})
      for (const double z : {-0.125, -0.25, -0.375}) expect_all(holed, {x, 1.375, z}, step);
    for (std::size_t n = 0; n < round.vertices.size(); n += 37) expect_all(round, round.vertices[n], step);
    for (const Vec3& corner : round.vertices)
      if (corner.z == 0 && std::abs(corner.y - 1.5) < 0.13) expect_all(round, {1.6875, corner.y, 0}, step);
  }
}

}  // namespace
}  // namespace standoff::testing
