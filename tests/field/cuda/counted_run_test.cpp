// SPDX-License-Identifier: Apache-2.0
// Blocking runs, emulated: they count the memory needed before they allocate it. So no work is done twice, no memory is
// wasted, and nothing is copied to the host that no kernel wrote.
#include "field/cuda/counted_run.cuh"

#include <gtest/gtest.h>

#include "backends/cuda/pipelines.cuh"
#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/testing/emulation.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

ComputeOptions emulated(Method method = Method::tiles) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = testing::kEmulated;
  options.method = method;
  options.nearest = true;
  return options;
}

std::int64_t launches_of(const Mesh& mesh, const Grid& grid, double thickness) {
  const std::int64_t before = emulation::launch_count();
  compute(mesh, grid, thickness, emulated());
  return emulation::launch_count() - before;
}

cuda::DeviceMesh on_device(const Mesh& mesh) {
  return {&mesh.vertices.data()->x, static_cast<std::int64_t>(mesh.vertices.size()), mesh.triangles.data()->data(),
          static_cast<std::int64_t>(mesh.triangles.size())};
}

emulated::CountedRun run_of(
    const Mesh& mesh, const Grid& grid, double thickness, Method method = Method::tiles,
    std::function<void()> waited = [] {}) {
  emulated::CountedRun run(on_device(mesh), grid, thickness, false, std::move(waited));
  emulated::with_pipeline(method, grid, thickness, [&]<class Pipeline>() { run.run<Pipeline>(); });
  return run;
}

std::int64_t needed_entries(const Mesh& mesh, const Grid& grid, double thickness) {
  const emulated::CountedRun run = run_of(mesh, grid, thickness);
  return static_cast<std::int64_t>(run.outcome().needed_entries);
}

// The number of candidates depends on the mesh. When the memory of lists was guessed, the field of a terrain was begun
// four times, and got further each time.
TEST(CudaCountedRun, CrowdedListsAreNoReasonToBeginAgain) {
  const Grid grid{{32, 32, 32}, {-8.25, -8.25, -8.25}, {0.5, 0.5, 0.5}};
  const Mesh few = testing::random_soup(101, 4, 4, 1);
  // Small triangles close together: from afar none is certainly nearer than the others, and near by they share a few
  // tiles.
  const Mesh crowd = testing::random_soup(102, 400, 0.3, 0.2);
  for (const double thickness : {1.0, 4.0, testing::kInfinity}) {
    // More entries than the old guess from the numbers of triangles and tiles.
    ASSERT_GT(needed_entries(crowd, grid, thickness), thickness == 1 ? 6 * 400 + 2 * 64 : 4 * 400 + 48 * 64);
    const std::int64_t launches = launches_of(crowd, grid, thickness);
    EXPECT_GT(launches, 5);
    EXPECT_EQ(launches, launches_of(few, grid, thickness)) << thickness;
  }
}

TEST(CudaCountedRun, RoomIsMadeForWhatWasCounted) {
  using namespace emulated;
  const Mesh mesh = testing::random_soup(103, 300, 4, 1);
  const Grid grid{{33, 30, 28}, {-5, -5, -5}, {0.4, 0.4, 0.4}};
  for (const Method method : {Method::tiles, Method::thesis})
    for (const double thickness : {0.5, 3.0}) {
      int looks = 0;
      const CountedRun run = run_of(mesh, grid, thickness, method, [&] { ++looks; });
      EXPECT_GT(looks, 0);
      const auto slots = static_cast<std::int64_t>(run.outcome().needed_slots);
      EXPECT_GT(slots, 0);
      EXPECT_EQ(run.output().slot_capacity, slots);
      std::int64_t stored = 0;
      for (std::int64_t tile = 0; tile < tile_count(grid.size); ++tile) stored += run.output().slots[tile] >= 0;
      EXPECT_LE(stored, slots);
      EXPECT_EQ(run.output().nearest, nullptr);
    }
  EXPECT_EQ(memory_taken, 0);
}

// A tile without a sample of the band gets a slot before its samples are known, and no kernel writes it. Such slots
// were once copied too, which is harmless, but initcheck reports it.
TEST(CudaCountedRun, NothingIsCopiedThatNobodyWrote) {
  const Mesh mesh = scenes::make("bender", 400);
  const Grid grid = fit_resolution(bounds(mesh), 60, {.length = 2, .least_samples = 0});
  for (const Method method : {Method::tiles, Method::thesis})
    for (const double spacings : {0.5, 6.0}) {
      const std::int64_t before = emulated::unwritten_words_copied;
      const ComputeResult computed = compute(mesh, grid, spacings * grid.max_spacing(), emulated(method));
      EXPECT_GT(computed.report.samples_band, 0);
      EXPECT_EQ(emulated::unwritten_words_copied, before);
    }
}

// The test above means something only if there are such tiles.
TEST(CudaCountedRun, SomeSlotsAreNeverWritten) {
  using namespace emulated;
  const Mesh mesh = scenes::make("bender", 400);
  const Grid grid = fit_resolution(bounds(mesh), 60, {.length = 2, .least_samples = 0});
  const CountedRun run = run_of(mesh, grid, 0.5 * grid.max_spacing());
  std::int64_t stored = 0;
  for (std::int64_t tile = 0; tile < tile_count(grid.size); ++tile) stored += run.output().slots[tile] >= 0;
  EXPECT_LT(stored, static_cast<std::int64_t>(run.outcome().needed_slots));
}

}  // namespace
}  // namespace standoff
