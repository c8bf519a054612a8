// SPDX-License-Identifier: Apache-2.0
#include "batch/normalize.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_code.h"

namespace standoff::testing {
namespace {

Mesh triangle(Vec3 a, Vec3 b, Vec3 c) { return {{a, b, c, {1e9, 0, 0}}, {{0, 1, 2}}}; }

TEST(Normalize, UnitCube) {
  Mesh mesh = triangle({1, 2, 3}, {5, 2, 3}, {1, 4, 3});  // a vertex that no triangle has does not count
  const Similarity found = normalization(mesh, Normalization::unit_cube);
  EXPECT_EQ(found.center, (Vec3{3, 3, 3}));
  EXPECT_EQ(found.scale, 0.25);
  apply(found, mesh);
  EXPECT_EQ(mesh.vertices[0], (Vec3{-0.5, -0.25, 0}));
  EXPECT_EQ(mesh.vertices[1], (Vec3{0.5, -0.25, 0}));
}

TEST(Normalize, UnitSphereReachesTheFarthestCorner) {
  const Mesh mesh = triangle({-3, 0, 0}, {3, 0, 0}, {0, 4, 0});
  const Similarity found = normalization(mesh, Normalization::unit_sphere);
  EXPECT_EQ(found.center, (Vec3{0, 2, 0}));
  EXPECT_DOUBLE_EQ(found.scale, 1 / std::sqrt(13.0));  // not 1 / 2, of the one farthest along an axis
}

TEST(Normalize, NoneMovesNothing) {
  Mesh mesh = triangle({1, 2, 3}, {5, 2, 3}, {1, 4, 3});
  const auto before = mesh.vertices;
  apply(normalization(mesh, Normalization::none), mesh);
  EXPECT_EQ(mesh.vertices, before);
}

TEST(Normalize, RefusesWhatNoScaleBringsToOne) {
  for (const auto kind : {Normalization::unit_cube, Normalization::unit_sphere}) {
    EXPECT_EQ(code_of([&] { normalization(triangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1}), kind); }), ErrorCode::input);
    EXPECT_EQ(code_of([&] { normalization(triangle({0, 0, 0}, {1e-320, 0, 0}, {0, 0, 0}), kind); }), ErrorCode::input);
    EXPECT_EQ(code_of([&] {
                normalization(triangle({-1e308, 0, 0}, {1e308, 0, 0}, {0, 0, 0}), kind);
              }),
              ErrorCode::input);
  }
}

}  // namespace
}  // namespace standoff::testing
