// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
#include "sign/sign_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "tests/sign/solid_angles.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using testing::Random;

// Rows of tiles come once each, whatever their sides load at a time.

// The sample that is marked in a row of tiles.
std::int64_t marked(const InsideRows& rows, std::int64_t n) { return 8 * rows.tiles_begin() + n % 8; }

// Loads so many rows of tiles at a time, and marks one sample in each row.
class FewAtATime final : public SampleSigns {
 public:
  FewAtATime(std::int64_t rows, std::int64_t tiles_y) : rows_(rows), tiles_y_(tiles_y) {}
  std::int64_t load(std::int64_t first) override {
    EXPECT_GE(first, end_);
    begin_ = first;
    return end_ = first + rows_;
  }
  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override {
    const std::int64_t n = ty + tiles_y_ * tz;
    EXPECT_GE(n, begin_);
    EXPECT_LT(n, end_);
    rows.set(0, marked(rows, n), marked(rows, n) + 1);
  }

 private:
  std::int64_t rows_, tiles_y_, begin_ = 0, end_ = 0;
};

TEST(RowsOfTiles, EachOfAWindowComesOnce) {
  const Grid grid{{70, 33, 60}, {}, {1, 1, 1}};
  constexpr std::int64_t kTilesY = 5;
  const Grid windows[] = {grid, grid.window({8, 8, 16}, {16, 24, 40}), grid.window({0, 32, 0}, {8, 1, 60})};
  for (const std::int64_t loaded : {1, 3, 5, 7, 12, 100})
    for (const Grid& window : windows) {
      FewAtATime sides(loaded, kTilesY);
      ProgressMeter progress;
      std::vector<std::atomic<int>> seen(kTilesY * 8);
      for_each_row_of_tiles(sides, false, grid, window, progress,
                            [&](const InsideRows& inside, std::int64_t ty, std::int64_t tz) {
                              const std::int64_t n = ty + kTilesY * tz;
                              EXPECT_TRUE(inside.is_inside(0, marked(inside, n)));
                              ++seen[static_cast<std::size_t>(n)];
                            });
      for (std::int64_t tz = 0; tz < 8; ++tz)
        for (std::int64_t ty = 0; ty < kTilesY; ++ty) {
          const bool in_window = 8 * ty >= window.first.y && 8 * ty < window.first.y + window.size.y &&
                                 8 * tz >= window.first.z && 8 * tz < window.first.z + window.size.z;
          EXPECT_EQ(seen[static_cast<std::size_t>(ty + kTilesY * tz)], in_window ? 1 : 0) << ty << ", " << tz;
        }
    }
}

// Signed fields: their magnitudes are those of the unsigned ones, bit for bit, and their signs those of the winding
// number as the sum of solid angles (van Oosterom and Strackee 1983), in sparse and dense fields, bands and full ones.

// How many values have the wrong sign or another magnitude than without one.
std::int64_t wrong_values(const Mesh& mesh, const Grid& grid, double thickness, const DistanceField& field) {
  ComputeOptions unsigned_options{.sign = {SignMethod::none}};
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
      ComputeOptions options{.sign = {SignMethod::none}};
      options.sign.method = SignMethod::winding;
      options.sign.as_oriented = true;
      options.nearest = seed % 2 == 0;
      const ComputeResult result = compute(mesh, grid, thickness, options);
      EXPECT_EQ(wrong_values(mesh, grid, thickness, result.field), 0) << seed << ", " << thickness;
      EXPECT_EQ(result.field.provenance().sign, "winding");
      std::vector<float> dense(static_cast<std::size_t>(grid.sample_count()));
      std::vector<std::uint32_t> nearest(options.nearest ? dense.size() : 0);
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
  ComputeOptions options{.sign = {SignMethod::none}};
  options.sign.method = SignMethod::winding;
  for (const double thickness : {2 * spacing, kFullField})
    EXPECT_EQ(wrong_values(mesh, grid, thickness, compute(mesh, grid, thickness, options).field), 0);
}

TEST(SignedField, TheSameBitsForAnyNumberOfThreads) {
  const Mesh mesh = testing::solid_soup(7, 40);
  const Grid grid{{70, 60, 50}, {-2.5, -2.5, -2.5}, {0.07, 0.08, 0.1}};
  std::vector<float> first;
  for (const int threads : {1, 2, 5}) {
    ComputeOptions options{.sign = {SignMethod::none}};
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
  ComputeOptions options{.sign = {SignMethod::none}};
  options.sign.method = SignMethod::winding;
  EXPECT_EQ(compute(loose, grid, 0.3, options).field.to_dense(), compute(welded, grid, 0.3, options).field.to_dense());
}

TEST(SignedField, OptionsThatContradictEachOther) {
  const Mesh mesh = testing::solid_soup(1, 1);
  const auto rejects = [&](const SignOptions& sign, const char* what) {
    ComputeOptions options{.sign = {SignMethod::none}};
    options.sign = sign;
    expect_error([&] { compute(mesh, {{4, 4, 4}, {}}, 1, options); }, ErrorCode::usage, what);
  };
  rejects({static_cast<SignMethod>(99)}, "no such sign method");
  rejects({SignMethod::winding, static_cast<WindingRule>(-1)}, "no such sign method");
  rejects({SignMethod::parity, WindingRule::nonzero}, "for the sign methods winding and automatic");
  rejects({SignMethod::none, WindingRule::positive, true}, "cannot be inverted");
}

// Shells: of a point and a segment they are balls and capsules, whose distances are known in closed form; of any mesh
// they are the unsigned field less half of the shell's thickness.

ComputeOptions shell_of(double thickness, bool nearest = false, bool invert = false) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.sign.method = SignMethod::shell;
  options.sign.shell = thickness;
  options.sign.invert = invert;
  options.nearest = nearest;
  return options;
}

// The largest error in terms of the one promised of the distance.
template <class Distance>
double worst_error(const DistanceField& field, double shell, const Distance& distance) {
  double worst = 0;
  testing::for_each_sample(field.grid(), [&](auto i, auto j, auto k) {
    const double d = distance(field.grid().position(i, j, k));
    const double expected = std::clamp(d - shell / 2, -field.thickness(), field.thickness());
    worst = std::max(worst, std::abs(field.value(i, j, k) - expected) / testing::promised_error(field.grid(), d));
  });
  return worst;
}

const Grid kShellGrid{{35, 34, 41}, {-1.71, -1.62, -2.03}, {0.1, 0.1, 0.1}};

TEST(Shell, OfAPointIsABallOfASegmentACapsule) {
  const Mesh point{{{0.013, 0.02, -0.04}}, {{0, 0, 0}}};
  const Mesh segment{{{0, 0, -0.8}, {0, 0, 0.7}}, {{0, 1, 1}}};
  for (const double shell : {0.02, 0.5, 2.3})
    for (const double thickness : {0.15, 0.4, kFullField}) {
      const DistanceField ball = compute(point, kShellGrid, thickness, shell_of(shell)).field;
      EXPECT_LE(worst_error(ball, shell, [&](Vec3 p) { return length(p - point.vertices[0]); }), 1);
      const DistanceField capsule = compute(segment, kShellGrid, thickness, shell_of(shell)).field;
      EXPECT_LE(worst_error(capsule, shell,
                            [&](Vec3 p) {
                              return std::hypot(p.x, p.y, std::max({0.0, p.z - 0.7, -0.8 - p.z}));
                            }),
                1);
      EXPECT_EQ(capsule.provenance().sign.substr(0, 5), "shell");
      EXPECT_EQ(capsule.thickness(), thickness);
    }
  EXPECT_LT(compute(point, kShellGrid, 0.2, shell_of(1)).field.value(17, 16, 20), 0);
}

TEST(Shell, OfAPlane) {
  Mesh plane;
  testing::add_triangle(plane, {-50, -50, 0.013}, {50, -50, 0.013}, {0, 80, 0.013});
  for (const double shell : {0.01, 0.7}) {
    const DistanceField field = compute(plane, kShellGrid, 0.31, shell_of(shell)).field;
    EXPECT_LE(worst_error(field, shell, [](Vec3 p) { return std::abs(p.z - 0.013); }), 1);
  }
}

// Of the full unsigned field each value has one more rounding.
TEST(Shell, IsTheDistanceLessHalfInSparseAndDenseFields) {
  const Mesh mesh = testing::random_soup(4, 60, 1.2, 0.7);
  const std::vector<float> distances =
      compute(mesh, kShellGrid, kFullField, {.sign = {SignMethod::none}}).field.to_dense();
  for (const double shell : {0.05, 0.37, 2.9})
    for (const double thickness : {0.12, 0.5, kFullField})
      for (const bool invert : {false, true}) {
        const ComputeOptions options = shell_of(shell, true, invert);
        const DistanceField field = compute(mesh, kShellGrid, thickness, options).field;
        std::vector<float> dense(distances.size());
        std::vector<std::uint32_t> nearest(distances.size());
        compute_into(mesh, kShellGrid, thickness, dense, nearest, options);
        const DistanceField from_dense = DistanceField::from_dense(kShellGrid, thickness, dense, nearest);
        testing::expect_same_bits(field, from_dense);
        EXPECT_EQ(field.stored_tiles(), from_dense.stored_tiles());
        std::int64_t wrong = 0, nearest_wrong = 0;
        for (std::size_t n = 0; n < dense.size(); ++n) {
          const double value = (invert ? -1 : 1) * (distances[n] - shell / 2);
          wrong += dense[n] != static_cast<float>(std::clamp(value, -thickness, thickness));
          nearest_wrong += (nearest[n] == kNoTriangle) != (std::abs(value) > thickness);
        }
        EXPECT_EQ(wrong, 0);
        EXPECT_EQ(nearest_wrong, 0);
        const auto last = field.tile(4, 4, 5);
        EXPECT_TRUE(!last || (*last)[511] == static_cast<float>(thickness));  // beyond the grid
      }
}

TEST(Shell, TilesDeepInsideAreNotStored) {
  const Mesh point{{{0, 0, 0}}, {{0, 0, 0}}};
  const Grid grid{{80, 80, 80}, {-40, -40, -40}};
  const DistanceField field = compute(point, grid, 2, shell_of(60)).field;
  EXPECT_EQ(field.background(5, 5, 5), -2);
  EXPECT_FALSE(field.tile(5, 5, 5));
  EXPECT_EQ(field.background(0, 0, 0), 2);
  EXPECT_FALSE(field.tile(0, 0, 0));
  EXPECT_TRUE(field.tile(1, 5, 5));
  EXPECT_GT(field.stored_tiles(), 100);
}

TEST(Shell, MemoryIsThatOfTheDistancesItNeeds) {
  const Mesh mesh = testing::random_soup(4, 60, 1.2, 0.1);
  EXPECT_EQ(estimate(mesh, kShellGrid, 0.25, shell_of(0.5)).whole,
            estimate(mesh, kShellGrid, 0.5, {.sign = {SignMethod::none}}).whole);
  ComputeOptions limited = shell_of(0.5);
  limited.memory_limit = estimate(mesh, kShellGrid, 0.5, {.sign = {SignMethod::none}}).whole - 1;
  expect_error([&] { compute(mesh, kShellGrid, 0.25, limited); }, ErrorCode::limit, "the field may need");
}

TEST(Shell, ThicknessesThatAreNone) {
  const Mesh mesh = testing::random_soup(4, 6, 1, 1);
  for (const double shell : {0.0, -1.0, std::nan(""), kFullField})
    expect_error([&] { compute(mesh, kShellGrid, 1, shell_of(shell)); }, ErrorCode::usage, "positive and finite");
  expect_error([&] { compute(mesh, kShellGrid, 1, shell_of(1e6)); }, ErrorCode::limit, "coarser than the grid");
  ComputeOptions options{.sign = {SignMethod::none}};
  options.sign.shell = 1;
  expect_error([&] { compute(mesh, kShellGrid, 1, options); }, ErrorCode::usage, "for the sign method shell");
}

}  // namespace
}  // namespace standoff
