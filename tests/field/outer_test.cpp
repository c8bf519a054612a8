// SPDX-License-Identifier: Apache-2.0
// Fields of the union of all parts: SignOptions::outer.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "standoff/compute.h"
#include "standoff/exposed.h"
#include "standoff/verify.h"
#include "tests/sign/fine_box.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"

namespace standoff {
namespace {

using namespace testing;

constexpr SignOptions kAll{.method = SignMethod::winding, .as_oriented = true};
constexpr SignOptions kOuter{.method = SignMethod::winding, .as_oriented = true, .outer = true};

ComputeResult field_of(const Mesh& mesh, const Grid& grid, const SignOptions& sign, double thickness = kFullField) {
  return compute(mesh, grid, thickness, {.sign = sign, .nearest = true});
}

Grid around(const Mesh& mesh, std::int64_t samples) {
  const Box box = bounds(mesh).grown(0.21);
  const double spacing = box.longest_side() / double(samples - 1);
  const auto along = [&](double side) { return static_cast<std::int64_t>(side / spacing) + 1; };
  const Vec3 e = box.extent();
  return {{along(e.x), along(e.y), along(e.z)}, box.min, {spacing, spacing, spacing}};
}

bool same_bits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

// Outside, values do not change, except by rounding if a sample's nearest point is also on the edge of an internal
// triangle; `bits`: there are none, so bits are equal. Inside, values move away from 0. Returns how many values
// changed.
int compare_with_all(const Mesh& mesh, const Grid& grid, bool bits, double thickness = kFullField) {
  const DistanceField all = field_of(mesh, grid, kAll, thickness).field,
                      outer = field_of(mesh, grid, kOuter, thickness).field;
  const std::vector<Exposure> exposure = exposed_triangles(mesh, {.sign = kAll}).of;
  int changed = 0, wrong = 0;
  for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const float before = all.value(i, j, k), after = outer.value(i, j, k);
    const double rounding = allowed_error(grid, std::abs(before));
    const std::uint32_t nearest = outer.nearest(i, j, k);
    if (before > 0)
      wrong += bits ? !same_bits(before, after) : !(std::abs(before - after) <= rounding);
    else
      wrong += !(after <= before + rounding);
    wrong += nearest != kNoTriangle && exposure[nearest] == Exposure::internal;
    changed += std::abs(before - after) > rounding;
  });
  EXPECT_EQ(wrong, 0);
  const VerifyResult verified = verify(outer, mesh, {.samples = 300});
  EXPECT_TRUE(verified.ok());
  EXPECT_GT(verified.sign.checked, 0);
  return changed;
}

// Distance to a box; a flat one is a rectangle.
double distance_to(const Box& box, const Vec3& p) { return length(max(max(box.min - p, p - box.max), Vec3{})); }

TEST(Outer, ASolidInASolidIsAsIfItWereNotThere) {
  const Mesh hull = moved(sphere(12), {}, 2),
             mesh = joined(joined(moved(torus(), {0.3, 0, 0}), hull), moved(sphere(5), {}, 0.5));
  const Grid grid = around(mesh, 30);
  for (const double thickness : {kFullField, 0.4}) {
    const ComputeResult outer = field_of(mesh, grid, kOuter, thickness), alone = field_of(hull, grid, kAll, thickness);
    EXPECT_EQ(outer.report.sign.internal, static_cast<std::int64_t>(mesh.triangles.size() - hull.triangles.size()));
    EXPECT_EQ(outer.report.sign.cut, 0);
    int different = 0;
    for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      different += !same_bits(outer.field.value(i, j, k), alone.field.value(i, j, k));
    });
    EXPECT_EQ(different, 0);
    EXPECT_GT(compare_with_all(mesh, grid, true, thickness), 100);
  }
}

TEST(Outer, OverlappingBoxesHaveTheDistanceOfTheirUnion) {
  // The boxes meet along edges of the mesh, so no triangle is cut.
  const Mesh mesh = joined(fine_box({0, 0, 0}, {1, 1, 1}, 4), fine_box({0.5, 0.25, 0.25}, {1.5, 0.75, 0.75}, 4));
  const std::vector<Box> surface = {{{0, 0, 0}, {0, 1, 1}},           {{0, 0, 0}, {1, 0, 1}},
                                    {{0, 1, 0}, {1, 1, 1}},           {{0, 0, 0}, {1, 1, 0}},
                                    {{0, 0, 1}, {1, 1, 1}},           {{1, 0, 0}, {1, 1, .25}},
                                    {{1, 0, .75}, {1, 1, 1}},         {{1, 0, 0}, {1, .25, 1}},
                                    {{1, .75, 0}, {1, 1, 1}},         {{1.5, .25, .25}, {1.5, .75, .75}},
                                    {{1, .25, .25}, {1.5, .25, .75}}, {{1, .75, .25}, {1.5, .75, .75}},
                                    {{1, .25, .25}, {1.5, .75, .25}}, {{1, .25, .75}, {1.5, .75, .75}}};
  const Grid grid = around(mesh, 33);
  const ComputeResult outer = field_of(mesh, grid, kOuter);
  EXPECT_EQ(outer.report.sign.cut, 0);
  EXPECT_EQ(outer.report.sign.internal, 8 + 32 + 64);
  EXPECT_EQ(outer.field.provenance().sign, "winding outer");
  double worst = 0;
  for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const Vec3 p = grid.position(i, j, k);
    double distance = kFullField;
    for (const Box& side : surface) distance = std::min(distance, distance_to(side, p));
    worst = std::max(worst, std::abs(std::abs(outer.field.value(i, j, k)) - distance));
  });
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(compare_with_all(mesh, grid, false), 100);
}

TEST(Outer, WhereTrianglesAreCutValuesInsideAreLowerBounds) {
  const double side = 1.0 / 13;  // of the squares that are cut
  const Mesh mesh = joined(fine_box({0, 0, 0}, {1, 1, 1}, 13), fine_box({0.5, 0.21, 0.23}, {1.5, 0.77, 0.78}, 13));
  const Grid grid = around(mesh, 33);
  const ComputeResult outer = field_of(mesh, grid, kOuter);
  EXPECT_GT(outer.report.sign.cut, 50);
  EXPECT_GT(outer.report.sign.internal, 300);
  // On the line through both boxes, far from cut triangles, the sides of the smaller one are nearest; in the plane of
  // the larger one's side, the rim or a cut triangle is.
  const auto value = [&](const Vec3& p) {
    const Grid one{{1, 1, 1}, p, {1, 1, 1}};
    return -double(field_of(mesh, one, kOuter).field.value(0, 0, 0));
  };
  EXPECT_NEAR(value({1.3, 0.5, 0.5}), 0.2, 1e-6);
  EXPECT_NEAR(value({0.5, 0.5, 0.5}), 0.5, 1e-6);
  EXPECT_LE(value({1, 0.5, 0.5}), 0.27 + 1e-6);
  EXPECT_GE(value({1, 0.5, 0.5}), 0.27 - 2 * side);
  EXPECT_GT(compare_with_all(mesh, grid, false), 100);
}

TEST(Outer, OutsideNothingChanges) {
  Random random(4);
  Mesh mesh;
  for (int n = 0; n < 40; ++n) mesh = joined(mesh, moved(sphere(4), random.in_cube(0.5), random.between(0.1, 0.3)));
  EXPECT_GT(compare_with_all(mesh, around(mesh, 40), true), 100);
  compare_with_all(mesh, around(mesh, 40), true, 0.1);
  compare_with_all(torus(24, 12, 0.4, 0.6), around(torus(24, 12, 0.4, 0.6), 25), true);
}

TEST(Outer, ACavityKeepsBothSurfaces) {
  const Mesh mesh = joined(moved(sphere(), {}, 2), reversed(sphere()));
  EXPECT_EQ(compare_with_all(mesh, around(mesh, 25), true), 0);
}

TEST(Outer, AWallBetweenBoxesDisappears) {
  const Mesh mesh = joined(fine_box({0, 0, 0}, {1, 1, 1}, 1), fine_box({1, 0, 0}, {2, 1, 1}, 2, true));
  const Grid grid = around(mesh, 25);
  EXPECT_GT(compare_with_all(mesh, grid, false), 100);
  const Box whole{{0, 0, 0}, {2, 1, 1}};
  const DistanceField outer = field_of(mesh, grid, kOuter).field;
  for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const Vec3 p = grid.position(i, j, k), in = min(p - whole.min, whole.max - p);
    const double depth = std::min({in.x, in.y, in.z});
    EXPECT_TRUE(depth <= 0 || std::abs(outer.value(i, j, k) + depth) < 1e-6);
  });
}

TEST(Outer, VerifyFindsAFieldThatHasTheWall) {
  const Mesh mesh = joined(box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 1, 1}));
  const Grid grid = around(mesh, 25);
  DistanceField all = field_of(mesh, grid, kAll).field, outer = field_of(mesh, grid, kOuter).field;
  EXPECT_TRUE(verify(all, mesh).ok());
  EXPECT_TRUE(verify(outer, mesh).ok());
  Provenance of_all = all.provenance(), of_outer = outer.provenance();
  std::swap(of_all.sign, of_outer.sign);
  all.set_provenance(of_all);
  outer.set_provenance(of_outer);
  EXPECT_GT(verify(all, mesh).samples_wrong, 0);
  EXPECT_GT(verify(outer, mesh).samples_wrong, 0);
}

TEST(Outer, GoesWithSkipRulesDenseFieldsAndOrientation) {
  const Mesh hull = moved(sphere(12), {}, 2), mesh = joined(sphere(5), hull);
  const Grid grid = around(mesh, 20);
  ComputeOptions options{.sign = {.method = SignMethod::automatic, .outer = true}};
  const DistanceField turned = compute(reversed(mesh), grid, kFullField, options).field;
  EXPECT_EQ(turned.provenance().sign, "winding oriented outer");
  EXPECT_TRUE(verify(turned, reversed(mesh)).ok());
  const DistanceField outer = compute(mesh, grid, kFullField, options).field;
  options.skip.kind = SkipRule::Kind::exact;
  const ComputeResult skipped = compute(mesh, grid, kFullField, options);
  std::vector<float> dense(static_cast<std::size_t>(grid.sample_count()));
  options.skip = {};
  const ComputeReport report = compute_into(mesh, grid, kFullField, dense, {}, options);
  EXPECT_EQ(report.skipped, 0);
  EXPECT_EQ(report.sign.internal, skipped.report.sign.internal);
  for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    EXPECT_EQ(skipped.field.value(i, j, k), outer.value(i, j, k));
    EXPECT_EQ(dense[static_cast<std::size_t>(grid.index(i, j, k))], outer.value(i, j, k));
  });
}

TEST(Outer, OpenMeshesAndOtherMethodsAreErrors) {
  const Grid grid = around(sphere(), 10);
  const auto expect = [&](ErrorCode code, const char* words, const Mesh& mesh, const SignOptions& sign) {
    expect_error([&] { field_of(mesh, grid, sign); }, code, words);
  };
  expect(ErrorCode::input, "not closed", without(sphere(), 3), kOuter);
  expect(ErrorCode::input, "not closed", terrain(), {.method = SignMethod::automatic, .outer = true});
  expect(ErrorCode::usage, "outer", sphere(), {.method = SignMethod::parity, .outer = true});
  expect(ErrorCode::usage, "outer", sphere(), {.method = SignMethod::none, .outer = true});
}

}  // namespace
}  // namespace standoff
