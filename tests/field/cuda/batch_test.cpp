// SPDX-License-Identifier: Apache-2.0
// standoff/cuda_batch.h, emulated: the fields of many meshes at once have the bits of compute(); what is wrong with one
// of them is told, and touches no other.
// labels: memory threads
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "backends/cuda/fields.h"
#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/cuda_batch.h"
#include "standoff/error.h"
#include "tests/support/fields.h"
#include "tests/support/mesh_batch.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using cuda::BatchTask;
using cuda::Outcome;
using emulation::Order;
using emulation::OrderScope;
using testing::MeshBatch;

const Size3 kSize{21, 18, 13};  // tiles cut on every axis
constexpr float kRubbish = -77;

// Meshes, outputs and a workspace as a caller on the device would have them, all filled with rubbish.
class Batch {
 public:
  explicit Batch(MeshBatch meshes, const Size3& size = kSize) : meshes_(std::move(meshes)) {
    task = meshes_.sizes(size);
    task.vertices = task.vertex_count > 0 ? &meshes_.vertices.data()->x : nullptr;
    task.triangles = task.triangle_count > 0 ? meshes_.triangles.data()->data() : nullptr;
    task.first_vertex = meshes_.first_vertex.data();
    task.first_triangle = meshes_.first_triangle.data();
    task.places = meshes_.places.data();
    outcomes.resize(meshes_.places.size());
    std::memset(outcomes.data(), 0xcd, outcomes.size() * sizeof(Outcome));
    std::memset(&total, 0xcd, sizeof total);
    task.outcomes = outcomes.data();
    task.total = &total;
    values.assign(static_cast<std::size_t>(task.count * size.count()), kRubbish);
    nearest.assign(values.size(), 4711);
    task.values = values.data();
    task.nearest = nearest.data();
    give_entries(cuda::likely_entries(task));
  }

  void give_entries(std::int64_t entries) {
    bytes = emulated::workspace_bytes(task, entries);
    memory_.assign(static_cast<std::size_t>(bytes) + 256, static_cast<char>(0xcd));
  }
  void* workspace() {
    const auto at = reinterpret_cast<std::uintptr_t>(memory_.data());
    return memory_.data() + (256 - at % 256) % 256;
  }
  void run() { emulated::enqueue(task, workspace(), bytes); }

  // The field of mesh n has the bits of the CPU's, and its counts.
  void expect_field(std::size_t n) const {
    SCOPED_TRACE("mesh " + std::to_string(n));
    ASSERT_EQ(outcomes[n].stopped, 0u);
    EXPECT_NO_THROW(cuda::check(outcomes[n], task));
    const std::size_t samples = static_cast<std::size_t>(task.size.count());
    const auto first = static_cast<std::int64_t>(n * samples), end = first + task.size.count();
    const std::vector<float> mine(values.begin() + first, values.begin() + end);
    const std::vector<std::uint32_t> mine_nearest(nearest.begin() + first, nearest.begin() + end);
    const auto& m = meshes_;
    const std::int64_t triangles = m.first_triangle[n + 1] - m.first_triangle[n];
    if (triangles == 0) {
      const auto thickness = static_cast<float>(m.places[n].thickness);
      EXPECT_EQ(mine, std::vector<float>(samples, thickness));
      EXPECT_EQ(mine_nearest, std::vector<std::uint32_t>(samples, kNoTriangle));
      return;
    }
    const Mesh mesh{{m.vertices.begin() + m.first_vertex[n], m.vertices.begin() + m.first_vertex[n + 1]},
                    {m.triangles.begin() + m.first_triangle[n], m.triangles.begin() + m.first_triangle[n + 1]}};
    ComputeOptions options{.sign = {SignMethod::none}};
    options.execution.backend = Backend::cpu;
    options.skip.kind = SkipRule::Kind::none;
    options.nearest = true;
    const ComputeResult cpu = compute(mesh, m.grid(n, task.size), m.places[n].thickness, options);
    EXPECT_TRUE(testing::bits_of(mine) == testing::bits_of(cpu.field.to_dense()));
    EXPECT_TRUE(mine_nearest == testing::all_nearest(cpu.field));
    EXPECT_EQ(outcomes[n].samples_band, static_cast<unsigned long long>(cpu.report.samples_band));
  }
  void expect_all_but(const std::vector<std::size_t>& others) const {
    for (std::size_t n = 0; n < outcomes.size(); ++n)
      if (std::find(others.begin(), others.end(), n) == others.end()) expect_field(n);
  }
  void expect_unwritten(std::size_t n) const {
    const std::size_t samples = static_cast<std::size_t>(task.size.count());
    for (std::size_t s = n * samples; s < (n + 1) * samples; ++s) {
      ASSERT_EQ(values[s], kRubbish) << n;
      ASSERT_EQ(nearest[s], 4711u) << n;
    }
  }
  void expect_nothing_written() const {
    for (std::size_t n = 0; n < outcomes.size(); ++n) {
      expect_unwritten(n);
      EXPECT_NE(outcomes[n].stopped, 0u);
    }
    EXPECT_NE(total.stopped, 0u);
  }
  ErrorCode code_of(const Outcome& outcome) const {
    try {
      cuda::check(outcome, task);
    } catch (const Error& error) {
      said = error.what();
      return error.code();
    }
    ADD_FAILURE() << "no error";
    return ErrorCode::internal;
  }

  BatchTask task;
  std::vector<Outcome> outcomes;
  Outcome total;
  std::int64_t bytes = 0;
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;
  mutable std::string said;  // by the last error

 private:
  MeshBatch meshes_;
  std::vector<char> memory_;
};

// Around a mesh, with these spacings' proportions.
cuda::BatchPlace around(const Mesh& mesh, Vec3 proportions, double thickness_in_spacings, const Size3& size = kSize) {
  const Box box = bounds(mesh);
  const Vec3 counts{double(size.x), double(size.y), double(size.z)};
  const Vec3 spacing = proportions * ((box.extent() / counts).x + (box.extent() / counts).y + 0.01);
  return {box.center() - 0.5 * spacing * counts, spacing,
          thickness_in_spacings * std::max({spacing.x, spacing.y, spacing.z})};
}

// One triangle, an empty mesh, a soup, slivers and copies, long triangles, a scene, one beside its grid.
MeshBatch some_meshes() {
  MeshBatch all;
  const Mesh one = testing::random_soup(201, 1, 1, 1, {50, 2, -7});
  const Mesh soup = testing::random_soup(202, 300, 4, 0.8, {1e5, -3e4, 12});
  const Mesh nasty = testing::nasty_soup(203, 50, 6), wide = testing::random_soup(204, 20, 8, 30);
  const Mesh scene = scenes::make("catapult", 700);
  all.add(one, around(one, {1, 1, 1}, 2));
  all.add({}, {{3, 4, 5}, {1, 2, 0.5}, 0.75});
  all.add(soup, around(soup, {0.5, 0.4, 0.6}, 4));
  all.add({}, {{}, {1, 1, 1}, 2.5});
  all.add({}, {{}, {1, 1, 1}, 1.5});
  all.add(nasty, {{-6, -5, -4.5}, {0.5, 0.45, 0.7}, 0.9});
  all.add(wide, {{-5, -5, -5}, {0.5, 0.5, 0.75}, 1.1});
  all.add(scene, around(scene, {0.6, 0.6, 0.9}, 1.5));
  all.add(one, {{-500, 0, 0}, {0.125, 0.125, 0.125}, 0.3});
  return all;
}

TEST(CudaBatch, EveryFieldHasTheBitsOfTheCpu) {
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    SCOPED_TRACE("order " + std::to_string(static_cast<int>(order)));
    const OrderScope scope(order, 12);
    Batch batch(some_meshes());
    batch.run();
    EXPECT_NO_THROW(cuda::check(batch.total, batch.task));
    batch.expect_all_but({});
    unsigned long long band = 0, examined = 0, entries = 0;
    for (const Outcome& outcome : batch.outcomes) {
      band += outcome.samples_band;
      examined += outcome.samples_examined;
      entries += outcome.needed_entries;
    }
    EXPECT_GT(band, 1000u);
    EXPECT_EQ(batch.total.samples_band, band);
    EXPECT_EQ(batch.total.samples_examined, examined);
    EXPECT_EQ(batch.total.needed_entries, entries);
  }
}

TEST(CudaBatch, NearestTrianglesAreAFreeChoice) {
  Batch batch(some_meshes()), with_nearest(some_meshes());
  batch.task.nearest = nullptr;
  batch.run();
  with_nearest.run();
  EXPECT_TRUE(testing::bits_of(batch.values) == testing::bits_of(with_nearest.values));
  EXPECT_TRUE(std::all_of(batch.nearest.begin(), batch.nearest.end(), [](std::uint32_t n) { return n == 4711; }));
}

// Lists that are cut into parts, one of them of the last field; and long triangles that many warps share.
TEST(CudaBatch, CrowdedTilesAndTrianglesAcrossManyTiles) {
  MeshBatch all;
  const Mesh crowd = testing::random_soup(205, 700, 0.7, 0.5), other = testing::random_soup(206, 40, 3, 1);
  const cuda::BatchPlace place{{-4, -4, -4}, {1, 1, 1}, 1.5};
  all.add(crowd, place);
  all.add(other, place);
  all.add(crowd, place);
  Batch crowded(std::move(all), {9, 8, 8});
  crowded.run();
  crowded.expect_all_but({});

  Mesh flat = testing::random_soup(207, 20, 100, 3, {140, 130, 4});
  testing::add_triangle(flat, {1, 2, 3}, {270, 263, 4}, {265, 263, 4.5});
  MeshBatch two;
  two.add(other, {{-4, -4, -4}, {1, 1, 1}, 1.5});
  two.add(flat, {{0, 0, 0}, {1, 1, 1}, 1.5});
  Batch across(std::move(two), {272, 264, 8});
  across.run();
  across.expect_all_but({});
}

TEST(CudaBatch, WhatIsWrongWithAMeshTouchesNoOther) {
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    const OrderScope scope(order, 13);
    MeshBatch all = some_meshes();
    const auto triangle = [&](std::size_t mesh, std::int64_t n) -> Triangle& {
      return all.triangles[static_cast<std::size_t>(all.first_triangle[mesh] + n)];
    };
    // An index of the next mesh's vertices is out of range too; of several bad triangles, the first one is named.
    triangle(2, 290)[0] = 4000000000u;
    triangle(2, 120)[1] = static_cast<std::uint32_t>(all.first_vertex[3] - all.first_vertex[2]);
    const std::uint32_t vertex = triangle(7, 31)[2];
    all.vertices[static_cast<std::size_t>(all.first_vertex[7]) + vertex].y = std::numeric_limits<double>::quiet_NaN();
    std::int64_t first_bad = 31;
    for (std::int64_t n = 0; n < first_bad; ++n)
      if (std::ranges::find(triangle(7, n), vertex) != triangle(7, n).end()) first_bad = n;
    Batch batch(std::move(all));
    batch.run();
    EXPECT_NO_THROW(cuda::check(batch.total, batch.task));
    batch.expect_all_but({2, 7});
    EXPECT_EQ(batch.outcomes[2].bad_triangle, 120u);
    EXPECT_EQ(batch.outcomes[7].bad_triangle, static_cast<unsigned long long>(first_bad));
    EXPECT_EQ(batch.code_of(batch.outcomes[2]), ErrorCode::input);
    EXPECT_NE(batch.said.find("triangle 120"), std::string::npos) << batch.said;
    EXPECT_EQ(batch.code_of(batch.outcomes[7]), ErrorCode::input);
    batch.expect_unwritten(2);
    batch.expect_unwritten(7);
  }
}

TEST(CudaBatch, PlacesThatAreNotValidAreTold) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<cuda::BatchPlace> bad{
      {{0, 0, 0}, {1, 1, 1}, 0},          {{0, 0, 0}, {1, 1, 1}, -1},          {{0, 0, 0}, {1, 1, 1}, kNan},
      {{0, 0, 0}, {1, 1, 1}, 4.001},      {{0, 0, 0}, {1, 1, 1}, testing::kInfinity},
      {{0, 0, 0}, {1, 0, 1}, 1},          {{0, 0, 0}, {1, 1, -1}, 1},          {{0, 0, 0}, {kNan, 1, 1}, 1},
      {{0, 0, 0}, {1, 1, 1e-19}, 1},      {{0, kNan, 0}, {1, 1, 1}, 1},        {{0, 0, testing::kInfinity}, {1, 1, 1}, 1},
      {{0, 0, 0}, {1e31, 1e31, 1e31}, 1}, {{0, 0, 0}, {1e-34, 1e-34, 1e-34}, 1e-34},
  };
  MeshBatch all;
  const Mesh mesh = testing::random_soup(208, 40, 4, 1);
  const cuda::BatchPlace good{{-4, -4, -3}, {0.5, 0.5, 0.5}, 2};  // as thick as may be
  std::vector<std::size_t> failing;
  all.add(mesh, good);
  for (const cuda::BatchPlace& place : bad) {
    failing.push_back(all.places.size());
    all.add(mesh, place);
    all.add(mesh, good);
  }
  Batch batch(std::move(all));
  batch.run();
  EXPECT_NO_THROW(cuda::check(batch.total, batch.task));
  batch.expect_all_but(failing);
  for (const std::size_t n : failing) {
    SCOPED_TRACE(n);
    batch.expect_unwritten(n);
    EXPECT_EQ(batch.outcomes[n].bad_triangle, Outcome::kNone);
    ASSERT_NE(batch.outcomes[n].stopped, 0u);
    EXPECT_EQ(batch.code_of(batch.outcomes[n]), ErrorCode::usage);
    EXPECT_NE(batch.said.find("place"), std::string::npos) << batch.said;
  }
}

TEST(CudaBatch, NumbersThatDoNotAscendStopAll) {
  const auto stopped = [](auto change) {
    MeshBatch all = some_meshes();
    Batch batch(all);
    change(all);
    batch.task.first_vertex = all.first_vertex.data();
    batch.task.first_triangle = all.first_triangle.data();
    batch.run();
    batch.expect_nothing_written();
    EXPECT_EQ(batch.code_of(batch.total), ErrorCode::usage);
    EXPECT_EQ(batch.code_of(batch.outcomes[1]), ErrorCode::usage);
    EXPECT_NE(batch.said.find("ascend"), std::string::npos) << batch.said;
  };
  stopped([](MeshBatch& m) { std::swap(m.first_triangle[2], m.first_triangle[6]); });
  stopped([](MeshBatch& m) { std::swap(m.first_vertex[2], m.first_vertex[6]); });
  stopped([](MeshBatch& m) { m.first_triangle[5] = 1'000'000'000'000; });
  stopped([](MeshBatch& m) { m.first_vertex[5] = -1'000'000'000'000; });
  stopped([](MeshBatch& m) { m.first_triangle.front() = 1; });
  stopped([](MeshBatch& m) { m.first_vertex.front() = -1; });
  stopped([](MeshBatch& m) { --m.first_triangle.back(); });
  stopped([](MeshBatch& m) { ++m.first_vertex.back(); });
}

TEST(CudaBatch, TooFewEntriesAreReportedAndNothingIsWritten) {
  Batch batch(some_meshes());
  batch.give_entries(5);
  batch.run();
  batch.expect_nothing_written();
  EXPECT_EQ(batch.code_of(batch.total), ErrorCode::limit);
  EXPECT_NE(batch.said.find(std::to_string(batch.total.needed_entries)), std::string::npos) << batch.said;
  EXPECT_EQ(batch.code_of(batch.outcomes[0]), ErrorCode::limit);
  // What it asked for suffices, and one less does not.
  const auto needed = static_cast<std::int64_t>(batch.total.needed_entries);
  batch.give_entries(needed);
  batch.run();
  EXPECT_EQ(batch.total.stopped, 0u);
  batch.expect_all_but({});
  Batch again(some_meshes());
  again.give_entries(needed - 1);
  again.bytes -= 4;
  again.run();
  again.expect_nothing_written();
}

TEST(CudaBatch, NoMeshAndMeshesWithoutTriangles) {
  Batch none{MeshBatch{}};
  none.run();
  EXPECT_EQ(none.total.stopped, 0u);
  EXPECT_EQ(none.total.samples_band, 0u);

  MeshBatch empty;
  for (int n = 0; n < 300; ++n) empty.add({}, {{}, {1, 1, 1}, 0.01 * (n + 1)});
  Batch batch(std::move(empty), {3, 2, 9});
  batch.run();
  batch.expect_all_but({});
}

TEST(CudaBatch, CallsThatMakeNoSenseAreRefused) {
  Batch batch(some_meshes());
  const auto refused = [&](auto change) {
    const BatchTask whole = batch.task;
    change(batch.task);
    EXPECT_THROW(batch.run(), Error);
    batch.task = whole;
  };
  refused([](BatchTask& t) { t.count = -1; });
  refused([](BatchTask& t) { t.count = std::int64_t{1} << 60; });
  refused([](BatchTask& t) { t.vertex_count = -1; });
  refused([](BatchTask& t) { t.triangle_count = -1; });
  refused([](BatchTask& t) { t.triangle_count = 0xffffffff; });
  refused([](BatchTask& t) { t.size.y = 0; });
  refused([](BatchTask& t) { t.size.x = std::int64_t{1} << 41; });
  refused([](BatchTask& t) { t.vertices = nullptr; });
  refused([](BatchTask& t) { t.triangles = nullptr; });
  refused([](BatchTask& t) { t.first_vertex = nullptr; });
  refused([](BatchTask& t) { t.first_triangle = nullptr; });
  refused([](BatchTask& t) { t.places = nullptr; });
  refused([](BatchTask& t) { t.values = nullptr; });
  refused([](BatchTask& t) { t.outcomes = nullptr; });
  refused([](BatchTask& t) { t.total = nullptr; });
  EXPECT_THROW(emulated::workspace_bytes(batch.task, -1), Error);
  EXPECT_THROW(emulated::enqueue(batch.task, nullptr, batch.bytes), Error);
  EXPECT_THROW(emulated::enqueue(batch.task, static_cast<char*>(batch.workspace()) + 8, batch.bytes), Error);
  EXPECT_THROW(emulated::enqueue(batch.task, batch.workspace(), 100), Error);
  EXPECT_TRUE(std::all_of(batch.values.begin(), batch.values.end(), [](float v) { return v == kRubbish; }));
  EXPECT_NO_THROW(batch.run());
}

}  // namespace
}  // namespace standoff
