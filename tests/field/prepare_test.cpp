// SPDX-License-Identifier: Apache-2.0
// The step before the backend: which of several faults it reports, and what is no fault.
#include "field/prepare.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "scenes/scenes.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Nearly all tiles of this large grid lie far from the mesh: only the triangles decide whether the field fits.
const Grid kPrepareGrid{{400, 400, 400}, {-10, -10, -10}, {0.05, 0.05, 0.05}};
constexpr double kThickness = 0.1;

Mesh small_mesh() { return testing::random_soup(401, 50, 1, 0.5); }

ComputeOptions limited(std::int64_t bytes) {
  return {.sign = {SignMethod::none}, .execution = {.backend = Backend::cpu}, .memory_limit = bytes};
}

MeshScan look(const Mesh& mesh) {
  const ComputeOptions options = limited(0);
  const Plan plan =
      make_plan(static_cast<std::int64_t>(mesh.triangles.size()), kPrepareGrid, kThickness, options, false);
  return scan_mesh(mesh, plan, true);
}

// The scan reads all vertices, also those that no triangle uses: these may be anything.
TEST(Prepare, VerticesThatNothingUsesDoNotMatter) {
  const Mesh mesh = small_mesh();
  const MeshScan expected = look(mesh);
  EXPECT_TRUE(expected.is_near);
  EXPECT_GT(expected.counts.tiles, 0);
  EXPECT_LT(expected.counts.tiles, 50 * 50 * 50);
  for (const Vec3 unused : {Vec3{kNan, 0, 0}, Vec3{0, kNan, 0}, Vec3{0, 0, -kNan}, Vec3{1e300, 0, 0}}) {
    Mesh more = mesh;
    more.vertices.push_back(unused);
    EXPECT_FALSE(look(more).is_near);
    EXPECT_EQ(look(more).counts.tiles, expected.counts.tiles);
    const ComputeOptions options = limited(std::int64_t{1} << 27);
    EXPECT_EQ(compute(more, kPrepareGrid, kThickness, options).report.samples_band,
              compute(mesh, kPrepareGrid, kThickness, options).report.samples_band);
  }
}

// An invalid mesh is reported first, then too little memory, then a mesh too far away.
TEST(Prepare, TheFirstFaultIsTold) {
  const auto message = [](const Mesh& mesh, std::int64_t bytes) -> std::string {
    try {
      compute(mesh, kPrepareGrid, kThickness, limited(bytes));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Mesh mesh = small_mesh();
  EXPECT_EQ(message(mesh, 0), "");
  EXPECT_NE(message(mesh, 1000).find("may need"), std::string::npos);

  mesh.vertices[mesh.triangles[7][1]].x = 1e30;
  EXPECT_NE(message(mesh, 0).find("triangle 7 is farther than"), std::string::npos) << message(mesh, 0);
  EXPECT_NE(message(mesh, 1000).find("may need"), std::string::npos);

  mesh.vertices[mesh.triangles[9][2]].y = kNan;
  for (const std::int64_t bytes : {0, 1000})
    EXPECT_NE(message(mesh, bytes).find("triangle 9: vertex"), std::string::npos) << message(mesh, bytes);

  mesh = small_mesh();
  mesh.triangles[11][0] = 4'000'000;
  for (const std::int64_t bytes : {0, 1000})
    EXPECT_NE(message(mesh, bytes).find("triangle 11: index 4000000"), std::string::npos) << message(mesh, bytes);

  mesh.triangles.clear();
  for (const std::int64_t bytes : {0, 1000})
    EXPECT_NE(message(mesh, bytes).find("no triangles"), std::string::npos) << message(mesh, bytes);
}

// What is predicted is never less than what is stored, and not much more: on fine meshes, soups and triangles that
// cross the whole grid.
TEST(Prepare, TilesThatMayBeStored) {
  const auto stored = [](const Mesh& mesh, const Grid& grid, double thickness, const SignOptions& sign) {
    ComputeOptions options = limited(0);
    options.sign = sign;
    const auto found = static_cast<double>(compute(mesh, grid, thickness, options).report.tiles_stored);
    const auto most = static_cast<double>(estimate(mesh, grid, thickness, options).stored_samples / kTileSamples);
    EXPECT_GE(most, found);
    return most / found;
  };
  const Grid grid{{200, 200, 200}, {-1, -1, -1}, {0.01, 0.01, 0.01}};
  const Mesh ball = scenes::make("sphere", 20'000);
  for (const SignOptions& sign : {SignOptions{SignMethod::none}, SignOptions{SignMethod::winding}}) {
    EXPECT_LT(stored(ball, grid, 0.02, sign), 1.5);
    EXPECT_LT(stored(ball, grid, 0.1, sign), 1.3);
  }
  for (unsigned seed = 1; seed < 20; ++seed) {
    stored(testing::random_soup(seed, 30, 1, 0.1), grid, 0.003, {SignMethod::none});
    EXPECT_LT(stored(testing::random_soup(seed, 3, 1, 1.5), grid, 0.02, {SignMethod::none}), 8);
  }
  // However thick a band is, a triangle reaches few blocks: this took minutes when it reached all tiles of its band.
  const Mesh fine = scenes::make("sphere", 500'000);
  EXPECT_LT(static_cast<double>(estimate(fine, grid, 1.5, limited(0)).stored_samples), 1.1 * 200 * 200 * 200);
  // Slivers have no plane.
  const Mesh needle{{{-1, -1, -1}, {1, 1, 1}, {0, 0, 0}}, {{0, 1, 2}}};
  stored(needle, grid, 0.02, {SignMethod::none});
}

// A limit that the estimate keeps is kept: dense output used to be refused for what any mesh may take.
TEST(Prepare, DenseOutputFitsWhereTheEstimateSaysSo) {
  const Grid grid{{200, 200, 200}, {-1, -1, -1}, {0.01, 0.01, 0.01}};
  const Mesh ball = scenes::make("sphere", 20'000);
  std::vector<float> values(static_cast<std::size_t>(grid.sample_count()));
  ComputeOptions options = limited(0);
  options.memory_limit = estimate(ball, grid, 0.02, options).dense;
  EXPECT_GT(compute_into(ball, grid, 0.02, values, options).samples_band, 0);
  options.memory_limit -= 1;
  EXPECT_THROW(compute_into(ball, grid, 0.02, values, options), Error);
}

}  // namespace
}  // namespace standoff
