// SPDX-License-Identifier: Apache-2.0
// compute and compute_into: options, errors, progress, memory.
// labels: memory threads
#include "standoff/compute.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "standoff/version.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const Grid kComputeGrid{{40, 41, 42}, {-5, -5, -5}, {0.25, 0.25, 0.25}};

Mesh soup() { return testing::random_soup(81, 200, 4, 1); }

void expect_compute_error(const Mesh& mesh, const ComputeOptions& options, ErrorCode code, const std::string& words,
                          double thickness = kFullField) {
  expect_error([&] { compute(mesh, kComputeGrid, thickness, options); }, code, words);
  std::vector<float> values(static_cast<std::size_t>(kComputeGrid.sample_count()));
  expect_error([&] { compute_into(mesh, kComputeGrid, thickness, values, options); }, code, words);
}

TEST(Compute, MeshErrorsNameTheTriangle) {
  expect_compute_error({}, {}, ErrorCode::input, "no triangles");
  Mesh mesh = soup();
  mesh.vertices[3 * 7 + 1].z = kNaN;
  expect_compute_error(mesh, {}, ErrorCode::input, "triangle 7");
  mesh = soup();
  mesh.triangles[9][0] = 600;
  expect_compute_error(mesh, {}, ErrorCode::input, "triangle 9: index 600");
}

TEST(Compute, OptionErrors) {
  for (const double thickness : {0.0, -1.0, kNaN})
    expect_compute_error(soup(), {}, ErrorCode::usage, "thickness must be positive", thickness);
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = -1}};
  expect_compute_error(soup(), options, ErrorCode::usage, "threads");
  options = {.sign = {SignMethod::none}};
  options.skip = {SkipRule::Kind::neighbour, 1.5};
  expect_compute_error(soup(), options, ErrorCode::usage, "fraction");
  expect_error(
      [] {
        compute(soup(), {{0, 1, 1}, {}, {1, 1, 1}}, 1, {.sign = {SignMethod::none}});
      },
      ErrorCode::usage, "at least one sample");
}

TEST(Compute, MemoryOfTheWrongLength) {
  std::vector<float> values(static_cast<std::size_t>(kComputeGrid.sample_count()));
  std::vector<std::uint32_t> nearest(values.size());
  const auto expect_refused = [](std::span<float> v, std::span<std::uint32_t> n, const ComputeOptions& options) {
    expect_error([&] { compute_into(soup(), kComputeGrid, kFullField, v, n, options); }, ErrorCode::usage,
                 "68880 values");
  };
  expect_refused(std::span(values).first(values.size() - 1), {}, {});
  expect_refused(values, std::span(nearest).first(1), {});
  ComputeOptions options{.sign = {SignMethod::none}, .nearest = true};
  expect_refused(values, {}, options);
}

TEST(Compute, MemoryLimitSaysWhatIsNeededAndWhatToDo) {
  ComputeOptions options{.sign = {SignMethod::none}};
  const auto needed = estimate(soup(), kComputeGrid, 1, options).whole;
  options.memory_limit = needed - 1;
  expect_error([&] { compute(soup(), kComputeGrid, 1, options); }, ErrorCode::limit, "may need");
  expect_error([&] { compute(soup(), kComputeGrid, 1, options); }, ErrorCode::limit, "higher limit");
  options.memory_limit = needed;
  EXPECT_LE(compute(soup(), kComputeGrid, 1, options).field.memory_bytes(), needed);
}

// What it takes is measured in memory_test.cpp.
TEST(Compute, MemoryNeededCountsTheCallersMemory) {
  ComputeOptions options{.sign = {SignMethod::none}};
  const auto dense = [&] { return estimate(soup(), kComputeGrid, 0.3, options).dense; };
  const std::int64_t values = dense();
  options.nearest = true;
  EXPECT_EQ(dense() - values, kComputeGrid.sample_count() * 4);
  EXPECT_LE(dense(), estimate(200, kComputeGrid, 0.3, options).dense) << "of any mesh";
}

TEST(Compute, MemoryNeededDoesNotOverflow) {
  const std::int64_t large = std::int64_t{1} << 40;
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1}};
  EXPECT_GT(estimate(1, {{large, 1 << 22, 1}, {}, {1, 1, 1}}, kFullField, options).whole, large);
}

TEST(Compute, MemoryNeededCountsTheSkipRule) {
  const auto needed = [](SkipRule::Kind kind) {
    return estimate(1'000'000, kComputeGrid, 1, {.skip = {.kind = kind}, .sign = {SignMethod::none}}).whole;
  };
  const auto none = needed(SkipRule::Kind::none);
  EXPECT_EQ(needed(SkipRule::Kind::neighbour) - none, 4'000'000);
  EXPECT_EQ(needed(SkipRule::Kind::exact) - none, 18'000'000) << "it sorts hashes";
}

TEST(Compute, ProgressNeverFallsAndEndsAtOne) {
  for (const double thickness : {0.5, 4.0}) {
    ComputeOptions options{.sign = {SignMethod::none}};
    double last = 0;
    int calls = 0;
    std::vector<std::string> stages;
    options.progress = [&](const Progress& progress) {
      EXPECT_GE(progress.fraction, last);
      EXPECT_LE(progress.fraction, 1);
      EXPECT_TRUE(std::string("preparing the mesh,sorting the triangles,distances,checksum,done,")
                      .find(progress.stage + std::string(",")) != std::string::npos)
          << progress.stage;
      if (stages.empty() || stages.back() != progress.stage) stages.push_back(progress.stage);
      last = progress.fraction;
      ++calls;
      return true;
    };
    compute(soup(), kComputeGrid, thickness, options);
    EXPECT_EQ(last, 1);
    EXPECT_GT(calls, 10);
    ASSERT_GT(stages.size(), 2u);
    EXPECT_EQ(stages.front(), "preparing the mesh");
    EXPECT_EQ(stages[stages.size() - 2], "checksum") << "nothing is left to do after the end";
    EXPECT_EQ(stages.back(), "done");
  }
}

TEST(Compute, CancelsWhereverItIsAsked) {
  for (const double thickness : {0.5, 4.0})
    for (const int most : {0, 1, 2, 5, 12}) {
      int calls = 0;
      ComputeOptions options{.sign = {SignMethod::none}};
      options.progress = [&](const Progress&) { return calls++ < most; };
      expect_error([&] { compute(soup(), kComputeGrid, thickness, options); }, ErrorCode::interrupted, "cancelled");
      EXPECT_EQ(calls, most + 1) << "not asked again";
    }
}

// Millions of triangles are binned or sorted before the first brick is done: the caller used to wait for that.
TEST(Compute, CancelsBeforeTheFirstBrick) {
  const Mesh mesh = testing::random_soup(5, 3000, 2, 0.5);
  for (const double thickness : {0.5, 4.0}) {
    int before_bricks = 0;
    ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1}};
    options.progress = [&](const Progress& progress) {
      before_bricks += progress.stage == std::string("distances") && progress.fraction == 0.2;
      return before_bricks < 3;
    };
    expect_error([&] { compute(mesh, kComputeGrid, thickness, options); }, ErrorCode::interrupted, "cancelled");
  }
}

// One field takes jobs of all kinds, one after another: no job leaves anything for the next.
TEST(ComputeIntoAField, GivesWhatComputeGives) {
  DistanceField field;
  const Grid grids[] = {kComputeGrid, {{9, 70, 20}, {-2, -3, -1}, {0.5, 0.1, 0.2}}, {{1, 1, 1}, {}, {1, 1, 1}}};
  for (const bool nearest : {false, true, false})
    for (const double thickness : {0.5, std::numeric_limits<double>::infinity(), 0.25})
      for (const Grid& grid : grids) {
        ComputeOptions options{.sign = {SignMethod::none}, .nearest = nearest};
        const ComputeResult expected = compute(soup(), grid, thickness, options);
        const ComputeReport report = compute_into(soup(), grid, thickness, field, options);
        EXPECT_EQ(report.tiles_stored, expected.report.tiles_stored);
        EXPECT_EQ(field.grid(), grid);
        EXPECT_EQ(field.thickness(), thickness);
        EXPECT_EQ(field.has_nearest(), nearest);
        EXPECT_EQ(field.to_dense(), expected.field.to_dense());
        EXPECT_EQ(field.memory_bytes(), expected.field.memory_bytes());
        EXPECT_EQ(field.provenance().method, "tiles");
        EXPECT_EQ(field.provenance().mesh_hash, content_hash(soup()));
        if (!nearest) continue;
        EXPECT_EQ(testing::all_nearest(field), testing::all_nearest(expected.field));
      }
}

TEST(ComputeIntoAField, UsesItsMemoryAgain) {
  DistanceField field;
  compute_into(soup(), kComputeGrid, kFullField, field, {.sign = {SignMethod::none}});
  const float* const before = field.tile_values().data();
  compute_into(soup(), field.grid(), kFullField, field, {.sign = {SignMethod::none}});
  EXPECT_EQ(field.tile_values().data(), before);
  EXPECT_EQ(field.grid(), kComputeGrid);
}

TEST(ComputeIntoAField, ThatFailsLeavesItEmptyOrAsItWas) {
  DistanceField field;
  const auto expect_refused = [&field](const Mesh& mesh, const ComputeOptions& options, ErrorCode code, bool kept) {
    compute_into(soup(), kComputeGrid, kFullField, field, {.sign = {SignMethod::none}});
    const std::vector<float> before = field.to_dense();
    expect_error([&] { compute_into(mesh, kComputeGrid, kFullField, field, options); }, code, "");
    EXPECT_EQ(field.to_dense() == before, kept);
    EXPECT_EQ(field.stored_tiles() == 0, !kept);
  };
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = -1}};
  expect_refused(soup(), options, ErrorCode::usage, true);
  options = {.sign = {SignMethod::none}};
  options.memory_limit = 1000;
  expect_refused(soup(), options, ErrorCode::limit, true);
  options = {.sign = {SignMethod::none}};
  int calls = 0;
  options.progress = [&](const Progress&) { return calls++ < 4; };
  expect_refused(soup(), options, ErrorCode::interrupted, false);
  expect_refused({}, {}, ErrorCode::input, true);
}

TEST(Compute, HashesTheMeshWhereItIsWanted) {
  ComputeOptions options{.sign = {SignMethod::none}, .hash_mesh = false};
  options.progress = [](const Progress& progress) { return progress.stage != std::string("checksum"); };
  const DistanceField field = compute(soup(), kComputeGrid, 1, options).field;
  EXPECT_EQ(field.provenance().mesh_hash, 0u);
  EXPECT_EQ(field.provenance().method, "tiles");
}

TEST(Compute, ReportsWhatItDid) {
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 2}};
  const ComputeResult done = compute(soup(), kComputeGrid, 0.5, options);
  const ComputeReport& report = done.report;
  EXPECT_EQ(report.method, "tiles");
  EXPECT_EQ(report.backend, "cpu");
  EXPECT_EQ(report.threads, 2);
  EXPECT_EQ(report.triangles, 200);
  EXPECT_EQ(report.skipped, 0);
  EXPECT_EQ(report.samples, kComputeGrid.sample_count());
  EXPECT_EQ(report.tiles, 5 * 6 * 6);
  EXPECT_EQ(report.tiles_stored, done.field.stored_tiles());
  std::int64_t band = 0;
  for (const float value : done.field.to_dense()) band += value < 0.5f;
  EXPECT_EQ(report.samples_band, band);
  EXPECT_GE(report.samples_examined, band);
  EXPECT_EQ(done.field.provenance().method, "tiles");
  EXPECT_EQ(done.field.provenance().mesh_hash, content_hash(soup()));
  EXPECT_EQ(done.field.provenance().version, version());
  EXPECT_EQ(done.field.thickness(), 0.5);
}

}  // namespace
}  // namespace standoff
