// SPDX-License-Identifier: Apache-2.0
// Orientation: known damage and its repair, what must be left alone, and what the result must not depend on.
#include "sign/diagnosis/orient.h"

#include <gtest/gtest.h>

#include "sign/diagnosis/closed.h"
#include "sign/oriented_mesh.h"
#include "tests/sign/cases/solids.h"
#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using namespace testing;

Orientation orient(const Mesh& mesh) { return standoff::orient(mesh, MeshEdges(mesh)); }

// The mesh as it is used.
Mesh applied(const Mesh& mesh, const Orientation& orientation) {
  Mesh result{mesh.vertices, {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int use = OrientedMesh{mesh, orientation.use}.use_of(t);
    if (use == 0) continue;
    result.triangles.push_back(mesh.triangles[t]);
    if (use < 0) std::swap(result.triangles.back()[1], result.triangles.back()[2]);
  }
  return result;
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = MeshView(mesh).corners(t);
    sum += dot(a, cross(b, c)) / 6;
  }
  return sum;
}

double surface_area(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = MeshView(mesh).corners(t);
    sum += length(cross(b - a, c - a)) / 2;
  }
  return sum;
}

void expect_unchanged(const Mesh& mesh) {
  const Orientation found = orient(mesh);
  EXPECT_TRUE(found.use.empty());
  EXPECT_EQ(found.flipped, 0);
  EXPECT_EQ(found.left_out, 0);
  EXPECT_EQ(found.boundary_edges, 0);
}

// A closed mesh of this volume, after so many flips.
void expect_repaired(const Mesh& mesh, double expected, std::int64_t flipped, std::int64_t left_out = 0) {
  const Orientation found = orient(mesh);
  EXPECT_EQ(found.flipped, flipped);
  EXPECT_EQ(found.left_out, left_out);
  EXPECT_EQ(found.boundary_edges, 0);
  EXPECT_EQ(found.inconsistent_after, 0);
  EXPECT_EQ(found.unorientable, 0);
  const Mesh result = applied(mesh, found);
  EXPECT_TRUE(is_closed(result).oriented);
  EXPECT_NEAR(volume(result), expected, 1e-12);
}

std::int64_t count(const Mesh& mesh) { return static_cast<std::int64_t>(mesh.triangles.size()); }

TEST(Orient, LeavesGoodMeshesAlone) {
  expect_unchanged(sphere());
  expect_unchanged(torus());
  expect_unchanged(box());
  EXPECT_GT(volume(sphere()), 0);
  EXPECT_GT(volume(torus()), 0);
  EXPECT_DOUBLE_EQ(volume(box()), 1);
}

TEST(Orient, OneFlippedTriangleIsOneFlip) {
  const Mesh mesh = with_flipped(sphere(), 40);
  EXPECT_EQ(orient(mesh).inconsistent_before, 3);
  expect_repaired(mesh, volume(sphere()), 1);
}

TEST(Orient, TheMajorityStays) {
  Mesh mesh = terrain();
  for (std::size_t t = 0; t < 100; ++t) mesh = with_flipped(mesh, t);
  EXPECT_EQ(orient(mesh).flipped, 100);
  EXPECT_EQ(orient(mesh).inconsistent_after, 0);
  EXPECT_EQ(orient(reversed(mesh)).flipped, 100);
}

TEST(Orient, InsideOutIsTurned) {
  expect_repaired(reversed(sphere()), volume(sphere()), count(sphere()));
  expect_repaired(with_flipped(reversed(sphere()), 40), volume(sphere()), count(sphere()) - 1);
  const Mesh far = joined(moved(sphere(), {1e7, 1e7, 0}), reversed(moved(sphere(), {-1e7, 1e7, 3}, 1e-2)));
  EXPECT_EQ(orient(far).flipped, count(sphere()));
}

TEST(Orient, ACavityStays) {
  const Mesh outer = box({-2, -2, -2}, {2, 2, 2}), mesh = joined(outer, reversed(torus()));
  expect_unchanged(mesh);
  expect_unchanged(joined(reversed(torus()), outer));
  expect_repaired(reversed(mesh), 64 - volume(torus()), count(mesh));
  expect_unchanged(joined(outer, torus()));  // a solid in a solid
  expect_repaired(joined(outer, with_flipped(reversed(torus()), 7)), 64 - volume(torus()), 1);
}

TEST(Orient, NestedShells) {
  Mesh alternate, equal;
  double expected_alternate = 0, expected_equal = 0;
  for (int n = 0; n < 5; ++n) {
    const double scale = 1 - 0.15 * n;
    const Mesh shell = moved(sphere(), {}, scale);
    alternate = joined(alternate, n % 2 == 0 ? shell : reversed(shell));
    equal = joined(equal, shell);
    expected_alternate += (n % 2 == 0 ? 1 : -1) * volume(shell);
    expected_equal += volume(shell);
  }
  expect_unchanged(alternate);
  expect_unchanged(equal);
  expect_repaired(reversed(alternate), expected_alternate, count(alternate));
  expect_repaired(reversed(equal), expected_equal, count(equal));
  // Inside out at even depth: no cavity.
  Mesh third = equal;
  const std::size_t one = sphere().triangles.size();
  for (std::size_t t = 2 * one; t < 3 * one; ++t) third = with_flipped(third, t);
  expect_repaired(third, expected_equal, count(sphere()));
}

TEST(Orient, ACavityStaysAlthoughTheSurfaceHasHoles) {
  Mesh mesh = joined(box({-2, -2, -2}, {2, 2, 2}), reversed(sphere()));
  mesh = without(without(mesh, 60), 100);
  EXPECT_TRUE(orient(mesh).use.empty());
  EXPECT_EQ(orient(mesh).boundary_edges, 6);
  EXPECT_EQ(orient(reversed(mesh)).flipped, count(mesh));
}

TEST(Orient, CopiesOfATriangleAreLeftOut) {
  for (const bool opposite : {false, true}) {
    const Mesh mesh = with_copy(sphere(), 40, opposite);
    expect_repaired(mesh, volume(sphere()), 0, 1);
    EXPECT_EQ(orient(mesh).same, opposite ? 0 : 1);
    EXPECT_EQ(orient(mesh).opposite, opposite ? 1 : 0);
    EXPECT_FALSE(orient(mesh).two_sided);
    expect_repaired(with_copy(with_flipped(sphere(), 40), 40, opposite), volume(sphere()), opposite ? 0 : 1, 1);
    expect_unchanged(with_copy(mesh, 40, !opposite));  // the two more cancel
  }
}

TEST(Orient, CopiesThatCloseTheSurfaceStay) {
  // A wall between two boxes, once for each: it cancels whether it is there or not.
  const Mesh touching = joined(box(), box({1, 0, 0}, {2, 1, 1}));
  EXPECT_EQ(orient(touching).opposite, 2);
  expect_unchanged(touching);
  expect_repaired(with_flipped(touching, 3), 2, 1, 4);
  // A solid listed twice is there twice.
  const Mesh twice = joined(sphere(), sphere());
  EXPECT_EQ(orient(twice).same, count(sphere()));
  expect_unchanged(twice);
  expect_repaired(reversed(twice), 2 * volume(sphere()), count(twice));
}

TEST(Orient, TwoSidedMeshesUseEachFaceOnce) {
  const Mesh mesh = joined(box(), reversed(box()));
  for (unsigned seed = 0; seed < 5; ++seed) {
    EXPECT_TRUE(orient(shuffled(mesh, seed)).two_sided);
    expect_repaired(shuffled(mesh, seed), 1, 0, 12);
  }
  const Mesh sheet = joined(terrain(), reversed(terrain()));
  const Orientation found = orient(sheet);
  EXPECT_TRUE(found.two_sided);
  EXPECT_EQ(found.left_out, count(terrain()));
  EXPECT_EQ(found.flipped, 0);
  EXPECT_EQ(found.patches, 1);
  EXPECT_EQ(found.inconsistent_after, 0);
  EXPECT_EQ(found.boundary_edges, 48);
}

// A chair: legs that have one side, a seat and a back that have two and lack a face. Seat and back are most of the
// area.
TEST(Orient, TwoSidedPartsThatAreBodiesAreUsedOnce) {
  const Mesh seat = without(box({0, 0, 1}, {2, 2, 2.5}), 0), back = without(box({0, 2.1, 1}, {2, 2.5, 4}), 0);
  Mesh legs;
  for (const double x : {0.1, 1.7}) legs = joined(std::move(legs), box({x, 0.1, 0}, {x + 0.2, 0.3, 0.9}));
  for (const bool welded : {false, true}) {
    const Mesh chair = joined(legs, joined(two_sided(seat, welded), two_sided(back, welded)));
    for (unsigned seed = 0; seed < 4; ++seed) {
      const Orientation found = orient(shuffled(chair, seed));
      EXPECT_FALSE(found.two_sided);
      EXPECT_EQ(found.opposite, count(seat) + count(back));
      EXPECT_EQ(found.left_out, count(seat) + count(back));
      EXPECT_EQ(found.cancelled_parts, 0);
      EXPECT_EQ(found.boundary_edges, 3 + 3);
      EXPECT_EQ(found.inconsistent_after, 0);
    }
  }
  // A pane is no body: nothing of it is used, and that is told.
  const Mesh pane = terrain(2);
  const Orientation found = orient(joined(legs, joined(two_sided(seat), two_sided(pane))));
  EXPECT_EQ(found.left_out, count(seat) + 2 * count(pane));
  EXPECT_EQ(found.cancelled_parts, 1);
  const double area = surface_area(pane);
  EXPECT_NEAR(found.cancelled_share, 2 * area / (2 * area + 2 * surface_area(seat) + surface_area(legs)), 1e-12);
  EXPECT_EQ(found.boundary_edges, 3);
  // Neither is a tube without ends, though its normals cancel.
  Mesh tube = box();
  std::erase_if(tube.triangles, [&](const Triangle& t) {
    const double z = tube.vertices[t[0]].z;
    return tube.vertices[t[1]].z == z && tube.vertices[t[2]].z == z;
  });
  EXPECT_EQ(orient(joined(legs, two_sided(tube))).cancelled_parts, 1);
}

TEST(Orient, AnOpenTwoSidedPartOfAClosedMeshCancels) {
  const Mesh window = joined(terrain(), reversed(terrain()));
  const Mesh mesh = joined(moved(sphere(64), {0, 0, 9}), window);
  const Orientation found = orient(mesh);
  EXPECT_FALSE(found.two_sided);
  EXPECT_EQ(found.opposite, count(terrain()));
  EXPECT_EQ(found.cancelled_parts, 1);
  EXPECT_TRUE(found.use.empty());
  EXPECT_EQ(found.boundary_edges, 0);
  EXPECT_EQ(orient(with_flipped(mesh, 3)).left_out, count(window));
}

TEST(Orient, UnorientableMeshesStay) {
  for (const Mesh& mesh : {moebius(), klein_bottle()}) {
    const Orientation found = orient(mesh);
    EXPECT_EQ(found.unorientable, 1);
    EXPECT_TRUE(found.use.empty());
    EXPECT_GT(found.inconsistent_before, 0);
    EXPECT_EQ(found.inconsistent_after, found.inconsistent_before);
  }
  EXPECT_TRUE(is_closed(klein_bottle()).unoriented);
}

TEST(Orient, SheetsStay) {
  for (const Mesh& mesh : {terrain(), reversed(terrain())}) {
    EXPECT_TRUE(orient(mesh).use.empty());
    EXPECT_EQ(orient(mesh).boundary_edges, 48);
    EXPECT_EQ(orient(mesh).patches, 1);
  }
}

TEST(Orient, NonmanifoldEdges) {
  // Two boxes that share an edge are turned one by one.
  const Mesh other = box({1, 1, 0}, {2, 2, 1});
  expect_unchanged(joined(box(), other));
  EXPECT_EQ(orient(joined(box(), other)).patches, 2);
  expect_repaired(joined(box(), reversed(other)), 2, 12);
  // A box of two halves that meet at four edges with a wall between them that is there once: the wall is left out.
  Mesh halves = joined(box(), box({1, 0, 0}, {2, 1, 1}));
  halves.triangles.erase(halves.triangles.begin() + 10, halves.triangles.begin() + 12);
  EXPECT_EQ(orient(halves).patches, 3);
  EXPECT_EQ(orient(halves).walls, 2);
  expect_repaired(halves, 2, 0, 2);
}

// A double cone, its apexes at x = -height and x = height: two patches if it is cut at its rim, the unit circle.
Mesh cones(double height, bool turn_left, bool turn_right) {
  Mesh mesh;
  const auto rim = [](int n) { return Vec3{0, std::cos(kTurn * (n % 16) / 16), std::sin(kTurn * (n % 16) / 16)}; };
  for (int n = 0; n < 16; ++n) {
    const Vec3 a = rim(n), b = rim(n + 1);
    add_triangle(mesh, turn_left ? a : b, turn_left ? b : a, {-height, 0, 0});
    add_triangle(mesh, turn_right ? b : a, turn_right ? a : b, {height, 0, 0});
  }
  return mesh;
}

TEST(Orient, PatchesAreTurnedUntilTheirBordersCancel) {
  // Double cones with one rim: 2 n sheets meet there.
  for (int turned = 0; turned < 64; ++turned) {
    const Mesh mesh = joined(joined(cones(1, turned & 1, turned & 2), cones(2, turned & 4, turned & 8)),
                             cones(4, turned & 16, turned & 32));
    const Orientation found = orient(mesh);
    EXPECT_EQ(found.patches, 6);
    EXPECT_EQ(found.boundary_edges, 0) << turned;
    EXPECT_GT(volume(applied(mesh, found)), 0) << turned;
  }
  const Mesh three = joined(cones(1, false, true), cones(2, true, true));
  EXPECT_EQ(orient(three).boundary_edges, 0);
}

TEST(Orient, DegenerateTrianglesDisturbNothing) {
  Mesh mesh = sphere();
  for (std::uint32_t t = 0; t < 50; t += 5) {
    const Triangle corners = mesh.triangles[t];
    mesh.triangles.push_back({corners[0], corners[1], corners[0]});
    mesh.triangles.push_back({corners[2], corners[2], corners[2]});
  }
  expect_unchanged(mesh);
  EXPECT_EQ(orient(mesh).patches, 1);
  expect_repaired(with_flipped(mesh, 40), volume(sphere()), 1);
}

TEST(Orient, DoesNotDependOnOrderCornersOrASecondTime) {
  Mesh damaged = joined(box({-2, -2, -2}, {2, 2, 2}), reversed(torus()));
  damaged = joined(joined(damaged, moved(sphere(), {9, 0, 0})), moved(klein_bottle(), {0, 90, 0}));
  damaged = joined(joined(damaged, moved(box(), {50, 0, 0})), reversed(moved(box(), {51, 1, 0})));
  for (const std::size_t t : {3u, 100u, 250u, 700u}) damaged = with_flipped(damaged, t);
  damaged = with_copy(with_copy(damaged, 33, true), 200, false);
  damaged = without(damaged, 77);
  const Orientation expected = orient(damaged);
  EXPECT_GT(expected.flipped, 3);
  EXPECT_EQ(expected.unorientable, 1);
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Mesh mesh = shuffled(damaged, seed);
    const Orientation found = orient(mesh);
    EXPECT_EQ(found.flipped, expected.flipped);
    EXPECT_EQ(found.left_out, expected.left_out);
    EXPECT_EQ(found.patches, expected.patches);
    EXPECT_EQ(found.boundary_edges, expected.boundary_edges);
    EXPECT_EQ(found.inconsistent_after, expected.inconsistent_after);
    EXPECT_NEAR(volume(applied(mesh, found)), volume(applied(damaged, expected)), 1e-9);
    EXPECT_TRUE(orient(applied(mesh, found)).use.empty());
  }
}

TEST(Orient, OfClosedMeshesDoesNotDependOnTheirOrientation) {
  Random random(3);
  for (int n = 0; n < 20; ++n) {
    Mesh mesh;
    for (int part = 0; part < 12; ++part) {
      const Mesh ball = moved(sphere(4), random.in_cube(1), random.between(0.05, 2));
      mesh = joined(mesh, random.below(2) == 0 ? ball : reversed(ball));
    }
    const Mesh one = applied(mesh, orient(mesh)), other = applied(reversed(mesh), orient(reversed(mesh)));
    EXPECT_EQ(one.triangles.size(), mesh.triangles.size());
    std::int64_t different = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto a = MeshView(one).corners(t), b = MeshView(other).corners(t);
      different += dot(cross(a[1] - a[0], a[2] - a[0]), cross(b[1] - b[0], b[2] - b[0])) < 0;
    }
    EXPECT_EQ(different, 0);
    EXPECT_TRUE(orient(one).use.empty());
  }
}

TEST(Orient, AnyTrianglesAtAll) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Mesh mesh = nasty_soup(seed, 80, 1.5);
    const Orientation found = orient(mesh);
    EXPECT_EQ(found.inconsistent_after > 0, found.unorientable > 0);
    EXPECT_LE(found.flipped + found.left_out, count(mesh));
    EXPECT_TRUE(found.use.empty() || found.use.size() == mesh.triangles.size());
  }
}

TEST(Orient, ManyParts) {
  Mesh mesh;
  for (int n = 0; n < 3000; ++n) {
    const Mesh part = moved(box(), {double(n % 60) * 2, double(n / 60) * 2, 0});
    append(mesh, n % 3 == 0 ? reversed(part) : part);
  }
  EXPECT_EQ(orient(mesh).flipped, 1000 * 12);
  EXPECT_EQ(orient(mesh).patches, 3000);
}

}  // namespace
}  // namespace standoff
