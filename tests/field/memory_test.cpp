// SPDX-License-Identifier: Apache-2.0
// Memory: compares the bytes that a computation says it needs with the bytes that it takes, and tests failing
// allocations.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <regex>
#include <string>
#include <vector>

#include "core/memory.h"
#include "sign/diagnosis/closed.h"
#include "standoff/compute.h"
#include "standoff/io.h"
#include "standoff/slabs.h"
#include "standoff/update.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"
#include "tests/support/heap.h"
#include "tests/support/random_mesh.h"
#include "tests/support/temp_folder.h"

namespace standoff::testing {
namespace {

using heap::Limit;
using heap::most_held;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Mesh kTriangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};

Grid cube(std::int64_t side, Vec3 origin, double extent) {
  const double spacing = extent / static_cast<double>(side - 1);
  return {{side, side, side}, origin, {spacing, spacing, spacing}};
}

// Bytes for TBB, the callback and the texts of a report.
constexpr std::int64_t kSmallThings = 64 << 10;

void expect_enough(const Mesh& mesh, double thickness) {
  const Grid grid = cube(64, {-5, -5, -5}, 10);
  for (const int threads : {1, 8})
    for (const bool nearest : {false, true}) {
      ComputeOptions options{
          .sign = {SignMethod::none}, .execution = {.threads = threads, .backend = Backend::cpu}, .nearest = nearest};
      const std::int64_t needed = estimate(mesh, grid, thickness, options).whole;
      const std::int64_t taken = most_held([&] { compute(mesh, grid, thickness, options); });
      EXPECT_LE(taken, needed + kSmallThings)
          << mesh.triangles.size() << " triangles, thickness " << thickness << ", " << threads << " threads";
      EXPECT_LE(needed, estimate(std::int64_t(mesh.triangles.size()), grid, thickness, options).whole);
    }
}

TEST(Memory, ThinBandsTakeNoMoreThanWasSaid) {
  for (const double size : {4.0, 0.1}) expect_enough(random_soup(5, 2000, 4, size), 0.3);
  expect_enough(kTriangle, 0.3);
}

TEST(Memory, WideFieldsTakeNoMoreThanWasSaid) {
  for (const double thickness : {2.0, kInfinity}) {
    expect_enough(kTriangle, thickness);
    expect_enough(random_soup(5, 2000, 4, 4), thickness);
  }
}

// A band around one triangle stores a few tiles of a grid whose samples would fill 32 GB.
TEST(Memory, SparseBandsAreNotRefusedForTheirGrid) {
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 2, .backend = Backend::cpu}};
  const Grid grid = cube(2000, {0, 0, -0.5}, 1);
  options.memory_limit = std::int64_t{1} << 30;
  EXPECT_GT(estimate(1, grid, 2 * grid.spacing.x, options).whole, 30'000'000'000);
  const std::int64_t needed = estimate(kTriangle, grid, 2 * grid.spacing.x, options).whole;
  EXPECT_LE(needed, options.memory_limit);
  EXPECT_LE(
      most_held([&] { EXPECT_GT(compute(kTriangle, grid, 2 * grid.spacing.x, options).field.stored_tiles(), 1000); }),
      needed);
}

TEST(Memory, TilesAreCountedWhereTrianglesReach) {
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1}};
  const Grid grid{{4096, 4096, 8}, {}, {1, 1, 1}};
  const auto needed = [&](const Mesh& mesh, double thickness = 0.5) {
    return estimate(mesh, grid, thickness, options).whole;
  };
  // Triangles in one place share tiles; those off the grid do not count.
  const auto mesh_of = [](int count, double at) {
    Mesh mesh;
    for (int n = 0; n < count; ++n) {
      const auto v = static_cast<std::uint32_t>(3 * n);
      for (const Vec3 corner : {Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 2, 2}})
        mesh.vertices.push_back(corner + Vec3{at, 3, 3});
      mesh.triangles.push_back({v, v + 1, v + 2});
    }
    return mesh;
  };
  constexpr std::int64_t kChunk = 256 * 512 * 4;
  const std::int64_t none = needed(mesh_of(1, -1000)), some = needed(mesh_of(1, 3));
  constexpr std::int64_t kRef = 4;  // a triangle in a list of a brick's
  EXPECT_EQ(some - none, kChunk + kRef);
  EXPECT_EQ(needed(mesh_of(5000, 3)) - needed(mesh_of(5000, -1000)), kChunk + 5000 * kRef);
  // Each in a tile of its own.
  const auto row_of = [&](int count) {
    Mesh mesh;
    for (int n = 0; n < count; ++n) append(mesh, mesh_of(1, 3 + 8 * n));
    return mesh;
  };
  EXPECT_EQ(needed(row_of(256)) - needed(mesh_of(256, -1000)), kChunk + 256 * kRef);
  EXPECT_EQ(needed(row_of(257)) - needed(mesh_of(257, -1000)), 2 * kChunk + 257 * kRef);
  EXPECT_EQ(needed(mesh_of(129, 6.9)) - needed(mesh_of(129, -1000)), kChunk + 129 * kRef) << "two tiles for all";
  EXPECT_EQ(needed(mesh_of(1, 3), kFullField), estimate(1, grid, kFullField, options).whole);
}

void take_all(const Mesh& mesh, const Grid& grid, double thickness, const ComputeOptions& options) {
  SlabComputation slabs(mesh, grid, thickness, options, 1);
  while (slabs.next()) {
  }
}

TEST(Memory, SlabsTakeNoMoreThanWasSaid) {
  const Grid grid = cube(80, {-5, -5, -5}, 10);
  for (const Mesh& mesh : {random_soup(5, 2000, 4, 0.3), kTriangle})
    for (const double thickness : {0.3, 2.0, kInfinity})
      for (const SignMethod method : {SignMethod::none, SignMethod::shell, SignMethod::normal}) {
        ComputeOptions options{.sign = {.method = method}, .execution = {.threads = 2, .backend = Backend::cpu}};
        if (method == SignMethod::shell) options.sign.shell = 0.2;
        const std::int64_t needed = estimate(mesh, grid, thickness, options, 1).slabs;
        if (method == SignMethod::normal) {
          EXPECT_EQ(needed, estimate(mesh, grid, thickness, options).whole) << "it is one slab";
          continue;
        }
        EXPECT_LE(most_held([&] { take_all(mesh, grid, thickness, options); }), needed + kSmallThings)
            << mesh.triangles.size() << " triangles, thickness " << thickness;
      }
}

// Signs and nearest triangles take memory too. Slabs may have 32 MiB of crossings; a ball has far fewer.
TEST(Memory, SlabsOfABallTakeNoMoreThanWasSaid) {
  const Grid grid = cube(80, {-1.25, -1.25, -1.25}, 2.5);
  const Mesh ball = sphere(24);
  for (const double thickness : {0.1, kInfinity})
    for (const SignMethod method : {SignMethod::none, SignMethod::winding, SignMethod::parity})
      for (const bool nearest : {false, true}) {
        ComputeOptions options{
            .sign = {.method = method}, .execution = {.threads = 2, .backend = Backend::cpu}, .nearest = nearest};
        const std::int64_t needed = estimate(ball, grid, thickness, options, 1).slabs;
        int slabs = 0;
        const std::int64_t taken = most_held([&] {
          SlabComputation computation(ball, grid, thickness, options, 1);
          while (computation.next()) ++slabs;
        });
        EXPECT_EQ(slabs, 5);
        EXPECT_LE(taken, needed + kSmallThings)
            << "sign " << name_of(method) << ", thickness " << thickness << (nearest ? ", nearest triangles" : "");
      }
}

// A wall along a whole column: with and without the file, only one slab is in memory, however many there are.
// The tiles of all windows are held before the first one is put into the field.
TEST(Memory, UpdatesOfManyWindowsTakeNoMoreThanWasSaid) {
  const Mesh before = random_soup(5, 400, 4, 0.1);
  Mesh after = before;
  for (std::size_t t = 0; t < 120; ++t) after.vertices[after.triangles[t][0]].x += 0.05;
  const Grid grid = cube(192, {-5, -5, -5}, 10);
  for (const bool nearest : {false, true}) {
    ComputeOptions options{
        .sign = {SignMethod::none}, .execution = {.threads = 2, .backend = Backend::cpu}, .nearest = nearest};
    const std::vector<std::uint32_t> changed = changed_triangles(before, after);
    DistanceField field = compute(before, grid, 0.1, options).field;
    ComputeOptions limited = options;
    limited.memory_limit = 1000;
    try {
      update_field(before, after, changed, field, limited);
      ADD_FAILURE() << "a limit of 1000 bytes is enough";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::limit);
      limited.memory_limit = error.details().bytes_needed.value_or(0);
    }
    UpdateReport report;
    const std::int64_t taken = most_held([&] { report = update_field(before, after, changed, field, limited); });
    EXPECT_FALSE(report.anew) << report.why;
    EXPECT_GT(report.windows, 30);
    EXPECT_LE(taken, limited.memory_limit + 10 * kSmallThings) << "of lists of triangles and changed tiles, the most";
  }
}

// A set of triangles takes memory, a vertex that no triangle uses has none.
TEST(Memory, SumsOfUnusedVertices) {
  Mesh mesh = box();
  mesh.vertices.resize(100'000, {3, 3, 3});
  const std::int64_t taken = most_held([&] { EXPECT_TRUE(OutwardSums(mesh).surely_outwards()); });
  EXPECT_LE(taken, OutwardSums::bytes(12, 100'000) + kSmallThings);
}

TEST(Memory, DoesNotGrowWithTheNumberOfSlabs) {
  const TempFolder folder;
  const auto most_of = [&](std::int64_t slabs, double thickness, bool written) {
    const Grid grid{{128, 128, 16 * slabs}, {}, {1, 1, 1}};
    const double top = static_cast<double>(grid.size.z);
    const Mesh wall{{{20, 20, -9}, {100, 90, -9}, {20, 20, top}, {100, 90, top}}, {{0, 1, 2}, {1, 3, 2}}};
    ComputeOptions options{.sign = {.method = SignMethod::winding},
                           .execution = {.threads = 1, .backend = Backend::cpu}};
    return most_held([&] {
      if (!written) return take_all(wall, grid, thickness, options);
      SlabComputation taken(wall, grid, thickness, options, 1);
      write_field(folder / "wall.npz", taken, {.threads = 1});
    });
  };
  for (const double thickness : {2.0, kInfinity})
    for (const bool written : {false, true}) {
      const std::int64_t few = most_of(6, thickness, written), many = most_of(48, thickness, written);
      // 48 full slabs have 50 MB of values. Only counters of bricks, and crossings up to their limit, grow with the
      // grid.
      EXPECT_LT(many, few + (std::int64_t{2} << 20)) << thickness;
    }
}

TEST(Memory, WhatIsTooLargeMayFitInSlabs) {
  const Mesh mesh = random_soup(5, 300, 4, 1);
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1, .backend = Backend::cpu}};
  const Grid grid = cube(160, {-5, -5, -5}, 10);
  options.memory_limit = estimate(mesh, grid, kInfinity, options, 1).slabs;
  EXPECT_LT(2 * options.memory_limit, estimate(mesh, grid, kInfinity, options).whole);
  expect_error([&] { compute(mesh, grid, kInfinity, options); }, ErrorCode::limit, "more than the limit");
  EXPECT_LE(most_held([&] { take_all(mesh, grid, kInfinity, options); }), options.memory_limit + kSmallThings);
  --options.memory_limit;
  expect_error([&] { take_all(mesh, grid, kInfinity, options); }, ErrorCode::limit, "more than the limit");
  ++options.memory_limit;
  options.sign.method = SignMethod::flood;
  expect_error([&] { take_all(mesh, grid, kInfinity, options); }, ErrorCode::limit, "more than the limit");
}

// The message of the refusal, or "".
std::string refusal(const Mesh& mesh, const Grid& grid, double thickness, const ComputeOptions& options) {
  try {
    compute(mesh, grid, thickness, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::limit);
    return error.what();
  }
  return "";
}

TEST(Memory, WhatIsAdvisedHelps) {
  const Mesh mesh = random_soup(5, 300, 4, 1);
  for (const double thickness : {0.5, kInfinity}) {
    ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1, .backend = Backend::cpu}};
    const Grid grid = cube(400, {-5, -5, -5}, 10);
    options.memory_limit = estimate(mesh, grid, thickness, options).whole * 9 / 10;
    const std::string told = refusal(mesh, grid, thickness, options);
    std::smatch side;
    ASSERT_TRUE(std::regex_search(told, side, std::regex("at most about ([0-9]+) samples"))) << told;
    EXPECT_NE(told.find("smaller thickness"), std::string::npos) << told;
    EXPECT_LE(estimate(mesh, cube(std::stoll(side[1]), {-5, -5, -5}, 10), thickness, options).whole,
              options.memory_limit);
    EXPECT_LE(estimate(mesh, grid, grid.spacing.x, options).whole, options.memory_limit);
  }
}

TEST(Memory, NothingIsAdvisedThatDoesNotHelp) {
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1, .backend = Backend::cpu}};
  const Grid grid = cube(400, {-5, -5, -5}, 10);
  options.memory_limit = std::int64_t{32} << 20;  // less than the table of tiles and the lists of triangles
  const std::string thin = refusal(kTriangle, grid, 0.5, options);
  EXPECT_EQ(thin.find("smaller thickness"), std::string::npos) << thin;
  options.memory_limit = 1;
  const std::string none = refusal(kTriangle, grid, 0.5, options);
  EXPECT_EQ(none.find("take"), std::string::npos) << none;
  EXPECT_NE(none.find("; give a higher limit"), std::string::npos) << none;
}

TEST(Memory, WhenThereIsNoneItIsALimitError) {
  const Mesh mesh = random_soup(5, 500, 4, 1);
  const Grid grid = cube(100, {-5, -5, -5}, 10);
  std::vector<float> values(static_cast<std::size_t>(grid.sample_count()));
  const auto expect_refused = [](std::int64_t bytes, const std::string& words, auto call) {
    const auto limited = [&] {
      const Limit here(bytes);
      call();
    };
    expect_error(limited, ErrorCode::limit, words);
  };
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.threads = 1, .backend = Backend::cpu}};
  for (const std::int64_t bytes : {10'000, 40'000}) {
    expect_refused(bytes, "not enough memory", [&] { compute(mesh, grid, 0.5, options); });
    expect_refused(bytes, "not enough memory", [&] { compute_into(mesh, grid, 0.5, values, options); });
  }
  const TempFolder folder;
  const auto path = folder / "a.obj";
  write_mesh(path, mesh);
  const auto file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
  expect_refused(file_bytes + 10'000, "not enough memory for its triangles", [&] { read_mesh(path); });
}

// Both were rounded up to MiB: "needs 1 MiB, more than the limit of 1 MiB".
TEST(Memory, ALimitAndWhatIsOverItLookDifferent) {
  struct {
    double needed, limit;
    const char* text;
  } const cases[] = {{2, 1, "2 B, more than the limit of 1 B"},
                     {1025, 1024, "2 KiB, more than the limit of 1 KiB"},
                     {1'060'000, 1'050'000, "1036 KiB, more than the limit of 1025 KiB"},
                     {(1 << 20) + 1, 1 << 20, "2 MiB, more than the limit of 1 MiB"},
                     {5e9, 160.5 * (1 << 20), "4769 MiB, more than the limit of 160 MiB"}};
  for (const auto& c : cases) EXPECT_EQ(over_the_limit(c.needed, c.limit), c.text);
}

}  // namespace
}  // namespace standoff::testing
