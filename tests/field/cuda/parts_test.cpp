// SPDX-License-Identifier: Apache-2.0
// Steps that are left out for measurements: each is really left out, and all steps before it are done.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "backends/cuda/fields.h"
#include "tests/support/random_mesh.h"
#include "thesis/algorithm_1.cuh"

namespace standoff::emulated {
namespace {

constexpr float kRubbish = -77;

struct Result {
  std::vector<float> values;
  Outcome outcome{};

  bool all(float value) const {
    return std::all_of(values.begin(), values.end(), [value](float v) { return v == value; });
  }
};

template <StopAfter kLast>
Result run(Method method) {
  const Mesh mesh = testing::random_soup(91, 120, 4, 1.2);
  const Grid grid{{21, 18, 13}, {-4, -4, -3}, {0.5, 0.5, 0.5}};
  Result result;
  result.values.assign(static_cast<std::size_t>(grid.sample_count()), kRubbish);
  Task task;
  task.mesh = {&mesh.vertices.data()->x, static_cast<std::int64_t>(mesh.vertices.size()), mesh.triangles.data()->data(),
               static_cast<std::int64_t>(mesh.triangles.size())};
  task.grid = grid;
  task.thickness = 1;
  task.method = method;
  task.output.values = result.values.data();
  task.outcome = &result.outcome;
  const std::int64_t bytes = workspace_bytes(120, grid, 1, method, 4000);
  const Memory workspace(bytes);
  enqueue_until<kLast>(task, workspace.as<void>(), bytes, nullptr);
  EXPECT_EQ(result.outcome.stopped, 0u);
  return result;
}

TEST(CudaParts, OfTiles) {
  const Result whole = run<StopAfter::write>(Method::tiles);
  EXPECT_GT(whole.outcome.samples_band, 0u);
  EXPECT_FALSE(whole.all(kRubbish));
  const Result distance = run<StopAfter::distance>(Method::tiles);
  EXPECT_TRUE(distance.all(kRubbish));
  EXPECT_EQ(distance.outcome.samples_band, whole.outcome.samples_band);
  const Result rows = run<StopAfter::rows>(Method::tiles);
  EXPECT_TRUE(rows.all(kRubbish));
  EXPECT_EQ(rows.outcome.samples_band, 0u);
  EXPECT_GE(rows.outcome.samples_examined, whole.outcome.samples_examined);
  const Result set_up = run<StopAfter::set_up>(Method::tiles);
  EXPECT_EQ(set_up.outcome.samples_examined, 0u);
  EXPECT_EQ(run<StopAfter::lists>(Method::tiles).outcome.needed_entries, whole.outcome.needed_entries);
}

TEST(CudaParts, OfAlgorithm1) {
  const Result whole = run<StopAfter::write>(Method::thesis);
  EXPECT_FALSE(whole.all(1));
  EXPECT_EQ(run<StopAfter::always>(Method::thesis).values, whole.values);
  EXPECT_TRUE(run<StopAfter::read>(Method::thesis).all(1));
  EXPECT_TRUE(run<StopAfter::distance>(Method::thesis).all(1));
  const Result lists = run<StopAfter::lists>(Method::thesis);
  EXPECT_TRUE(lists.all(1));
  EXPECT_EQ(lists.outcome.samples_examined, whole.outcome.samples_examined);
}

}  // namespace
}  // namespace standoff::emulated
