// SPDX-License-Identifier: Apache-2.0
// The boundary of a mesh: known loops, and for any triangles at all that the caps close the mesh.
#include "sign/diagnosis/boundary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "sign/diagnosis/closed.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;

Boundary boundary_of(const Mesh& mesh, std::span<const std::int8_t> use = {}) {
  return net_boundary({mesh, use}, MeshEdges(mesh));
}

std::vector<BoundaryPolygon> polygons_of(const Boundary& boundary) {
  std::vector<BoundaryPolygon> polygons;
  for_each_polygon(boundary, [&](BoundaryPolygon polygon) { polygons.push_back(std::move(polygon)); });
  return polygons;
}

// The mesh as it is used, with the caps of the loops, each to an apex of its own.
Mesh capped(const Mesh& mesh, std::span<const std::int8_t> use = {}) {
  Mesh all = mesh;
  all.triangles.clear();
  const OrientedMesh oriented{mesh, use};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (oriented.use_of(t) == 0) continue;
    const auto [a, b, c] = oriented.corners(t);
    add_triangle(all, a, b, c);
  }
  const Boundary boundary = boundary_of(mesh, use);
  for (std::size_t n = 0; n < boundary.loops(); ++n)
    for (const BoundaryEdge& edge : boundary.loop(n))
      for (int copy = 0; copy < edge.weight; ++copy) add_triangle(all, {double(n), 0.5, 100}, edge.to, edge.from);
  return all;
}

TEST(Boundary, OfClosedMeshesIsEmpty) {
  for (const Mesh& mesh : {sphere(), torus(), box(), joined(box(), box({1, 1, 0}, {2, 2, 1}))}) {
    const Boundary boundary = boundary_of(mesh);
    EXPECT_EQ(boundary.loops(), 0u);
    EXPECT_TRUE(boundary.edges.empty());
  }
}

TEST(Boundary, OfOneMissingTriangleRunsAlongItsSides) {
  const Mesh whole = sphere();
  const Boundary boundary = boundary_of(without(whole, 40));
  ASSERT_EQ(boundary.loops(), 1u);
  ASSERT_EQ(boundary.loop(0).size(), 3u);
  const auto corners = MeshView(whole).corners(40);
  double sides = 0, longest = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const double side = length(corners[(n + 1) % 3] - corners[n]);
    sides += side;
    longest = std::max(longest, side);
    // The neighbours use the side in the other direction.
    EXPECT_TRUE(std::ranges::any_of(boundary.edges, [&](const BoundaryEdge& edge) {
      return edge.from == corners[(n + 1) % 3] && edge.to == corners[n] && edge.weight == 1;
    }));
  }
  const auto [a, b, c] = corners;
  EXPECT_DOUBLE_EQ(length_of(boundary.loop(0)), sides);
  EXPECT_EQ(diameter_of(boundary.loop(0)), longest);
  const std::vector<BoundaryPolygon> polygons = polygons_of(boundary);
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_NEAR(cap_sums_of(polygons[0], {}).area, length(cross(b - a, c - a)) / 2, 1e-14);
  EXPECT_NEAR(cap_sums_of(polygons[0], {1, 2, 3}).volume, dot(a - Vec3{1, 2, 3}, cross(b - a, c - a)) / 6, 1e-14);
}

TEST(Boundary, OfAFlippedTriangleCountsTwice) {
  const Boundary boundary = boundary_of(with_flipped(sphere(), 40));
  ASSERT_EQ(boundary.edges.size(), 3u);
  for (const BoundaryEdge& edge : boundary.edges) EXPECT_EQ(edge.weight, 2);
}

TEST(Boundary, HolesApartAreLoopsApartAndHolesThatTouchAreOne) {
  const Mesh mesh = terrain(12);
  EXPECT_EQ(boundary_of(mesh).loops(), 1u);
  EXPECT_EQ(boundary_of(mesh).edges.size(), 48u);
  EXPECT_NEAR(diameter_of(boundary_of(mesh).loop(0)), 2 * std::sqrt(2), 0.01);
  const Mesh apart = without(mesh, 2 * (5 + 12 * 5));
  EXPECT_EQ(boundary_of(apart).loops(), 2u);
  EXPECT_EQ(boundary_of(without(apart, 2 * (9 + 12 * 9))).loops(), 3u);
  EXPECT_EQ(boundary_of(without(apart, 2 * (6 + 12 * 6))).loops(), 2u);  // they share a corner
}

TEST(Boundary, IsThatOfTheTrianglesAsTheyAreUsed) {
  const Mesh mesh = sphere();
  std::vector<std::int8_t> use(mesh.triangles.size(), 1);
  use[40] = 0;
  EXPECT_EQ(boundary_of(mesh, use).edges.size(), 3u);
  EXPECT_EQ(boundary_of(mesh, use).edges[0].weight, 1);
  use[40] = -1;
  EXPECT_EQ(boundary_of(mesh, use).edges[0].weight, 2);
  EXPECT_EQ(boundary_of(with_flipped(mesh, 40), use).loops(), 0u);
}

// Whichever edges meet at the corners of the box: each crack between two faces is a polygon by itself.
TEST(Boundary, PolygonsOfTJunctionsHaveNoArea) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Boundary boundary = boundary_of(shuffled(box_of_t_junctions({0, 0, 0}, {2, 1, 1}, 2), seed));
    EXPECT_EQ(boundary.loops(), 1u);
    double area = 0;
    for (const BoundaryPolygon& polygon : polygons_of(boundary)) area += cap_sums_of(polygon, {}).area;
    EXPECT_NEAR(area, 0, 1e-12);
  }
}

TEST(Boundary, PolygonsHaveNoRepeatedCornersAndAddUpToIt) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Mesh mesh = nasty_soup(seed, 60, 2);
    Mesh closed = mesh;
    for (BoundaryPolygon& polygon : polygons_of(boundary_of(mesh))) {
      const std::size_t size = polygon.corners.size();
      for (int copy = 0; copy < polygon.weight; ++copy)
        for (std::size_t n = 0; n < size; ++n)
          add_triangle(closed, {0.5, 0.5, 100}, polygon.corners[(n + 1) % size], polygon.corners[n]);
      std::ranges::sort(polygon.corners,
                        [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
      EXPECT_TRUE(std::ranges::adjacent_find(polygon.corners) == polygon.corners.end());
    }
    EXPECT_TRUE(is_closed(closed).oriented) << seed;
  }
}

TEST(Boundary, CapsCloseAnyTriangles) {
  Random random(7);
  for (unsigned seed = 0; seed < 30; ++seed) {
    const Mesh mesh = nasty_soup(seed, 60, 2);
    std::vector<std::int8_t> use;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      use.push_back(static_cast<std::int8_t>(random.below(3)) - 1);
    EXPECT_FALSE(is_closed(mesh).oriented);
    EXPECT_TRUE(is_closed(capped(mesh)).oriented) << seed;
    EXPECT_TRUE(is_closed(capped(mesh, use)).oriented) << seed;
  }
}

}  // namespace
}  // namespace standoff
