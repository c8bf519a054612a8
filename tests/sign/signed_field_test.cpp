// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// Signed fields: their magnitudes are those of the unsigned ones, bit for bit, and their signs those of the winding
// number as the sum of solid angles (van Oosterom and Strackee 1983), in sparse and dense fields, bands and full ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "tests/sign/solid_angles.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using testing::Random;

// How many values have the wrong sign or another magnitude than without one.
std::int64_t wrong_values(const Mesh& mesh, const Grid& grid, double thickness, const DistanceField& field) {
  ComputeOptions unsigned_options;
  const DistanceField plain = compute(mesh, grid, thickness, unsigned_options).field;
  std::int64_t wrong = 0;
  testing::for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const float value = field.value(i, j, k), magnitude = plain.value(i, j, k);
    const double winding = testing::winding_number(mesh, grid.position(i, j, k));
    const bool near_surface = std::abs(winding - std::round(winding)) > 1e-6;
    wrong += std::bit_cast<std::uint32_t>(std::abs(value)) != std::bit_cast<std::uint32_t>(magnitude) ||
             (!near_surface && magnitude > 1e-4f && (value < 0) != (winding > 0.5));
  });
  return wrong;
}

TEST(SignedField, BandsAndFullFieldsSparseAndDense) {
  const Grid grid{{29, 26, 31}, {-2.1, -2, -2.2}, {0.15, 0.16, 0.145}};
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Mesh mesh = testing::solid_soup(seed, 5);
    // Of 0.02 most tiles between the band's samples have samples on both sides.
    for (const double thickness : {0.02, 0.3, kFullField}) {
      ComputeOptions options;
      options.sign.method = SignMethod::winding;
      options.sign.as_oriented = true;
      options.nearest_triangle = seed % 2 == 0;
      const ComputeResult result = compute(mesh, grid, thickness, options);
      EXPECT_EQ(wrong_values(mesh, grid, thickness, result.field), 0) << seed << ", " << thickness;
      EXPECT_EQ(result.field.provenance().sign, "winding");
      std::vector<float> dense(static_cast<std::size_t>(grid.sample_count()));
      std::vector<std::uint32_t> nearest(options.nearest_triangle ? dense.size() : 0);
      compute_into(mesh, grid, thickness, dense, nearest, options);
      EXPECT_TRUE(std::ranges::equal(dense, result.field.to_dense(), {}, std::bit_cast<std::uint32_t, float>,
                                     std::bit_cast<std::uint32_t, float>));
    }
  }
}

TEST(SignedField, ScenesOfOverlappingParts) {
  const Mesh mesh = scenes::make("catapult", testing::kSanitized ? 600 : 3000);
  const Box box = bounds(mesh);
  const Vec3 extent = box.extent();
  const double spacing = std::max({extent.x, extent.y, extent.z}) / 24;
  const Grid grid{{28, 28, 28}, box.min - Vec3{1.3, 1.7, 1.1} * spacing, {spacing, spacing, spacing}};
  ComputeOptions options;
  options.sign.method = SignMethod::winding;
  for (const double thickness : {2 * spacing, kFullField})
    EXPECT_EQ(wrong_values(mesh, grid, thickness, compute(mesh, grid, thickness, options).field), 0);
}

TEST(SignedField, TheSameBitsForAnyNumberOfThreads) {
  const Mesh mesh = testing::solid_soup(7, 40);
  const Grid grid{{70, 60, 50}, {-2.5, -2.5, -2.5}, {0.07, 0.08, 0.1}};
  std::vector<float> first;
  for (const int threads : {1, 2, 5}) {
    ComputeOptions options;
    options.sign.method = SignMethod::winding;
    options.execution.threads = threads;
    const std::vector<float> values = compute(mesh, grid, 0.2, options).field.to_dense();
    if (first.empty()) first = values;
    EXPECT_EQ(values, first) << threads;
  }
}

TEST(SignedField, MeshesThatAreNotClosed) {
  Mesh mesh = testing::solid_soup(3, 3);
  const Grid grid{{8, 8, 8}, {-1, -1, -1}, {0.3, 0.3, 0.3}};
  const auto sign_of = [&](const SignOptions& sign) { return compute(mesh, grid, 1, {.sign = sign}).report.sign; };
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  EXPECT_TRUE(sign_of({SignMethod::parity}).sure);
  EXPECT_TRUE(sign_of({SignMethod::winding}).sure);
  const SignReport as_is = sign_of({.method = SignMethod::winding, .as_oriented = true});
  EXPECT_FALSE(as_is.sure);
  EXPECT_EQ(as_is.boundary_edges, 3);
  mesh.triangles.pop_back();
  EXPECT_FALSE(sign_of({SignMethod::winding}).sure);
  expect_error([&] { sign_of({SignMethod::parity}); }, ErrorCode::input, "is not closed");
  expect_error([&] { sign_of({.method = SignMethod::winding, .strict = true}); }, ErrorCode::doubt, "not certain");
}

TEST(SignedField, VerticesNeedNotBeWelded) {
  const Mesh welded = testing::solid_soup(9, 2);
  Mesh loose;
  for (std::size_t t = 0; t < welded.triangles.size(); ++t) {
    const auto [a, b, c] = MeshView(welded).corners(t);
    testing::add_triangle(loose, a, b, c);
  }
  const Grid grid{{20, 20, 20}, {-2, -2, -2}, {0.2, 0.2, 0.2}};
  ComputeOptions options;
  options.sign.method = SignMethod::winding;
  EXPECT_EQ(compute(loose, grid, 0.3, options).field.to_dense(), compute(welded, grid, 0.3, options).field.to_dense());
}

TEST(SignedField, OptionsThatContradictEachOther) {
  const Mesh mesh = testing::solid_soup(1, 1);
  const auto rejects = [&](const SignOptions& sign, const char* what) {
    ComputeOptions options;
    options.sign = sign;
    expect_error([&] { compute(mesh, {{4, 4, 4}, {}}, 1, options); }, ErrorCode::usage, what);
  };
  rejects({static_cast<SignMethod>(99)}, "no such sign method");
  rejects({SignMethod::winding, static_cast<WindingRule>(-1)}, "no such sign method");
  rejects({SignMethod::parity, WindingRule::nonzero}, "for the sign methods winding and automatic");
  rejects({SignMethod::none, WindingRule::positive, true}, "cannot be inverted");
}

}  // namespace
}  // namespace standoff
