// SPDX-License-Identifier: Apache-2.0
#include "standoff/inspect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "tests/support/expect_error.h"
#include "tests/support/heap.h"

namespace standoff {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const Mesh kTetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

TEST(Inspect, AClosedMesh) {
  const MeshSummary found = inspect(kTetrahedron);
  EXPECT_TRUE(found.closed());
  EXPECT_EQ(found.bounds.min, (Vec3{0, 0, 0}));
  EXPECT_EQ(found.bounds.max, (Vec3{1, 1, 1}));
  EXPECT_DOUBLE_EQ(found.area, 1.5 + std::sqrt(3.0) / 2);
  EXPECT_EQ(found.degenerate, 0);
  EXPECT_EQ(found.duplicate, 0);
}

TEST(Inspect, AnOpenMeshHasBoundaryEdges) {
  Mesh mesh = kTetrahedron;
  mesh.triangles.pop_back();
  const MeshSummary found = inspect(mesh);
  EXPECT_FALSE(found.closed());
  EXPECT_EQ(found.boundary_edges, 3);
  EXPECT_EQ(found.nonmanifold_edges, 0);
}

TEST(Inspect, DuplicatesInAnyOrderMakeEdgesNonmanifold) {
  Mesh mesh = kTetrahedron;
  mesh.triangles.push_back({3, 2, 1});
  mesh.triangles.push_back({2, 1, 3});
  const MeshSummary found = inspect(mesh);
  EXPECT_EQ(found.duplicate, 2);
  EXPECT_EQ(found.nonmanifold_edges, 3);
  EXPECT_FALSE(found.closed());
}

TEST(Inspect, TrianglesWithoutArea) {
  Mesh mesh = kTetrahedron;
  mesh.vertices.push_back({2, 0, 0});
  mesh.triangles.push_back({0, 0, 1});  // names a vertex twice: no edges
  EXPECT_EQ(inspect(mesh).degenerate, 1);
  EXPECT_TRUE(inspect(mesh).closed());
  mesh.triangles.push_back({0, 1, 4});  // three vertices on a line: its edges count
  EXPECT_EQ(inspect(mesh).degenerate, 2);
  EXPECT_EQ(inspect(mesh).nonmanifold_edges, 1);
  EXPECT_EQ(inspect(mesh).boundary_edges, 2);
}

TEST(Inspect, UnusableMeshesAreErrors) {
  expect_error([] { inspect(Mesh{}); }, ErrorCode::input, "no triangles");
  Mesh mesh = kTetrahedron;
  mesh.triangles[2][1] = 4;
  expect_error([&] { inspect(mesh); }, ErrorCode::input, "triangle 2");
}

// A field with nearest triangles counts as compute() does, one without them by its values: both say the same of samples
// none of which is exactly as far as the thickness.
TEST(Inspect, TheBandOfAField) {
  const Mesh mesh = scenes::make("sphere", 500);
  const Grid grid = fit_samples(bounds(mesh), 37);
  ComputeOptions options;
  options.execution.backend = Backend::cpu;
  const double thickness = 2.5 * grid.spacing.x;
  const ComputeResult plain = compute(mesh, grid, thickness, options);
  options.nearest_triangle = true;
  const ComputeResult nearest = compute(mesh, grid, thickness, options);
  for (const ComputeResult* computed : {&plain, &nearest}) {
    const FieldSummary found = inspect(computed->field);
    EXPECT_EQ(found.band, computed->report.samples_band);
    EXPECT_GE(found.min, 0);
    EXPECT_EQ(found.max, double{static_cast<float>(thickness)});
    EXPECT_EQ(found.nan, 0);
  }
}

// Values as far inside as the thickness were clamped too: they are no band.
TEST(Inspect, TheBandOfASignedField) {
  const Grid grid{{24, 8, 8}, {}, {1, 1, 1}};
  std::vector<float> values;
  for (int n = 0; n < 24 * 64; ++n) values.push_back(static_cast<float>(std::min(n % 24 - 12, 3)) / 2);
  for (float& value : values) value = std::max(value, -1.5f);
  const DistanceField field = DistanceField::from_dense(grid, 1.5, values);
  ASSERT_EQ(field.background(0, 0, 0), -1.5f);
  const FieldSummary found = inspect(field);
  EXPECT_EQ(found.min, -1.5);
  EXPECT_EQ(found.max, 1.5);
  EXPECT_EQ(found.band, 5 * 64) << "-1 to 1 in steps of a half";
}

TEST(Inspect, ValuesThatAreNoNumberAreCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> values{nan, 1, -3, 2, 4, 4, nan, 0.5f};
  const FieldSummary found = inspect(DistanceField::from_dense({{2, 2, 2}}, 4, values));
  EXPECT_EQ(found.nan, 2);
  EXPECT_EQ(found.min, -3);
  EXPECT_EQ(found.max, 4);
  EXPECT_EQ(found.band, 4) << "a value that equals the thickness may have been clamped";
  const FieldSummary none = inspect(DistanceField::from_dense({{1, 1, 1}}, 4, std::vector<float>{nan}));
  EXPECT_EQ(none.nan, 1);
  EXPECT_EQ(none.min, kInfinity);
  EXPECT_EQ(none.max, -kInfinity);
}

// A slice of all samples was made, and each of them looked at: half a minute for a file of 12 kB.
TEST(Inspect, TilesThatAreNotStoredTakeNoMemory) {
  const DistanceField field({{1 << 12, 1 << 12, 1}, {}, {1, 1, 1}}, 3);
  FieldSummary found;
  EXPECT_EQ(testing::heap::most_held([&] { found = inspect(field); }), 0);
  EXPECT_EQ(found.min, 3);
  EXPECT_EQ(found.max, 3);
  EXPECT_EQ(found.band, 0);
}

// One sample of the last tile is in the grid; what lies beyond counts for nothing.
TEST(Inspect, SamplesBeyondTheGridDoNotCount) {
  DistanceField field({{9, 9, 9}, {}, {1, 1, 1}}, 3, true);
  std::ranges::fill(field.store_tile(1, 1, 1), 2.0f);
  std::ranges::fill(field.store_nearest(1, 1, 1), 7u);
  field.mark_inside(0, 0, 0);
  const FieldSummary found = inspect(field);
  EXPECT_EQ(found.min, -3);
  EXPECT_EQ(found.max, 3);
  EXPECT_EQ(found.band, 1);
}

}  // namespace
}  // namespace standoff
