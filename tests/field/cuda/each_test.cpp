// SPDX-License-Identifier: Apache-2.0
// Many meshes in one call of standoff/cuda_compute.h, emulated: each field has the CPU's bits, an error concerns a
// single mesh, and meshes that do not fit into memory together are computed in parts. labels: memory threads
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <variant>
#include <vector>

#include "backends/cuda/fields.h"
#include "gpu/platform_emulated.h"
#include "standoff/compute.h"
#include "standoff/cuda_compute.h"
#include "standoff/error.h"
#include "tests/field/cuda/on_stream.h"
#include "tests/support/fields.h"
#include "tests/support/on_stream.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using cuda::FieldRequest;

// Meshes, and memory for their fields, filled with rubbish.
struct Batch {
  void add(const MeshView& mesh, const Grid& grid, double thickness, Method method = Method::tiles) {
    fields.emplace_back(static_cast<std::size_t>(grid.sample_count()), -77.0f);
    requests.push_back({mesh, grid, thickness, fields.back().data(), method});
  }
  auto run() const { return cuda::compute_each(requests, kEmulated); }
  bool has_the_bits_of_the_cpu(std::size_t n) const {
    const FieldRequest& r = requests[n];
    return testing::bits_of(fields[n]) == testing::bits_of(on_cpu(r.mesh, r.grid, r.thickness, r.method));
  }
  bool is_untouched(std::size_t n) const { return fields[n] == std::vector<float>(fields[n].size(), -77.0f); }

  std::vector<std::vector<float>> fields;
  std::vector<FieldRequest> requests;
};

template <class Answer>
const Error* error_of(const cuda::OrError<Answer>& answer) {
  return std::get_if<Error>(&answer);
}

Grid grid_of(int samples, double spacing) {
  const double half = 0.5 * spacing * samples;
  return {{samples, samples - 1, samples + 2}, {-half, -half, -half}, {spacing, spacing, spacing}};
}

// While it lives, the GPU has this number of bytes.
class SmallGpu {
 public:
  explicit SmallGpu(std::int64_t bytes) : before_(emulated::memory_total) { emulated::memory_total = bytes; }
  ~SmallGpu() { emulated::memory_total = before_; }
  SmallGpu(const SmallGpu&) = delete;
  SmallGpu& operator=(const SmallGpu&) = delete;

 private:
  std::int64_t before_;
};

TEST(CudaEach, MeshesOfAllSizesLayoutsAndMethodsGiveTheBitsOfTheCpu) {
  std::vector<Mesh> meshes;
  for (int n = 0; n < 7; ++n) meshes.push_back(testing::random_soup(80u + static_cast<unsigned>(n), 1 << n, 4, 1.2));
  const Mesh wide = wide_triangles();  // whose lists do not fit at first
  const Strided<double, std::uint32_t> strided(meshes[4]);
  const Strided<float, std::int64_t> small_numbers(meshes[5]);
  Batch batch;
  for (std::size_t n = 0; n < meshes.size(); ++n) {
    batch.add(meshes[n], grid_of(9 + 2 * static_cast<int>(n), 0.5), 0.3 * static_cast<double>(n + 1));
    batch.add(meshes[n], grid_of(8, 1), testing::kInfinity);
  }
  batch.add(strided.view(), grid_of(17, 0.5), 0.6, Method::thesis);
  batch.add(wide, grid_of(21, 0.5), 1.5);
  batch.add(small_numbers.view(), grid_of(17, 0.5), 2);
  const auto answers = batch.run();
  ASSERT_EQ(answers.size(), batch.requests.size());
  for (std::size_t n = 0; n < answers.size(); ++n) {
    SCOPED_TRACE(n);
    ASSERT_EQ(error_of(answers[n]), nullptr) << error_of(answers[n])->what();
    EXPECT_TRUE(batch.has_the_bits_of_the_cpu(n));
    const FieldRequest& r = batch.requests[n];
    std::vector<float> alone(batch.fields[n].size());
    const ComputeReport expected = testing::compute_one(r.mesh, r.grid, r.thickness, alone.data(), r.method, kEmulated);
    const auto& report = std::get<ComputeReport>(answers[n]);
    EXPECT_EQ(report.method, r.method == Method::thesis ? "thesis" : "tiles");
    EXPECT_EQ(report.triangles, expected.triangles);
    EXPECT_EQ(report.samples, expected.samples);
    EXPECT_EQ(report.samples_examined, expected.samples_examined);
    EXPECT_EQ(report.samples_band, expected.samples_band);
  }
  EXPECT_EQ(emulated::memory_taken, 0);
}

TEST(CudaEach, ErrorsAreThoseOfSingleMeshes) {
  const Mesh good = testing::random_soup(91, 40, 4, 1.2);
  Mesh bad = good, infinite = good;
  bad.triangles[7][1] = 120;
  infinite.vertices[infinite.triangles[11][2]].y = std::numeric_limits<double>::infinity();
  const Grid grid = grid_of(12, 0.7), far{{8, 8, 8}, {1e30, 0, 0}, {1e-3, 1e-3, 1e-3}};
  Batch batch;
  batch.add(good, grid, 1);
  batch.add(bad, grid, 1);
  batch.add({}, grid, 1);
  batch.add(good, grid, 2);
  batch.add(good, grid, -1);
  batch.add(infinite, grid, 1);
  batch.add({{&good.vertices.data()->x, 2, 20}, good.triangles}, grid, 1);  // not aligned
  batch.add({{static_cast<const double*>(nullptr), 120}, good.triangles}, grid, 1);
  batch.add(good, grid, 1);
  batch.requests.back().grid = far;
  batch.add(good, grid, 1);
  batch.requests.back().grid.size.x = 0;
  batch.add(good, grid, 1);
  batch.requests.back().values = nullptr;
  batch.add(good, grid, testing::kInfinity);
  using enum ErrorCode;
  const std::vector<ErrorCode> expected{internal, input, usage, internal, usage, input,
                                        usage,    usage, limit, usage,    usage, internal};  // internal: none
  const auto answers = batch.run();
  ASSERT_EQ(answers.size(), expected.size());
  for (std::size_t n = 0; n < answers.size(); ++n) {
    SCOPED_TRACE(n);
    const Error* const error = error_of(answers[n]);
    ASSERT_EQ(error != nullptr, expected[n] != internal);
    if (!error) {
      EXPECT_TRUE(batch.has_the_bits_of_the_cpu(n));
      continue;
    }
    EXPECT_EQ(error->code(), expected[n]) << error->what();
    EXPECT_TRUE(batch.is_untouched(n));
    const FieldRequest& r = batch.requests[n];
    try {
      testing::compute_one(r.mesh, r.grid, r.thickness, r.values, r.method, kEmulated);
      ADD_FAILURE();
    } catch (const Error& alone) {
      EXPECT_STREQ(error->what(), alone.what());
    }
  }
  EXPECT_EQ(error_of(answers[1])->details().triangle, 7);
  EXPECT_EQ(error_of(answers[5])->details().triangle, 11);
}

// What only one field's launch or lists can tell is that field's error too.
TEST(CudaEach, OneFieldThatCannotBeStartedIsItsOwnError) {
  const Mesh mesh = testing::random_soup(91, 40, 4, 1.2);
  const Grid grid = grid_of(12, 0.7);
  Grid far = grid;
  far.origin = {1000, 1000, 1000};
  Batch batch;
  batch.add(mesh, grid, 1, Method::jumpflood);
  batch.add(mesh, far, 1, Method::jumpflood);  // no sample is near the surface
  batch.add(mesh, grid.window({4, 0, 0}, {8, 8, 8}), 1);
  batch.add(mesh, grid, 1);
  const auto answers = batch.run();
  EXPECT_EQ(error_of(answers[0]), nullptr);
  ASSERT_NE(error_of(answers[1]), nullptr);
  EXPECT_EQ(error_of(answers[1])->code(), ErrorCode::input) << error_of(answers[1])->what();
  ASSERT_NE(error_of(answers[2]), nullptr);
  EXPECT_EQ(error_of(answers[2])->code(), ErrorCode::usage);
  EXPECT_EQ(error_of(answers[3]), nullptr);
}

TEST(CudaEach, BoxesOfMany) {
  std::vector<Mesh> meshes;
  for (unsigned n = 0; n < 5; ++n) meshes.push_back(testing::random_soup(95 + n, 30, 4, 1.2));
  const Strided<double, std::int32_t> apart(meshes[0]);
  std::vector<MeshView> views(meshes.begin(), meshes.end());
  views.push_back(apart.view());
  meshes[2].triangles[29][0] = 4711;
  views[3] = {};
  const auto boxes = cuda::bounds_of_each(views, kEmulated);
  ASSERT_EQ(boxes.size(), 6u);
  for (const std::size_t n : {0, 1, 4, 5}) {
    const Box expected = bounds(views[n]);
    ASSERT_EQ(error_of(boxes[n]), nullptr);
    EXPECT_EQ(std::get<Box>(boxes[n]).min, expected.min);
    EXPECT_EQ(std::get<Box>(boxes[n]).max, expected.max);
  }
  ASSERT_NE(error_of(boxes[2]), nullptr);
  EXPECT_EQ(error_of(boxes[2])->details().triangle, 29);
  ASSERT_NE(error_of(boxes[3]), nullptr);
  EXPECT_EQ(error_of(boxes[3])->code(), ErrorCode::usage);
}

TEST(CudaEach, NoMeshesAndCallsWithoutADevice) {
  EXPECT_TRUE(cuda::compute_each({}, kEmulated).empty());
  EXPECT_TRUE(cuda::bounds_of_each({}, kEmulated).empty());
  const Mesh broken;
  Batch batch;
  batch.add(broken, grid_of(9, 1), 1);
  EXPECT_NE(error_of(batch.run()[0]), nullptr);
  EXPECT_NE(error_of(cuda::bounds_of_each(std::vector<MeshView>{broken}, kEmulated)[0]), nullptr);
  EXPECT_THROW(cuda::compute_each(batch.requests, {.backend = Backend::cpu}), Error);
  EXPECT_THROW(cuda::bounds_of_each({}, {.backend = Backend::automatic}), Error);
}

// Copies of ten meshes do not fit beside each other; one of the eleven fits nowhere.
TEST(CudaEach, WhatDoesNotFitAtOnceIsComputedInHalves) {
  const Mesh mesh = testing::random_soup(97, 2000, 4, 0.5), large = testing::random_soup(98, 60000, 4, 0.1);
  const Strided<float, std::int64_t> copied(mesh), too_large(large);
  const Grid grid = grid_of(16, 0.5);
  Batch batch;
  for (int n = 0; n < 11; ++n) batch.add(n == 6 ? too_large.view() : copied.view(), grid, 1);
  const std::int64_t copy = 9 * 2000 * 8 + 3 * 2000 * 4, large_copy = 30 * copy;
  const std::int64_t workspace =
      emulated::workspace_bytes(2000, grid, 1, Method::tiles, cuda::likely_entries(2000, grid, 1));
  const SmallGpu gpu(workspace + 5 * copy);
  ASSERT_LT(workspace + 5 * copy, large_copy);
  const auto answers = batch.run();
  ASSERT_EQ(answers.size(), 11u);
  for (std::size_t n = 0; n < 11; ++n) {
    SCOPED_TRACE(n);
    if (n == 6) {
      ASSERT_NE(error_of(answers[n]), nullptr);
      EXPECT_EQ(error_of(answers[n])->code(), ErrorCode::limit);
      EXPECT_TRUE(batch.is_untouched(n));
    } else {
      ASSERT_EQ(error_of(answers[n]), nullptr) << error_of(answers[n])->what();
      EXPECT_TRUE(batch.has_the_bits_of_the_cpu(n));
    }
  }
  EXPECT_EQ(emulated::memory_taken, 0);
}

// A pool of a caller, which counts.
struct Pool {
  std::vector<std::unique_ptr<emulated::Memory>> memory;
  std::int64_t most = std::int64_t{1} << 40;
  std::int64_t taken = 0, calls = 0, offset = 0;

  cuda::Allocator allocator() {
    return {[this](std::int64_t bytes) -> void* {
              ++calls;
              if (bytes > most) return nullptr;
              ++taken;
              memory.push_back(std::make_unique<emulated::Memory>(bytes + 256));
              return memory.back()->as<char>() + offset;
            },
            [this](void*) { --taken; }};
  }
};

TEST(CudaEach, AllMemoryComesFromTheCallersPool) {
  const Mesh mesh = testing::random_soup(99, 200, 4, 1.2), wide = wide_triangles();
  const Strided<float, std::int64_t> copied(mesh);
  Batch batch;
  batch.add(copied.view(), grid_of(17, 0.5), 1);
  batch.add(wide, grid_of(21, 0.5), 1.5);  // asks twice: its lists do not fit at first
  Pool pool;
  cuda::OnStream on = kEmulated;
  on.memory = pool.allocator();
  const std::int64_t launched_with = emulated::memory_taken;
  for (const auto& answer : cuda::compute_each(batch.requests, on)) EXPECT_EQ(error_of(answer), nullptr);
  for (std::size_t n = 0; n < 2; ++n) EXPECT_TRUE(batch.has_the_bits_of_the_cpu(n));
  EXPECT_EQ(pool.taken, 0);
  EXPECT_EQ(pool.calls, 3);  // copies, workspace, more workspace
  std::int64_t in_pool = 0;
  for (const auto& memory : pool.memory) in_pool += memory != nullptr;
  EXPECT_EQ(in_pool, 3);
  pool.memory.clear();
  EXPECT_EQ(emulated::memory_taken, launched_with);
  EXPECT_EQ(error_of(cuda::bounds_of_each(std::vector<MeshView>{mesh}, on)[0]), nullptr);
  EXPECT_EQ(pool.calls, 4);

  pool.most = 100;
  const auto answers = cuda::compute_each(batch.requests, on);
  for (const auto& answer : answers) {
    ASSERT_NE(error_of(answer), nullptr);
    EXPECT_EQ(error_of(answer)->code(), ErrorCode::limit);
  }
  pool.most = std::int64_t{1} << 40;
  pool.offset = 8;
  EXPECT_THROW(cuda::compute_each(batch.requests, on), Error);  // not aligned
  EXPECT_EQ(pool.taken, 0);
  on.memory.release = nullptr;
  EXPECT_THROW(cuda::compute_each(batch.requests, on), Error);
}

}  // namespace
}  // namespace standoff
