// SPDX-License-Identifier: Apache-2.0
// standoff/cuda_compute.h, emulated: meshes of every layout give the bits of the CPU's field, room for lists grows
// until they fit, and errors name the fault of a mesh. labels: memory threads
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "backends/cuda/fields.h"
#include "standoff/compute.h"
#include "standoff/cuda_compute.h"
#include "standoff/error.h"
#include "tests/field/cuda/on_stream.h"
#include "tests/support/fields.h"
#include "tests/support/on_stream.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

const Grid kStreamGrid{{21, 18, 13}, {-4, -4, -3}, {0.5, 0.5, 0.5}};

// Computes on the emulated device, over memory filled with rubbish.
std::vector<float> on_device(const MeshView& mesh, double thickness, Method method = Method::tiles) {
  std::vector<float> values(static_cast<std::size_t>(kStreamGrid.sample_count()), -77);
  testing::compute_one(mesh, kStreamGrid, thickness, values.data(), method, kEmulated);
  return values;
}

void expect_same(const MeshView& mesh) {
  for (const Method method : {Method::tiles, Method::thesis})
    for (const double thickness : {0.6, 3.0, testing::kInfinity}) {
      if (method == Method::thesis && thickness > 1) continue;
      EXPECT_TRUE(testing::bits_of(on_device(mesh, thickness, method)) ==
                  testing::bits_of(on_cpu(mesh, kStreamGrid, thickness, method)));
    }
  const Box found = testing::bounds_of_one(mesh, kEmulated), expected = bounds(mesh);
  EXPECT_EQ(found.min, expected.min);
  EXPECT_EQ(found.max, expected.max);
}

TEST(CudaStreams, EveryLayoutGivesTheBitsOfTheCpu) {
  Mesh mesh = testing::random_soup(71, 90, 4, 1.2);
  mesh.vertices.push_back({1e9, 1e9, 1e9});  // no triangle uses it
  for (Vec3& v : mesh.vertices)              // make all coordinates exact in float
    v = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  expect_same(mesh);
  expect_same(Strided<double, std::uint32_t>(mesh).view());
  expect_same(Strided<float, std::int32_t>(mesh).view());
  expect_same(Strided<float, std::int64_t>(mesh).view());
  expect_same(Strided<double, std::uint64_t>(mesh).view());
}

TEST(CudaStreams, ReportSaysWhatWasDone) {
  const Mesh mesh = testing::random_soup(71, 90, 4, 1.2);
  std::vector<float> values(static_cast<std::size_t>(kStreamGrid.sample_count()));
  const ComputeReport report = testing::compute_one(mesh, kStreamGrid, 1, values.data(), Method::tiles, kEmulated);
  EXPECT_EQ(report.backend, "emulated");
  EXPECT_EQ(report.provenance.method, "tiles");
  EXPECT_EQ(report.provenance.sign, "");
  EXPECT_EQ(report.triangles, 90);
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = testing::kEmulated;
  const ComputeReport host = compute_into(mesh, kStreamGrid, 1, values, options);
  EXPECT_EQ(report.samples_band, host.samples_band);
  EXPECT_EQ(report.tiles, host.tiles);
}

TEST(CudaStreams, RoomGrowsUntilTheListsFit) {
  const Mesh mesh = wide_triangles();
  constexpr double kThickness = 1.5;
  std::vector<float> values(static_cast<std::size_t>(kStreamGrid.sample_count()));
  cuda::Outcome outcome;
  cuda::Task task;
  task.mesh = {&mesh.vertices.data()->x, 900, mesh.triangles.data()->data(), 300};
  task.grid = kStreamGrid;
  task.thickness = kThickness;
  task.output.values = values.data();
  task.outcome = &outcome;
  const std::int64_t entries = cuda::likely_entries(300, kStreamGrid, kThickness);
  const std::int64_t bytes = emulated::workspace_bytes(300, kStreamGrid, kThickness, Method::tiles, entries);
  struct alignas(256) Block {
    char bytes[256];
  };
  std::vector<Block> memory(static_cast<std::size_t>(bytes) / 256 + 1);
  emulated::enqueue(task, memory.data(), bytes);
  ASSERT_NE(outcome.stopped, 0u) << "the estimate is enough: the test shows nothing";
  EXPECT_TRUE(testing::bits_of(on_device(mesh, kThickness)) == testing::bits_of(on_cpu(mesh, kStreamGrid, kThickness)));
}

template <class Index>
void expect_bad(Mesh mesh, Index index) {
  Strided<double, Index> bad(mesh);
  bad.indices[5 * 7 + 1] = index;
  float values[1];
  for (const bool only_bounds : {true, false}) try {
      if (only_bounds)
        testing::bounds_of_one(bad.view(), kEmulated);
      else
        testing::compute_one(bad.view(), kStreamGrid, 1, values, Method::tiles, kEmulated);
      ADD_FAILURE() << index;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_EQ(error.details().triangle, 7);
    }
}

TEST(CudaStreams, TheFirstBadTriangleIsNamed) {
  Mesh mesh = testing::random_soup(73, 40, 4, 1.2);
  expect_bad<std::uint32_t>(mesh, 120);
  expect_bad<std::int32_t>(mesh, -1);
  expect_bad<std::int64_t>(mesh, -1);
  expect_bad<std::int64_t>(mesh, std::int64_t{1} << 32);
  expect_bad<std::uint64_t>(mesh, ~std::uint64_t{0});
  mesh.vertices[mesh.triangles[7][2]].y = std::numeric_limits<double>::quiet_NaN();
  expect_bad<std::int64_t>(mesh, 0);
}

TEST(CudaStreams, ValuesAreCopiedOut) {
  const std::vector<float> values{3, 1, 4, 1, 5};
  std::vector<float> copied(4);
  cuda::copy_to_host(values.data() + 1, copied, kEmulated);
  EXPECT_EQ(copied, (std::vector<float>{1, 4, 1, 5}));
  EXPECT_THROW(cuda::copy_to_host(nullptr, copied, kEmulated), Error);
  EXPECT_THROW(cuda::copy_to_host(values.data(), copied, {.backend = Backend::cpu}), Error);
}

TEST(CudaStreams, CallsThatMakeNoSenseAreRefused) {
  const Mesh mesh = testing::random_soup(74, 4, 4, 1.2);
  std::vector<float> values(static_cast<std::size_t>(kStreamGrid.sample_count()), -77);
  const auto code_of = [&](MeshView view, Grid grid, double thickness, float* to, cuda::OnStream on) {
    try {
      testing::compute_one(view, grid, thickness, to, Method::tiles, on);
      return ErrorCode::internal;
    } catch (const Error& error) {
      return error.code();
    }
  };
  float* const to = values.data();
  const Grid far{{8, 8, 8}, {1e30, 0, 0}, {1e-3, 1e-3, 1e-3}};
  EXPECT_EQ(code_of(mesh, kStreamGrid, 0, to, kEmulated), ErrorCode::usage);
  EXPECT_EQ(code_of(mesh, {{0, 1, 1}, {}}, 1, to, kEmulated), ErrorCode::usage);
  EXPECT_EQ(code_of(mesh, kStreamGrid, 1, nullptr, kEmulated), ErrorCode::usage);
  EXPECT_EQ(code_of({}, kStreamGrid, 1, to, kEmulated), ErrorCode::usage);
  EXPECT_EQ(code_of(mesh, far, 1, to, kEmulated), ErrorCode::limit);
  EXPECT_EQ(code_of(mesh, kStreamGrid, 1, to, {.backend = Backend::cpu}), ErrorCode::usage);
  EXPECT_EQ(code_of(mesh, kStreamGrid, 1, to, {.backend = Backend::automatic}), ErrorCode::usage);
  const double* const x = &mesh.vertices.data()->x;
  EXPECT_EQ(code_of({{x, 2, 20}, mesh.triangles}, kStreamGrid, 1, to, kEmulated), ErrorCode::usage);  // not aligned
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return v == -77; }));
}

}  // namespace
}  // namespace standoff
