// SPDX-License-Identifier: Apache-2.0
// The kinds of meshes that people have: for each a small one with the same defects, made by code, and what must be
// found out about it. Public meshes with these defects are named beside them; none is needed to run this.
#include <gtest/gtest.h>

#include <functional>

#include "standoff/mesh_report.h"
#include "tests/sign/cases/known_sides.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;  // NOLINT: a test of what that folder has

struct Kind {
  const char* name;
  Mesh mesh;
  std::function<Side(Vec3)> known;  // by the method that automatic should take
  SignMethod method;
  bool sure;  // whether there is no doubt; else the report may see some
  // What report() finds; -1: not said here.
  struct Found {
    std::int64_t components = -1, boundary_edges = -1, nonmanifold = -1, inconsistent = -1, flipped = -1;
    std::int64_t same = 0, opposite = 0, degenerate = 0;
  } found;
};

// Trimesh's multibody.stl, Thingi10K 88566: bodies apart.
Kind many_bodies() {
  Mesh mesh;
  std::vector<Convex> known;
  for (int n = 0; n < 7; ++n) {
    const Mesh one =
        moved(n % 2 == 0 ? sphere(4) : box({-1, -1, -1}, {1, 1, 1}), {2.5 * (n % 3), 2.5 * (n / 3), 0.3 * n});
    known.emplace_back(one);
    mesh = joined(std::move(mesh), one);
  }
  return {"many bodies",
          shuffled(mesh, 1),
          [=](Vec3 p) { return in_any(known, p); },
          SignMethod::winding,
          true,
          {.components = 7, .boundary_edges = 0, .nonmanifold = 0, .inconsistent = 0, .flipped = 0}};
}

// Manifold's Offset1.obj: parts that touch along an edge.
Kind touching_along_an_edge() {
  const Mesh a = box(), b = box({1, 1, 0}, {2, 2, 1});
  const std::vector<Convex> known{Convex(a), Convex(b)};
  return {"parts that touch along an edge",
          joined(a, b),
          [=](Vec3 p) { return in_any(known, p); },
          SignMethod::winding,
          true,
          {.components = 1, .boundary_edges = 0, .nonmanifold = 1, .inconsistent = 0, .flipped = 0}};
}

// Manifold's openscad-nonmanifold-crash.obj: duplicates, winding numbers up to 3.
Kind three_of_the_same() {
  const Mesh one = box();
  return {"the same box three times",
          joined(joined(one, one), one),
          Convex(one),
          SignMethod::winding,
          true,
          {.boundary_edges = 0, .nonmanifold = 18, .flipped = 0, .same = 24}};
}

// Trimesh's featuretype.STL: closed to the eye; vertices lie within the edges of neighbours.
Kind t_junctions() {
  const Mesh mesh = box_of_t_junctions({0, 0, 0}, {2, 1, 1}, 2);
  // Along each of the twelve edges of the box meet faces of 2 and 4, 2 and 6, 4 and 6 edges.
  return {"T-junctions",
          mesh,
          Convex(box({0, 0, 0}, {2, 1, 1})),
          SignMethod::winding,
          false,
          {.boundary_edges = 4 * (6 + 8 + 10), .nonmanifold = 0, .inconsistent = 0, .flipped = 0}};
}

// Trimesh's chair_model.obj: every face twice, opposed.
Kind two_sided_box() {
  const Mesh one = box({0, 0, 0}, {1, 2, 3});
  return {"two-sided", shuffled(two_sided(one), 3),          Convex(one), SignMethod::winding,
          false,       {.boundary_edges = 0, .opposite = 12}};
}

Kind two_sided_ball() {
  const Mesh one = sphere(6);
  return {"two-sided", two_sided(one, true),
          Convex(one), SignMethod::winding,
          false,       {.boundary_edges = 0, .opposite = 120}};
}

// Trimesh's multibody.stl, ManifoldPlus's table.off: neighbours that look opposite ways.
Kind one_flipped() {
  const Mesh ball = sphere(6);
  return {"one triangle flipped",
          with_flipped(ball, 50),
          Convex(ball),
          SignMethod::winding,
          true,
          {.components = 1, .boundary_edges = 0, .nonmanifold = 0, .inconsistent = 3, .flipped = 1}};
}

// Trimesh's joined_tetrahedra.obj: a wall between two rooms.
Kind shared_face() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, -1}, {0.3, 0.3, 1}};
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 0, 4}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}};
  const Convex known(mesh);
  mesh.triangles.push_back({0, 1, 2});
  return {"a shared face", mesh,
          known,           SignMethod::winding,
          false,           {.components = 1, .boundary_edges = 0, .nonmanifold = 3, .inconsistent = 0, .flipped = 0}};
}

// libigl's cube_with_fold.ply: a fin without thickness.
Kind folded_fin() {
  const Mesh one = box();
  Mesh mesh = one;
  mesh.vertices.push_back({0.5, -0.5, -0.5});
  mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 8}, {1, 0, 8}});
  return {"a fin",     mesh,
          Convex(one), SignMethod::winding,
          true,        {.components = 1, .boundary_edges = 0, .nonmanifold = 1, .flipped = 0, .opposite = 1}};
}

// Trimesh's soup.stl: loose triangles.
Kind loose_triangles() {
  return {"loose triangles",
          random_soup(4, 100, 1, 0.1),
          nowhere,
          SignMethod::none,
          false,
          {.components = 100, .boundary_edges = 300, .nonmanifold = 0, .inconsistent = 0}};
}

// common-3d-test-models' alligator.obj and woody.obj: flat. Gpytoolbox's mountain.obj: a sheet.
Kind flat_sheet() {
  return {"a flat sheet", terrain(8, 0),
          nowhere,        SignMethod::none,
          false,          {.components = 1, .boundary_edges = 32, .nonmanifold = 0, .inconsistent = 0}};
}
Kind hilly_sheet() {
  return {"terrain", terrain(8, 0.2),
          nowhere,   SignMethod::none,
          false,     {.components = 1, .boundary_edges = 32, .nonmanifold = 0, .inconsistent = 0}};
}

// libigl's truck.obj: negative volume.
Kind inside_out() {
  const Mesh ring = torus();
  return {"inside out",
          reversed(ring),
          RoundTorus(24, 12, 1, 0.3),
          SignMethod::winding,
          true,
          {.components = 1,
           .boundary_edges = 0,
           .nonmanifold = 0,
           .inconsistent = 0,
           .flipped = std::ssize(ring.triangles)}};
}

// ManifoldPlus's bathtub.obj: triangles without area.
Kind degenerate() {
  Mesh mesh = sphere(6);
  const Convex known(mesh);
  mesh.triangles.insert(mesh.triangles.end(), {{20, 20, 20}, {20, 21, 20}, {30, 30, 31}});
  return {"triangles without area", mesh, known,
          SignMethod::winding,      true, {.boundary_edges = 0, .flipped = 0, .degenerate = 3}};
}

// common-3d-test-models' stanford-bunny.obj: a body with a few holes.
Kind few_holes() {
  const Mesh ball = sphere(12);
  return {"a few holes", without(without(without(ball, 300), 200), 100),
          Convex(ball),  SignMethod::winding,
          false,         {.components = 1, .boundary_edges = 9, .nonmanifold = 0, .inconsistent = 0, .flipped = 0}};
}

// Manifold's openscad-nonmanifold-crash.obj: a closed surface that winds the other way about a part of what it
// encloses.
Kind figure_of_eight() {
  const auto in_left_lobe = [](Vec3 p) {
    return side_of(p.z > 0 && p.z < 1 && p.x > -3 && std::abs(p.y) < -2 * p.x / 3);
  };
  return {"a figure of eight",
          prism({{-3, -2}, {1.5, 1}, {1.5, -1}, {-3, 2}}),
          in_left_lobe,
          SignMethod::winding,
          false,
          {.components = 1, .boundary_edges = 0, .inconsistent = 0, .flipped = 0, .degenerate = -1}};
}

void expect_found(const Kind& kind, const MeshReport& found) {
  const auto expect = [&](std::int64_t expected, std::int64_t actual, const char* what) {
    EXPECT_TRUE(expected < 0 || actual == expected) << actual << ' ' << what << ", expected " << expected;
  };
  EXPECT_EQ(found.triangles, std::ssize(kind.mesh.triangles));
  expect(kind.found.components, found.component_count, "components");
  expect(kind.found.boundary_edges, found.boundary_edges, "boundary edges");
  expect(kind.found.nonmanifold, found.nonmanifold_edges, "nonmanifold edges");
  expect(kind.found.inconsistent, found.inconsistent_edges, "inconsistent edges");
  expect(kind.found.flipped, found.flipped, "flipped");
  expect(kind.found.same, found.duplicate_same, "duplicates of the same orientation");
  expect(kind.found.opposite, found.duplicate_opposite, "duplicates of opposite orientation");
  expect(kind.found.degenerate, found.degenerate, "degenerate triangles");
  EXPECT_EQ(found.two_sided, std::string(kind.name) == "two-sided");
  EXPECT_EQ(found.method, kind.method) << name_of(found.method) << ": " << found.why;
  EXPECT_FALSE(found.why.empty());
}

TEST(SignCorpus, WhatIsFoundOutAndWhatIsInside) {
  for (const Kind& kind : {many_bodies(), touching_along_an_edge(), three_of_the_same(), t_junctions(), two_sided_box(),
                           two_sided_ball(), one_flipped(), shared_face(), folded_fin(), loose_triangles(),
                           flat_sheet(), hilly_sheet(), inside_out(), degenerate(), few_holes(), figure_of_eight()}) {
    SCOPED_TRACE(kind.name);
    const MeshReport found = report(kind.mesh);
    expect_found(kind, found);
    const Grid grid = grid_around(kind.mesh, 18);
    SignOptions sign{.method = SignMethod::automatic};
    const SignReport used = expect_sides(kind.mesh, grid, sign, kind.known);
    EXPECT_EQ(used.method, kind.method) << name_of(used.method) << ": " << used.why;
    EXPECT_EQ(used.sure, found.sure) << "as used: " << used.why << "; as reported: " << found.why;
    EXPECT_TRUE(used.sure || !kind.sure) << used.why;
    EXPECT_TRUE(!used.sure || kind.method != SignMethod::none) << used.why;
    // Strict is an error exactly where the report is not sure.
    sign.strict = true;
    bool doubted = false;
    try {
      compute(kind.mesh, grid, 1, {.sign = sign});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::doubt) << error.what();
      doubted = true;
    }
    EXPECT_EQ(doubted, !used.sure) << used.why;
  }
}

// However triangles and their corners are ordered, the same is found.
TEST(SignCorpus, TheOrderOfTrianglesDoesNotMatter) {
  for (const Kind& kind : {many_bodies(), t_junctions(), two_sided_box(), one_flipped(), shared_face(), few_holes()}) {
    SCOPED_TRACE(kind.name);
    const Grid grid = grid_around(kind.mesh, 14);
    const SignOptions sign{.method = SignMethod::automatic};
    const Occupancy first = occupancy(kind.mesh, grid, {.sign = sign});
    for (unsigned seed = 0; seed < 4; ++seed) {
      const Occupancy other = occupancy(shuffled(kind.mesh, seed), grid, {.sign = sign});
      EXPECT_TRUE(first.bits == other.bits) << seed;
      EXPECT_EQ(first.sign.method, other.sign.method) << seed;
      EXPECT_EQ(first.sign.sure, other.sign.sure) << seed;
      EXPECT_EQ(first.sign.boundary_edges, other.sign.boundary_edges) << seed;
    }
  }
}

}  // namespace
}  // namespace standoff
