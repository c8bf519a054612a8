// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// Reports of meshes with known answers: closed, damaged, open, without an inside; figures of components in closed form.
#include "standoff/mesh_report.h"

#include <gtest/gtest.h>

#include "tests/sign/cases/solids.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/expect_error.h"

namespace standoff {
namespace {

using namespace testing;

void expect_method(const Mesh& mesh, SignMethod method, bool sure, const char* why) {
  const MeshReport found = report(mesh);
  EXPECT_EQ(name_of(found.method), std::string(name_of(method))) << found.why;
  EXPECT_EQ(found.sure, sure) << found.why;
  EXPECT_NE(found.why.find(why), std::string::npos) << found.why;
}

TEST(MeshReport, OfABox) {
  const MeshReport found = report(box({1, 2, 3}, {3, 5, 7}));
  EXPECT_EQ(found.triangles, 12);
  EXPECT_EQ(found.positions, 8);
  EXPECT_EQ(found.bounds.min, (Vec3{1, 2, 3}));
  EXPECT_EQ(found.area, 52);
  EXPECT_TRUE(found.closed());
  EXPECT_EQ(found.patches, 1);
  EXPECT_EQ(found.degenerate + found.duplicate_same + found.duplicate_opposite + found.nonmanifold_edges +
                found.inconsistent_edges + found.flipped + found.left_out + found.boundary_edges,
            0);
  EXPECT_NEAR(found.volume, 24, 1e-12);
  EXPECT_EQ(found.least_winding, 0);
  EXPECT_EQ(found.most_winding, 1);
  EXPECT_TRUE(found.intersections_known);
  ASSERT_EQ(found.component_count, 1);
  const MeshComponent& one = found.components.at(0);
  EXPECT_TRUE(one.closed && one.solid);
  EXPECT_EQ(one.triangles, 12);
  EXPECT_NEAR(one.volume, 24, 1e-12);
  EXPECT_NEAR(length(one.centroid - Vec3{2, 3.5, 5}), 0, 1e-12);
  const std::array<double, 6> inertia = {24 * (9. + 16) / 12, 24 * (16. + 4) / 12, 24 * (4. + 9) / 12, 0, 0, 0};
  for (std::size_t n = 0; n < 6; ++n) EXPECT_NEAR(one.inertia[n], inertia[n], 1e-12);
}

TEST(MeshReport, MomentsOfATetrahedron) {
  // Far from the origin the figures lose no more digits than the corners have.
  const Vec3 at{1 << 20, -(1 << 21), 1 << 20};
  const MeshReport found = report(mesh_of({{at, at + Vec3{1, 0, 0}, at + Vec3{0, 1, 0}, at + Vec3{0, 0, 1}}}));
  const MeshComponent& one = found.components.at(0);
  EXPECT_NEAR(one.volume, 1. / 6, 1e-15);
  EXPECT_NEAR(length(one.centroid - (at + Vec3{0.25, 0.25, 0.25})), 0, 1e-9);
  for (std::size_t n = 0; n < 6; ++n) EXPECT_NEAR(one.inertia[n], n < 3 ? 1. / 80 : 1. / 480, 1e-15) << n;
}

TEST(MeshReport, DamagedSpheres) {
  expect_method(sphere(), SignMethod::winding, true, "the mesh is closed");
  expect_method(reversed(sphere()), SignMethod::winding, true, "triangles flipped the mesh is closed");
  expect_method(with_flipped(sphere(), 9), SignMethod::winding, true, "1 triangle flipped");
  expect_method(with_copy(sphere(), 9, false), SignMethod::winding, true, "1 triangle left out");
  expect_method(with_copy(sphere(), 9, true), SignMethod::winding, true, "1 triangle left out");
  expect_method(without(sphere(32), 9), SignMethod::winding, false, "1 hole ");

  const MeshReport open = report(without(sphere(), 40), {.spacing = 0.125});
  EXPECT_FALSE(open.closed());
  EXPECT_EQ(open.boundary_edges, 3);
  EXPECT_EQ(open.boundary_loops, 1);
  EXPECT_GT(open.largest_hole, 0);
  EXPECT_EQ(open.largest_hole_in_samples, open.largest_hole * 8);
  EXPECT_NEAR(open.volume, report(sphere()).volume, 1e-12);  // a cap closes it
  EXPECT_NEAR(open.cap_share, (report(sphere()).area - open.area) / open.area, 1e-12);
  EXPECT_EQ(open.most_winding, 0);
}

TEST(MeshReport, CavitiesAndNestedShells) {
  const Mesh outer = box({-2, -2, -2}, {2, 2, 2});
  const double ring = report(torus()).volume;
  const MeshReport cavity = report(reversed(joined(outer, reversed(torus()))));
  EXPECT_NEAR(cavity.volume, 64 - ring, 1e-12);
  EXPECT_EQ(cavity.deepest, 1);
  EXPECT_EQ(cavity.most_winding, 1);
  EXPECT_EQ(cavity.components.at(0).depth, 0);
  EXPECT_EQ(cavity.components.at(1).depth, 1);
  EXPECT_NEAR(cavity.components.at(1).volume, -ring, 1e-12);
  EXPECT_LT(cavity.components.at(1).inertia[0], 0);
  Mesh shells;
  for (int n = 0; n < 6; ++n) shells = joined(shells, moved(sphere(), {}, 1 - 0.1 * n));
  EXPECT_EQ(report(shells).deepest, 5);
  EXPECT_EQ(report(shells).most_winding, 6);
  EXPECT_TRUE(report(shells).sure);
  // A part inside out that overlaps another one, and is in none.
  const Mesh overlapping = joined(box(), reversed(box({0.5, 0.5, 0.5}, {2, 2, 2})));
  EXPECT_EQ(report(overlapping).flipped, 12);
  EXPECT_EQ(report(overlapping).most_winding, 2);
}

TEST(MeshReport, SheetsHaveNoInside) {
  Mesh hemisphere = sphere(16);
  std::erase_if(hemisphere.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return hemisphere.vertices[v].z < -1e-9; });
  });
  for (const Mesh& mesh : {terrain(), reversed(terrain()), terrain(1, 0), hemisphere, random_soup(1, 30, 9, 1)})
    expect_method(mesh, SignMethod::none, false, "has no inside; `normal`");
  EXPECT_NEAR(report(hemisphere).cap_share, 0.5, 0.01);
  expect_method(joined(terrain(), reversed(terrain())), SignMethod::none, false, "sheet");
  expect_method(moebius(), SignMethod::none, false, "1 patch has but one side");
  // A plate is no sheet.
  expect_method(box({0, 0, 0}, {1, 1, 1e-4}), SignMethod::winding, true, "closed");
  // A cube without a lid is no sheet.
  expect_method(without(without(box(), 0), 0), SignMethod::winding, false, "takes 20 % of its area");
}

TEST(MeshReport, ClosedMeshesWithoutAnInside) {
  expect_method(klein_bottle(), SignMethod::flood, false, "but one side, and no edge is open");
  EXPECT_EQ(report(klein_bottle()).unorientable, 1);
  EXPECT_GT(report(klein_bottle()).intersecting_pairs, 0);
  EXPECT_FALSE(report(klein_bottle()).components.at(0).solid);
  // Two sheets of one square, cut along different diagonals.
  Mesh flat{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}}};
  expect_method(flat, SignMethod::none, true, "no volume");
}

// What cancels is named, and makes doubtful what is left if it is much.
TEST(MeshReport, PartsThatCancel) {
  const Mesh pane = two_sided(terrain());
  const auto ball = [](double radius) { return moved(sphere(24), {0, 0, 3 * radius}, radius); };
  const MeshReport small = report(joined(ball(1), pane));
  EXPECT_NEAR(small.cancelled_share, 0.41, 0.02);
  expect_method(joined(ball(1), pane), SignMethod::winding, false, "% of the area is there in both orientations");
  expect_method(joined(ball(4), pane), SignMethod::winding, true, "; 1 part with 3.9 % of the area");
  const MeshReport large = report(joined(ball(40), pane));
  EXPECT_EQ(large.cancelled_parts, 1);
  EXPECT_EQ(large.why.find("orientations"), std::string::npos) << large.why;
}

// Cracks that nobody sees, and triangles turned at random: neighbours do not touch, so that nothing can be repaired.
TEST(MeshReport, CrackedSoupsAreFlooded) {
  for (const Mesh& solid : {sphere(12), box({0, 0, 0}, {3, 2, 1}), torus(16, 8)}) {
    const double extent = bounds(solid).longest_side();
    for (const double far : {1e-9, 1e-7, 1e-5}) {
      std::int64_t turned = 0;
      const Mesh soup = randomly_turned(cracked(solid, far * extent, 3), 5, turned);
      expect_method(soup, SignMethod::flood, false, "its gaps are cracks");
      expect_method(shuffled(soup, 2), SignMethod::flood, false, "its gaps are cracks");
    }
    // With the right orientation the winding number is right, and without cracks the orientation is repaired.
    expect_method(cracked(solid, 1e-7 * extent, 3), SignMethod::winding, false, "fit together");
    std::int64_t turned = 0;
    expect_method(randomly_turned(solid, 5, turned), SignMethod::winding, true, "flipped");
    // Gaps that are seen are no cracks. What may work even so is named.
    const MeshReport wide = report(randomly_turned(cracked(solid, 1e-2 * extent, 3), 5, turned));
    if (wide.method == SignMethod::none) EXPECT_NE(wide.why.find("`flood`"), std::string::npos) << wide.why;
    expect_method(without(solid, 5), SignMethod::winding, false, "hole");
  }
  const MeshReport bowl = report(cut_off(sphere(16), -0.1));
  EXPECT_NE(bowl.why.find("`winding` closes its holes"), std::string::npos) << bowl.why;
  EXPECT_EQ(report(terrain()).why.find("`winding`"), std::string::npos);
}

TEST(MeshReport, TwoSidedMeshes) {
  const Mesh closed = joined(box(), reversed(box()));
  EXPECT_TRUE(report(closed).two_sided);
  EXPECT_EQ(report(closed).duplicate_opposite, 12);
  EXPECT_EQ(report(closed).nonmanifold_edges, 18);
  expect_method(closed, SignMethod::winding, false, "both orientations");
  const Mesh lidless = without(without(box(), 0), 0);
  expect_method(joined(lidless, reversed(lidless)), SignMethod::winding, false, "both orientations");
}

TEST(MeshReport, BodiesWithCracks) {
  // A box whose one face has a vertex in the middle of an edge that its neighbour does not have: a crack without area.
  Mesh mesh = box();
  mesh.vertices.push_back({0.5, 0, 0});  // on the edge 0 1
  for (std::size_t t = 0; t < 12; ++t) {
    Triangle& corners = mesh.triangles[t];
    if (corners == Triangle{0, 3, 1}) {
      corners = {0, 3, 8};
      mesh.triangles.push_back({8, 3, 1});
      break;
    }
  }
  const Mesh bodies = joined(mesh, moved(mesh, {5, 0, 0}));
  const MeshReport found = report(bodies);
  EXPECT_EQ(found.boundary_edges, 6);
  EXPECT_EQ(found.boundary_loops, 2);
  EXPECT_NEAR(found.cap_share, 0, 1e-15);
  EXPECT_NEAR(found.volume, 2, 1e-12);
  EXPECT_EQ(found.method, SignMethod::winding);
  EXPECT_FALSE(found.sure);
}

// No triangle shares an edge with another one: the boundary is all edges, and its caps are all triangles.
TEST(MeshReport, BodiesOfLooseTriangles) {
  const Mesh bodies = joined(sphere(10), box({2, 2, 2}, {4, 5, 6}));
  const double volume = report(bodies).volume;
  for (const Mesh& mesh : {cracked(bodies, 1e-9, 1), cracked_floats(bodies, 2)}) {
    const MeshReport found = report(mesh);
    EXPECT_GT(found.boundary_edges, std::ssize(mesh.triangles) * 2);
    EXPECT_NEAR(found.cap_share, 1, 0.05);
    EXPECT_NEAR(found.openness, 0, 1e-4);
    EXPECT_NEAR(found.volume, volume, 1e-3);
    expect_method(mesh, SignMethod::winding, false, "its triangles fit together");
    expect_method(reversed(mesh), SignMethod::flood, false, "its gaps are cracks");
  }
  std::int64_t turned = 0;
  expect_method(cracked(randomly_turned(bodies, 1, turned), 1e-9, 1), SignMethod::flood, false, "its gaps are cracks");
  expect_method(cracked(terrain(), 1e-9, 1), SignMethod::none, false, "sheet");
  // Both sides of a sheet: beside it the winding number is an integer, but nothing is enclosed.
  const Mesh sides = joined(cracked(terrain(), 1e-9, 1), cracked(reversed(terrain()), 1e-9, 2));
  EXPECT_LT(report(sides).openness, 0.01);
  expect_method(sides, SignMethod::none, false, "sheet");
}

TEST(MeshReport, BodiesOfFacesThatAreCutOtherwise) {
  const MeshReport found = report(box_of_t_junctions({0, 0, 0}, {2, 1, 1}, 3));
  EXPECT_EQ(found.boundary_loops, 1);
  EXPECT_NEAR(found.cap_share, 0, 1e-12);
  EXPECT_NEAR(found.openness, 0, 1e-6);
  EXPECT_NEAR(found.volume, 2, 1e-12);
  EXPECT_EQ(found.method, SignMethod::winding);
}

TEST(MeshReport, DegenerateTrianglesAreCountedExactly) {
  Mesh mesh = box();
  add_triangle(mesh, {0, 0, 0}, {1, 1, 1}, {0, 0, 0});
  add_triangle(mesh, {0.1, 0.1, 0.3}, {0.2, 0.2, 0.6}, {0.4, 0.4, 1.2});    // exact multiples
  add_triangle(mesh, {0, 0, 0}, {1e8, 1e8, 0}, {1e8 + 1, 1e8 + 1, 1e-30});  // nearly flat
  add_triangle(mesh, {0, 0, 0}, {1e-60, 0, 0}, {0, 1e-60, 0});              // tiny
  EXPECT_EQ(report(mesh).degenerate, 2);
  Mesh points;
  add_triangle(points, {1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  expect_method(points, SignMethod::none, true, "no triangle has an area");
}

TEST(MeshReport, ListsTheLargestComponents) {
  Mesh mesh;
  for (int n = 0; n < 60; ++n) mesh = joined(mesh, moved(box(), {double(3 * n), 0, 0}, 1 + (n * 7 % 60) / 100.0));
  const MeshReport found = report(mesh, {.most_components = 5});
  EXPECT_EQ(found.component_count, 60);
  ASSERT_EQ(found.components.size(), 5u);
  for (std::size_t n = 0; n < 5; ++n)
    EXPECT_NEAR(found.components[n].area, 6 * std::pow(1.59 - 0.01 * double(n), 2), 1e-12);
  EXPECT_EQ(found.components[0].first_triangle, 12u * 17);  // 17 * 7 % 60 == 59
}

TEST(MeshReport, DoesNotDependOnOrderCornersOrThreads) {
  Mesh mesh = joined(box({-2, -2, -2}, {2, 2, 2}), reversed(torus()));
  mesh = without(with_flipped(joined(mesh, moved(klein_bottle(), {9, 0, 0})), 300), 400);
  const MeshReport expected = report(mesh);
  for (unsigned seed = 0; seed < 4; ++seed) {
    const MeshReport found = report(shuffled(mesh, seed), {.execution = {.threads = static_cast<int>(seed) + 1}});
    EXPECT_EQ(found.flipped, expected.flipped);
    EXPECT_EQ(found.boundary_edges, expected.boundary_edges);
    EXPECT_EQ(found.boundary_loops, expected.boundary_loops);
    EXPECT_EQ(found.component_count, expected.component_count);
    EXPECT_EQ(found.deepest, expected.deepest);
    EXPECT_EQ(found.intersecting_pairs, expected.intersecting_pairs);
    EXPECT_NEAR(found.volume, expected.volume, 1e-9);
    EXPECT_EQ(found.why, expected.why);
  }
}

TEST(MeshReport, InvalidInput) {
  const MeshReport empty = report(Mesh{});
  EXPECT_EQ(empty.method, SignMethod::none);
  EXPECT_EQ(empty.triangles, 0);
  EXPECT_FALSE(empty.closed());
  expect_error([] { report(box(), {.spacing = -1}); }, ErrorCode::usage, "spacing");
  expect_error([] { report(box(), {.most_components = -1}); }, ErrorCode::usage, "negative");
  expect_error([] { report(moved(box(), {}, 1e61)); }, ErrorCode::limit, "scale the mesh");
  Mesh wrong = box();
  wrong.triangles[3][1] = 99;
  expect_error([&] { report(wrong); }, ErrorCode::input, "triangle 3");
}

}  // namespace
}  // namespace standoff
