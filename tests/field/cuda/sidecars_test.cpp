// SPDX-License-Identifier: Apache-2.0
// Sidecars in device memory, emulated: they have the bits of sidecars(), dense and sparse, of needles and of triangles
// with many samples, on the surface, with signs of the device and of the host.
// labels: memory threads
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "backends/cuda/fields.h"
#include "gpu/emulation/block.h"
#include "gpu/platform_emulated.h"
#include "sidecars/cuda/sidecars.cuh"
#include "standoff/compute.h"
#include "standoff/cuda_compute.h"
#include "standoff/error.h"
#include "standoff/sidecars.h"
#include "tests/field/cuda/on_stream.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using testing::kInfinity;

constexpr std::array kAllKinds{SidecarKind::closest_point, SidecarKind::barycentric, SidecarKind::feature,
                               SidecarKind::gradient};
constexpr float kNotWritten = -77;
constexpr std::uint8_t kByteNotWritten = 200;

// What a field has beside its values, a row of numbers for each sample.
struct BesideValues {
  explicit BesideValues(std::size_t samples)
      : values(samples, kNotWritten),
        nearest(samples, 4711),
        closest(3 * samples, kNotWritten),
        weights(3 * samples, kNotWritten),
        gradient(3 * samples, kNotWritten),
        feature(samples, kByteNotWritten) {}
  cuda::DeviceSidecars sidecars() { return {closest.data(), weights.data(), feature.data(), gradient.data()}; }

  std::vector<float> values;
  std::vector<std::uint32_t> nearest;
  std::vector<float> closest, weights, gradient;
  std::vector<std::uint8_t> feature;
};

DistanceField field_on_cpu(const Mesh& mesh, const Grid& grid, double thickness, const SignOptions& sign) {
  ComputeOptions options{.sign = sign, .execution = {.backend = Backend::cpu}, .nearest = true};
  options.skip.kind = SkipRule::Kind::none;
  return compute(mesh, grid, thickness, options).field;
}

// The CPU's sidecars as dense arrays; 0 in tiles that are not stored.
BesideValues sidecars_on_cpu(const Mesh& mesh, const DistanceField& field) {
  const Size3 size = field.grid().size;
  BesideValues made(static_cast<std::size_t>(field.grid().sample_count()));
  made.values = field.to_dense();
  made.nearest = testing::all_nearest(field);
  for (auto* one : {&made.closest, &made.weights, &made.gradient}) std::fill(one->begin(), one->end(), 0.0f);
  std::fill(made.feature.begin(), made.feature.end(), std::uint8_t{0});
  const std::vector<Sidecar> beside = sidecars(mesh, field, kAllKinds);
  for (const DistanceField::Tile& tile : field.tiles()) {
    const auto slot = static_cast<std::size_t>(field.slots()[static_cast<std::size_t>(tile.index)]);
    for (std::size_t n = 0; n < DistanceField::kTileSamples; ++n) {
      const auto at = [&](std::int64_t first, std::size_t along) {
        return 8 * first + static_cast<std::int64_t>(along);
      };
      const std::int64_t i = at(tile.at.x, n % 8), j = at(tile.at.y, n / 8 % 8), k = at(tile.at.z, n / 64);
      if (i >= size.x || j >= size.y || k >= size.z) continue;
      const auto to = static_cast<std::size_t>(i + size.x * (j + size.y * k)), from = 512 * slot + n;
      for (std::size_t c = 0; c < 3; ++c) {
        made.closest[3 * to + c] = std::get<std::vector<float>>(beside[0].values)[3 * from + c];
        made.weights[3 * to + c] = std::get<std::vector<float>>(beside[1].values)[3 * from + c];
        made.gradient[3 * to + c] = std::get<std::vector<float>>(beside[3].values)[3 * from + c];
      }
      made.feature[to] = std::get<std::vector<std::uint8_t>>(beside[2].values)[from];
    }
  }
  return made;
}

void expect_same_sidecars(const BesideValues& found, const BesideValues& wanted) {
  EXPECT_TRUE(testing::bits_of(found.values) == testing::bits_of(wanted.values));
  EXPECT_TRUE(found.nearest == wanted.nearest);
  EXPECT_TRUE(testing::bits_of(found.closest) == testing::bits_of(wanted.closest));
  EXPECT_TRUE(testing::bits_of(found.weights) == testing::bits_of(wanted.weights));
  EXPECT_TRUE(testing::bits_of(found.gradient) == testing::bits_of(wanted.gradient));
  EXPECT_TRUE(found.feature == wanted.feature);
}

cuda::Outcome run_with_sidecars(cuda::Task task) {
  cuda::Outcome outcome{};
  task.outcome = &outcome;
  const std::int64_t bytes = emulated::workspace_bytes(
      task, 8 * cuda::likely_entries(task.mesh.triangle_count, task.grid, task.thickness, task.method));
  const emulated::Memory workspace(bytes);
  emulated::enqueue(task, workspace.as<void>(), bytes);
  cuda::check(outcome, task);
  return outcome;
}

BesideValues sidecars_on_device(const Mesh& mesh, const Grid& grid, double thickness, const SignOptions& sign) {
  BesideValues made(static_cast<std::size_t>(grid.sample_count()));
  cuda::Task task = emulated_task(mesh, grid, thickness, sign);
  task.output = {made.values.data(), made.nearest.data(), nullptr, 0};
  task.sidecars = made.sidecars();
  run_with_sidecars(task);
  return made;
}

struct SidecarCase {
  std::string name;
  Mesh mesh;
  Grid grid;
  double thickness;
  SignOptions sign = SignOptions{SignMethod::none};
};

// Tiles with one triangle, with some that are prepared once, and with more than that; samples on faces, edges and
// corners; triangles without area; grids that end within a tile.
std::vector<SidecarCase> sidecar_cases() {
  const Grid grid{{27, 22, 19}, {-6, -5, -4.5}, {0.5, 0.45, 0.5}};
  std::vector<SidecarCase> all;
  all.push_back({"nasty soup", testing::nasty_soup(171, 60, 6), grid, 1.2});
  all.push_back({"nasty soup, full", testing::nasty_soup(172, 60, 6), grid, kInfinity});
  all.push_back({"small triangles", testing::random_soup(173, 900, 6, 0.4), grid, 1});
  all.push_back({"large triangles", testing::random_soup(174, 12, 8, 20), grid, kInfinity});
  const Vec3 far{1e6, -3e5, 77};
  Grid there = grid;
  there.origin = there.origin + far;
  all.push_back({"far from the origin", testing::random_soup(175, 100, 6, 2, far), there, 2});
  const Grid on_faces{{17, 17, 17}, {-0.25, -0.25, -0.25}, {0.125, 0.125, 0.125}};
  const Mesh box = testing::box();
  all.push_back({"box, no sign", box, on_faces, 0.3});
  all.push_back({"box", box, on_faces, 0.3, {}});
  all.push_back({"box, inverted", box, on_faces, kInfinity, {.invert = true}});
  const Mesh ball = testing::sphere(24);
  all.push_back({"ball", ball, fit_resolution(bounds(ball), 30), kInfinity, {}});
  // Level sheets, with about five samples to a triangle: tiles stop preparing triangles in their midst. The two ways
  // to measure round differently there, where coordinates of the gradient are zero or nearly so.
  for (const std::uint32_t cuts : {9u, 13u, 21u}) {
    const Mesh sheet = testing::terrain(cuts, 0);
    const double step = bounds(sheet).longest_side() / 29;
    const Grid above{{31, 31, 5}, bounds(sheet).min - Vec3{0.71, 0.63, 1.9} * step, {step, step, step}};
    all.push_back({"level sheet", sheet, above, 4 * step});
  }
  return all;
}

TEST(CudaSidecars, DenseOutputHasTheBitsOfTheCpu) {
  for (const SidecarCase& c : sidecar_cases()) {
    SCOPED_TRACE(c.name);
    const DistanceField field = field_on_cpu(c.mesh, c.grid, c.thickness, c.sign);
    const BesideValues wanted = sidecars_on_cpu(c.mesh, field);
    for (const emulation::Order order :
         {emulation::Order::forward, emulation::Order::reverse, emulation::Order::random}) {
      const emulation::OrderScope scope(order);
      expect_same_sidecars(sidecars_on_device(c.mesh, c.grid, c.thickness, c.sign), wanted);
    }
  }
}

TEST(CudaSidecars, SparseOutputHasTheBitsOfTheCpu) {
  for (const SidecarCase& c : sidecar_cases()) {
    if (c.thickness == kInfinity) continue;
    SCOPED_TRACE(c.name);
    const DistanceField field = field_on_cpu(c.mesh, c.grid, c.thickness, c.sign);
    const std::vector<Sidecar> wanted = sidecars(c.mesh, field, kAllKinds);
    const auto tiles = static_cast<std::size_t>(field.slots().size());
    BesideValues found(512 * tiles);
    std::vector<std::int32_t> slots(tiles, 4711);
    cuda::Task task = emulated_task(c.mesh, c.grid, c.thickness, c.sign);
    task.output = {found.values.data(), found.nearest.data(), slots.data(), static_cast<std::int64_t>(tiles)};
    task.sidecars = found.sidecars();
    run_with_sidecars(task);
    const auto row = [](const auto& all, std::size_t slot, std::size_t count) {
      return std::vector(all.begin() + static_cast<std::ptrdiff_t>(count * slot),
                         all.begin() + static_cast<std::ptrdiff_t>(count * (slot + 1)));
    };
    for (std::size_t n = 0; n < tiles; ++n) {
      ASSERT_EQ(slots[n] >= 0, field.slots()[n] >= 0);
      if (slots[n] < 0) continue;
      const auto mine = static_cast<std::size_t>(slots[n]), theirs = static_cast<std::size_t>(field.slots()[n]);
      const auto floats = [&](std::size_t kind) {
        return row(std::get<std::vector<float>>(wanted[kind].values), theirs, 1536);
      };
      EXPECT_TRUE(testing::bits_of(row(found.closest, mine, 1536)) == testing::bits_of(floats(0)));
      EXPECT_TRUE(testing::bits_of(row(found.weights, mine, 1536)) == testing::bits_of(floats(1)));
      EXPECT_TRUE(testing::bits_of(row(found.gradient, mine, 1536)) == testing::bits_of(floats(3)));
      EXPECT_TRUE(row(found.feature, mine, 512) ==
                  row(std::get<std::vector<std::uint8_t>>(wanted[2].values), theirs, 512));
    }
  }
}

void find_end_of_tile(emulated::SidecarTask task, int* end) {
  static emulated::SidecarTileView view;
  static emulated::TileTriangles found;
  emulated::find_triangles(task, view, found);
  if (threadIdx.x < 32) emulated::find_end(found);
  if (threadIdx.x == 0) *end = found.end;
}

// Where a tile stops preparing triangles hardly shows in the bits, as the two ways to measure seldom round differently.
TEST(CudaSidecars, TilesStopPreparingByTheRule) {
  std::mt19937 engine(178);
  const auto below = [&](unsigned count) { return static_cast<unsigned>(engine() % count); };
  int stopped = 0;
  for (int round = 0; round < 300; ++round) {
    // Runs of samples with the same triangle; some samples have none.
    std::vector<std::uint32_t> nearest(512);
    const unsigned triangles = 1 + below(150);
    for (std::size_t n = 0; n < nearest.size(); ++n)
      nearest[n] = n == 0 || below(3) == 0 ? below(triangles) * 1000003u : nearest[n - 1];
    for (std::uint32_t& one : nearest)
      if (below(5) == 0) one = kNoTriangle;
    int expected = 512, samples = 0;
    std::vector<std::uint32_t> seen;
    for (std::size_t n = 0; n < nearest.size() && expected == 512; ++n) {
      if (nearest[n] == kNoTriangle || std::ranges::find(seen, nearest[n]) != seen.end()) continue;
      if (!prepares_more(static_cast<int>(seen.size()), samples)) expected = static_cast<int>(n);
      seen.push_back(nearest[n]);
      samples += static_cast<int>(std::ranges::count(nearest, nearest[n]));
    }
    stopped += expected < 512;
    emulated::SidecarTask task{};
    task.output.nearest = nearest.data();
    task.x = task.y = task.z = {0, 1, 0, 8};
    int end = -1;
    emulated::launch(nullptr, "find end", find_end_of_tile, 1, emulated::kSidecarThreads, task, &end);
    ASSERT_EQ(end, expected) << round;
  }
  EXPECT_GT(stopped, 50);
  EXPECT_LT(stopped, 250);
}

TEST(CudaSidecars, FeaturesAlone) {
  const Mesh mesh = testing::random_soup(176, 40, 4, 1.2);
  const Grid grid{{12, 12, 12}, {-4, -4, -4}, {0.7, 0.7, 0.7}};
  const BesideValues all = sidecars_on_device(mesh, grid, 1, SignOptions{SignMethod::none});
  BesideValues some(all.values.size());
  cuda::Task task = emulated_task(mesh, grid, 1, SignOptions{SignMethod::none});
  task.output = {some.values.data(), some.nearest.data(), nullptr, 0};
  task.sidecars.feature = some.feature.data();
  run_with_sidecars(task);
  EXPECT_TRUE(some.feature == all.feature);
  task.output.nearest = nullptr;
  expect_error([&] { run_with_sidecars(task); }, ErrorCode::usage, "output.nearest");
}

TEST(CudaSidecars, TasksThatFailWriteNone) {
  Mesh mesh = testing::box();
  mesh.triangles[5][1] = 1000;
  const Grid grid{{12, 12, 12}, {-0.5, -0.5, -0.5}, {0.2, 0.2, 0.2}};
  BesideValues made(static_cast<std::size_t>(grid.sample_count()));
  cuda::Task task = emulated_task(mesh, grid, 1, SignOptions{SignMethod::none});
  task.output = {made.values.data(), made.nearest.data(), nullptr, 0};
  task.sidecars = made.sidecars();
  expect_error([&] { run_with_sidecars(task); }, ErrorCode::input, "triangle 5");
  const BesideValues untouched(made.values.size());
  EXPECT_EQ(made.closest, untouched.closest);
  EXPECT_EQ(made.weights, untouched.weights);
  EXPECT_EQ(made.gradient, untouched.gradient);
  EXPECT_EQ(made.feature, untouched.feature);
}

TEST(CudaSidecars, ComputeEachMakesThemWhoeverDecidesTheSign) {
  // Open, so that the host decides; and with a flipped triangle, so that normals on the surface are not the mesh's own.
  const Mesh open = testing::without(testing::box(), 3), flipped = testing::with_flipped(testing::box(), 2),
             soup = testing::random_soup(177, 60, 1, 0.3, {0.5, 0.5, 0.5});
  const Grid grid{{15, 15, 15}, {-0.25, -0.25, -0.25}, {0.125, 0.125, 0.125}};
  const std::vector<SidecarCase> all{{"closed", testing::box(), grid, 0.3, {}},
                                     {"open", open, grid, kInfinity, {}},
                                     {"flipped", flipped, grid, 0.3, {}},
                                     {"inverted", flipped, grid, 0.3, {.invert = true}},
                                     {"no sign", soup, grid, 0.2}};
  std::vector<BesideValues> found;
  std::vector<cuda::FieldRequest> requests;
  for (const SidecarCase& c : all) found.emplace_back(static_cast<std::size_t>(c.grid.sample_count()));
  for (std::size_t n = 0; n < all.size(); ++n)
    requests.push_back({all[n].mesh, all[n].grid, all[n].thickness, found[n].values.data(), Method::tiles, all[n].sign,
                        found[n].nearest.data(), found[n].sidecars()});
  const auto answers = cuda::compute_each(requests, kEmulated);
  for (std::size_t n = 0; n < all.size(); ++n) {
    SCOPED_TRACE(all[n].name);
    cuda::value_or_throw(answers[n]);
    expect_same_sidecars(
        found[n], sidecars_on_cpu(all[n].mesh, field_on_cpu(all[n].mesh, all[n].grid, all[n].thickness, all[n].sign)));
  }
  requests[1].nearest = nullptr;
  EXPECT_THROW(cuda::value_or_throw(cuda::compute_each(requests, kEmulated)[1]), Error);
}

}  // namespace
}  // namespace standoff
