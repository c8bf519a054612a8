// SPDX-License-Identifier: Apache-2.0
// If mesh and grid are so far apart, or spacings so uneven, that squared distances do not fit into float, both methods
// report an error. Once there were fields of infinities, an endless loop and a crash.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "standoff/compute.h"
#include "tests/support/expect_error.h"

namespace standoff {
namespace {

Mesh triangle_at(double x, double size = 1) { return {{{x, 0, 0}, {x + size, 0, 0}, {x, size, 0}}, {{0, 1, 2}}}; }

void expect_limit(const Mesh& mesh, const Grid& grid, const char* says) {
  for (const Method method : {Method::tiles, Method::thesis})
    for (const double thickness : {2 * grid.max_spacing(), std::numeric_limits<double>::infinity()})
      expect_error([&] { compute(mesh, grid, thickness, {.method = method, .sign = {SignMethod::none}}); },
                   ErrorCode::limit, says);
}

TEST(Domain, AMeshBeyondTheSquaresOfFloat) {
  const Grid grid{{8, 8, 8}, {0, 0, 0}, {1, 1, 1}};
  expect_limit(triangle_at(1e20), grid, "triangle 0 is farther than 2^60 spacings");
  Mesh both = triangle_at(0);
  both.vertices.push_back({1e100, 0, 0});
  both.triangles.push_back({0, 1, 3});
  expect_limit(both, grid, "triangle 1 is farther");
}

TEST(Domain, SpacingsThatFloatDoesNotHave) {
  for (const double h : {1e-320, 1e-40, 1e35}) {
    const Grid grid{{4, 4, 4}, {0, 0, 0}, {h, h, h}};
    expect_limit(triangle_at(0, h), grid, "the spacing is");
  }
}

TEST(Domain, UnevenSpacings) {
  expect_limit(triangle_at(0), {{4, 4, 4}, {0, 0, 0}, {1e-320, 1, 1}}, "one spacing is less");
}

TEST(Domain, WhatIsJustWithinIsComputed) {
  const double far = 0x1p59;
  const Grid grid{{4, 4, 4}, {0, 0, 0}, {1, 1, 1}};
  const float value = compute(triangle_at(far), grid, kFullField, {.sign = {SignMethod::none}}).field.value(0, 0, 0);
  EXPECT_NEAR(value, far, 1e-6 * far);
  const Grid tiny{{4, 4, 4}, {0, 0, 0}, {0x1p-109, 0x1p-109, 0x1p-109}};
  EXPECT_NEAR(
      compute(triangle_at(0, 0x1p-109), tiny, kFullField, {.sign = {SignMethod::none}}).field.value(0, 0, 3) / 0x1p-109,
      3, 1e-5);
}

}  // namespace
}  // namespace standoff
