// SPDX-License-Identifier: Apache-2.0
// standoff/cuda.h, emulated: dense and sparse output in memory that is not cleared, too little room, invalid triangles.
// labels: memory threads
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "backends/cuda/fields.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using cuda::Outcome;
using cuda::Task;

const Grid kDeviceGrid{{21, 18, 13}, {-4, -4, -3}, {0.5, 0.5, 0.5}};

// A mesh, an output and a workspace as a caller on the device would have them, all filled with rubbish.
class OnDevice {
 public:
  OnDevice(const Mesh& mesh, double thickness, Method method = Method::tiles) : mesh_(mesh) {
    task.mesh = {&mesh_.vertices.data()->x, static_cast<std::int64_t>(mesh_.vertices.size()),
                 mesh_.triangles.data()->data(), static_cast<std::int64_t>(mesh_.triangles.size())};
    task.grid = kDeviceGrid;
    task.thickness = thickness;
    task.method = method;
    task.outcome = &outcome;
    std::memset(&outcome, 0xcd, sizeof outcome);
    give_entries(cuda::likely_entries(task.mesh.triangle_count, kDeviceGrid, thickness, method));
  }

  void give_entries(std::int64_t entries) {
    bytes = emulated::workspace_bytes(task.mesh.triangle_count, task.grid, task.thickness, task.method, entries);
    memory_.assign(static_cast<std::size_t>(bytes) + 256, static_cast<char>(0xcd));
  }
  void dense() {
    values.assign(static_cast<std::size_t>(kDeviceGrid.sample_count()), kRubbish);
    nearest.assign(values.size(), 4711);
    slots.clear();
    task.output = {values.data(), nearest.data(), nullptr, 0};
  }
  void sparse(std::int64_t capacity) {
    values.assign(static_cast<std::size_t>(capacity) * 512, kRubbish);
    nearest.assign(values.size(), 4711);
    slots.assign(3 * 3 * 2, 4711);
    task.output = {values.data(), nearest.data(), slots.data(), capacity};
  }
  void expect_nothing_written() const {
    for (const float value : values) ASSERT_EQ(value, kRubbish);
    for (const std::int32_t slot : slots) ASSERT_EQ(slot, 4711);
  }
  void run() { emulated::enqueue(task, workspace(), bytes); }
  void* workspace() {
    const auto at = reinterpret_cast<std::uintptr_t>(memory_.data());
    return memory_.data() + (256 - at % 256) % 256;
  }

  static constexpr float kRubbish = -77;
  Task task;
  Outcome outcome;
  std::int64_t bytes = 0;
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;
  std::vector<std::int32_t> slots;

 private:
  const Mesh& mesh_;
  std::vector<char> memory_;
};

Mesh some_mesh() { return testing::random_soup(61, 120, 4, 1.2); }

DistanceField expected(const Mesh& mesh, double thickness, Method method = Method::tiles) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = Backend::cpu;
  options.method = method;
  options.skip.kind = SkipRule::Kind::none;
  options.nearest = true;
  return compute(mesh, kDeviceGrid, thickness, options).field;
}

TEST(CudaDeviceMemory, DenseOutputIsWrittenEverywhere) {
  const Mesh mesh = some_mesh();
  for (const double thickness : {0.4, 1.0, 3.0, testing::kInfinity}) {
    OnDevice on(mesh, thickness);
    on.dense();
    on.run();
    cuda::check(on.outcome, on.task);
    const DistanceField field = expected(mesh, thickness);
    EXPECT_TRUE(testing::bits_of(on.values) == testing::bits_of(field.to_dense()));
    EXPECT_TRUE(on.nearest == testing::all_nearest(field));
  }
}

TEST(CudaDeviceMemory, SparseTilesAreThoseOfTheField) {
  const Mesh mesh = testing::random_soup(62, 10, 2, 0.5, {-2, -2, -2});
  for (const Method method : {Method::tiles, Method::thesis}) {
    OnDevice on(mesh, 0.6, method);
    on.sparse(18);
    on.run();
    cuda::check(on.outcome, on.task);
    const DistanceField field = expected(mesh, 0.6, method);
    ASSERT_LT(field.stored_tiles(), 18);
    std::int64_t index = 0, stored = 0;
    std::int32_t last = -1;
    for (int z = 0; z < 2; ++z)
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x, ++index) {
          const std::int32_t slot = on.slots[index];
          ASSERT_EQ(slot >= 0, field.tile(x, y, z).has_value()) << index;
          if (slot < 0) continue;
          EXPECT_GT(slot, last);
          last = slot;
          ++stored;
          EXPECT_EQ(std::memcmp(&on.values[512 * slot], field.tile(x, y, z)->data(), 512 * sizeof(float)), 0);
          EXPECT_EQ(std::memcmp(&on.nearest[512 * slot], field.tile_nearest(x, y, z)->data(), 512 * sizeof(float)), 0);
        }
    EXPECT_EQ(stored, field.stored_tiles());
  }
}

TEST(CudaDeviceMemory, TooFewEntriesAreReportedAndNothingIsWritten) {
  const Mesh mesh = some_mesh();
  for (const double thickness : {2.0, testing::kInfinity}) {
    OnDevice on(mesh, thickness);
    on.dense();
    on.give_entries(1);
    on.bytes = emulated::workspace_bytes(on.task.mesh.triangle_count, kDeviceGrid, thickness, Method::tiles, 0);
    on.run();
    EXPECT_NE(on.outcome.stopped, 0u);
    EXPECT_THROW(cuda::check(on.outcome, on.task), Error);
    on.expect_nothing_written();
    on.sparse(18);
    on.run();
    EXPECT_NE(on.outcome.stopped, 0u);
    on.expect_nothing_written();
    if (std::isinf(thickness)) continue;
    // The number of entries that it asked for suffices.
    on.dense();
    on.give_entries(static_cast<std::int64_t>(on.outcome.needed_entries));
    on.run();
    EXPECT_NO_THROW(cuda::check(on.outcome, on.task));
  }
}

TEST(CudaDeviceMemory, TooFewSlotsAreReportedAndNothingIsWritten) {
  const Mesh mesh = some_mesh();
  for (const Method method : {Method::tiles, Method::thesis}) {
    OnDevice on(mesh, 1.0, method);
    on.sparse(2);
    on.run();
    EXPECT_GT(on.outcome.needed_slots, 2u);
    try {
      cuda::check(on.outcome, on.task);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::limit);
    }
    on.expect_nothing_written();
  }
}

TEST(CudaDeviceMemory, BadTrianglesAreNamed) {
  for (const Method method : {Method::tiles, Method::thesis})
    for (const double thickness : {1.0, testing::kInfinity}) {
      Mesh mesh = some_mesh();
      mesh.triangles[70][1] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices[mesh.triangles[33][2]].y = std::numeric_limits<double>::quiet_NaN();
      mesh.vertices[mesh.triangles[90][0]].x = std::numeric_limits<double>::infinity();
      OnDevice on(mesh, thickness, method);
      on.dense();
      on.run();
      EXPECT_EQ(on.outcome.bad_triangle, 33u);
      try {
        cuda::check(on.outcome, on.task);
        ADD_FAILURE() << "no error";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        EXPECT_NE(std::string(error.what()).find("triangle 33"), std::string::npos);
      }
      on.expect_nothing_written();
      on.sparse(18);
      on.run();
      EXPECT_EQ(on.outcome.bad_triangle, 33u);
      on.expect_nothing_written();
    }
}

TEST(CudaDeviceMemory, OnlyTheTrianglesToUse) {
  const Mesh mesh = some_mesh();
  Mesh part;
  part.vertices = mesh.vertices;
  std::vector<std::uint32_t> kept;
  for (std::uint32_t t = 5; t < mesh.triangles.size(); t += 3) {
    kept.push_back(t);
    part.triangles.push_back(mesh.triangles[t]);
  }
  for (const double thickness : {1.0, testing::kInfinity}) {
    OnDevice on(mesh, thickness);
    on.task.mesh.kept = kept.data();
    on.task.mesh.kept_count = static_cast<std::int64_t>(kept.size());
    on.dense();
    on.run();
    cuda::check(on.outcome, on.task);
    const DistanceField field = expected(part, thickness);
    EXPECT_TRUE(testing::bits_of(on.values) == testing::bits_of(field.to_dense()));
    std::vector<std::uint32_t> nearest = testing::all_nearest(field);
    for (auto& n : nearest)
      if (n != kNoTriangle) n = kept[n];
    EXPECT_TRUE(on.nearest == nearest);
  }
}

// Meshes of different sizes on grids of one size share the largest of their workspaces.
TEST(CudaDeviceMemory, ManyMeshesInOneCall) {
  const Mesh first = some_mesh(), second = testing::random_soup(63, 30, 4, 2),
             third = testing::random_soup(64, 1, 1, 1);
  OnDevice a(first, testing::kInfinity), b(second, 1.0), c(third, 1.0, Method::thesis);
  const std::vector<OnDevice*> fields{&a, &b, &c};
  for (OnDevice* one : fields) one->dense();
  std::vector<Task> tasks{a.task, b.task, c.task};
  OnDevice& roomy =
      **std::max_element(fields.begin(), fields.end(), [](auto* x, auto* y) { return x->bytes < y->bytes; });
  emulated::enqueue(tasks, roomy.workspace(), roomy.bytes);
  for (OnDevice* one : fields) cuda::check(one->outcome, one->task);
  EXPECT_TRUE(testing::bits_of(a.values) == testing::bits_of(expected(first, testing::kInfinity).to_dense()));
  EXPECT_TRUE(testing::bits_of(b.values) == testing::bits_of(expected(second, 1.0).to_dense()));
  EXPECT_TRUE(testing::bits_of(c.values) == testing::bits_of(expected(third, 1.0, Method::thesis).to_dense()));

  // A single invalid task keeps all from being computed.
  for (OnDevice* one : fields) one->dense();
  tasks[2].thickness = 0;
  EXPECT_THROW(emulated::enqueue(tasks, roomy.workspace(), roomy.bytes), Error);
  a.expect_nothing_written();
}

TEST(CudaDeviceMemory, CallsThatMakeNoSenseAreRefused) {
  const Mesh mesh = some_mesh();
  OnDevice on(mesh, 1.0);
  on.dense();
  const auto refused = [&](auto change) {
    const Task whole = on.task;
    change(on.task);
    EXPECT_THROW(on.run(), Error);
    on.task = whole;
  };
  refused([](Task& task) { task.thickness = 0; });
  refused([](Task& task) { task.thickness = std::numeric_limits<double>::quiet_NaN(); });
  refused([](Task& task) { task.grid.size.x = 0; });
  refused([](Task& task) { task.mesh.triangle_count = 0; });
  refused([](Task& task) { task.mesh.vertices = nullptr; });
  refused([](Task& task) { task.output.values = nullptr; });
  refused([](Task& task) { task.outcome = nullptr; });
  on.sparse(18);
  refused([](Task& task) { task.output.slot_capacity = -1; });
  EXPECT_THROW(emulated::enqueue(on.task, static_cast<char*>(on.workspace()) + 8, on.bytes), Error);
  EXPECT_NO_THROW(on.run());
  on.bytes = 100;
  EXPECT_THROW(on.run(), Error);
}

}  // namespace
}  // namespace standoff
