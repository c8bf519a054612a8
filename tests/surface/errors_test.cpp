// SPDX-License-Identifier: Apache-2.0
// What no surface is made of, and what is said then.
#include <gtest/gtest.h>

#include <limits>

#include "standoff/surface.h"
#include "tests/support/expect_error.h"
#include "tests/surface/manifold.h"
#include "tests/surface/random_field.h"

namespace standoff {
namespace {

using namespace testing;

const Grid kGrid{{20, 9, 9}, {}, {1, 1, 1}};

TEST(SurfaceErrors, ValuesThatAreNotNumbersAreNamed) {
  DistanceField field = field_of(kGrid, [](Vec3 p) { return p.x - 4; });
  field.edit_tile(1, 1, 0)[5 + 8 * (0 + 8 * 3)] = std::numeric_limits<float>::quiet_NaN();
  field.edit_tile(2, 1, 1)[0] = std::numeric_limits<float>::quiet_NaN();
  for (const SurfaceMethod method : {SurfaceMethod::marching_cubes, SurfaceMethod::dual})
    expect_error([&] { surface(field, {.method = method}); }, ErrorCode::input, "sample (13,8,3) is not a number");
}

TEST(SurfaceErrors, ValuesBeyondTheThickness) {
  const DistanceField field(kGrid, 2);
  for (const double at : {2.0, -2.0, 5.0})
    expect_error([&] { surface(field, {.at = at}); }, ErrorCode::usage, "compute the field with a larger thickness");
  expect_error([&] { surface(field, {.at = -0.5, .wall = 1.5}); }, ErrorCode::usage, "larger thickness");
  EXPECT_NO_THROW(surface(field, {.at = 1.999}));
}

TEST(SurfaceErrors, GridsTooFarOut) {
  const auto field = [](double far) {
    return field_of({{5, 5, 5}, {far, 0, 0}, {1, 1, 1}}, [&](Vec3 p) { return p.y - 2; });
  };
  EXPECT_EQ(surface(field(1e3)).report.floats, true);
  EXPECT_EQ(surface(field(1e6)).report.floats, false);
  EXPECT_EQ(manifold_fault(surface(field(1e12)).mesh), "");
  expect_error([&] { surface(field(1e15)); }, ErrorCode::limit, "too far to tell its vertices apart");
  expect_error([&] { surface(field(1e7), {.coordinates = Coordinates::single}); }, ErrorCode::limit,
               "32-bit floats do not tell vertices apart");
  // What is asked for in floats are floats.
  const SurfaceResult single = surface(field(3e4), {.coordinates = Coordinates::single});
  EXPECT_EQ(manifold_fault(single.mesh), "");
  for (const Vec3& v : single.mesh.vertices) {
    EXPECT_EQ(v.x, static_cast<double>(static_cast<float>(v.x)));
    EXPECT_EQ(v.y, static_cast<double>(static_cast<float>(v.y)));
  }
}

TEST(SurfaceErrors, Walls) {
  const Grid grid{{20, 20, 20}, {}, {1, 1, 1}};
  const DistanceField ball = field_of(grid, [](Vec3 p) { return length(p - Vec3{9, 9, 9}) - 7; });
  expect_error([&] { surface(ball, {.wall = 0.5}); }, ErrorCode::usage, "is thinner than the spacing");
  EXPECT_EQ(manifold_fault(surface(ball, {.wall = 1}).mesh), "");
  const DistanceField half = field_of(grid, [](Vec3 p) { return p.x - 4; });
  expect_error([&] { surface(half, {.wall = 2}); }, ErrorCode::usage, "the hollow reaches the border of the grid");
}

TEST(SurfaceErrors, CancelledWork) {
  const DistanceField field = field_of({{20, 20, 20}, {}, {1, 1, 1}}, [](Vec3 p) {
    return length(p - Vec3{9, 9, 9}) - 7;
  });
  double last = 0;
  const SurfaceOptions watched{.wall = 2, .progress = [&](const Progress& progress) {
                                 EXPECT_GE(progress.fraction, last);
                                 last = progress.fraction;
                                 return true;
                               }};
  surface(field, watched);
  EXPECT_EQ(last, 1);
  expect_error([&] { surface(field, {.progress = [](const Progress&) { return false; }}); }, ErrorCode::interrupted,
               "cancelled");
  struct Own {};
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const double from : {0.0, 0.7}) {
    const SurfaceOptions throws{.at = 0.2, .progress = [=](const Progress& progress) -> bool {
                                  if (progress.fraction >= from) throw Own();
                                  return true;
                                }};
    EXPECT_THROW(surface(mesh, fit_resolution(bounds(mesh).grown(0.2), 20), throws), Own);
  }
}

}  // namespace
}  // namespace standoff
