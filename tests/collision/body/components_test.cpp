// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "collision/body/body.h"
#include "tests/collision/solids.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using Firsts = std::vector<std::uint32_t>;

Firsts first_of_components(MeshView mesh) {
  ProgressMeter nobody;
  return collision::first_of_components(mesh, nobody);
}

TEST(Components, AreConnectedByPositions) {
  const Mesh ball = ball_mesh(1, 4), loose = random_soup(1, 5, 1, 0.1);  // of the ball no vertex is shared
  const auto triangles = static_cast<std::uint32_t>(ball.triangles.size());
  EXPECT_EQ(first_of_components(ball), Firsts{0});
  EXPECT_EQ(first_of_components(loose), (Firsts{0, 1, 2, 3, 4}));
  EXPECT_EQ(first_of_components(joined({ball, ball_mesh(0.5, 2), loose})),
            (Firsts{0, triangles, triangles + 32, triangles + 33, triangles + 34, triangles + 35, triangles + 36}));
}

// Triangles that a later one connects, by a single corner, by zeros of both signs, and degenerate ones.
TEST(Components, AreFoundInAnyOrder) {
  Mesh mesh = one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_triangle(mesh, {5, 0, 0}, {6, 0, 0}, {5, 1, 0});
  add_triangle(mesh, {9, 9, 9}, {9, 9, 9}, {9, 9, 9});
  EXPECT_EQ(first_of_components(mesh), (Firsts{0, 1, 2}));
  add_triangle(mesh, {-0.0, 0, -0.0}, {5, 0, 0}, {5, 0, 0});
  EXPECT_EQ(first_of_components(mesh), (Firsts{0, 2}));
  add_triangle(mesh, {9, 9, 9}, {9, 8, 9}, {0, 1, 0});
  EXPECT_EQ(first_of_components(mesh), Firsts{0});
  mesh.vertices.push_back({std::nan(""), 0, 0});  // no triangle uses it
  EXPECT_EQ(first_of_components(mesh), Firsts{0});
}

}  // namespace
}  // namespace standoff
