// SPDX-License-Identifier: Apache-2.0
// compute() on an emulated device: the device decides the sign of closed meshes, the host that of others; field and
// report are those of the CPU.
// labels: memory
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "core/tile_count.h"
#include "field/cuda/counted_run.cuh"
#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "sign/sign_field.h"
#include "standoff/compute.h"
#include "standoff/slabs.h"
#include "standoff/testing/emulation.h"
#include "standoff/windows.h"
#include "tests/sign/cuda/coarse_grid.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using emulation::Order;
using testing::bits_of;
using testing::box;
using testing::joined;
using testing::kInfinity;
using testing::moved;
using testing::reversed;
using testing::sphere;

// Samples on faces, edges and corners of boxes with whole corners; 2 x 2 x 3 bricks, the last ones cut.
const Grid kCutGrid{{27, 20, 35}, {-5, -5, -5}, {1, 0.9, 1.1}};

ComputeOptions on(Backend backend, const SignOptions& sign = {}) {
  ComputeOptions options{.sign = sign};
  options.nearest = true;
  options.execution.backend = backend;
  options.execution.threads = 2;
  return options;
}

void expect_same(const DistanceField& a, const DistanceField& b) {
  testing::expect_same_bits(a, b);
  ASSERT_EQ(a.stored_tiles(), b.stored_tiles());
  for (std::size_t n = 0; n < a.slots().size(); ++n)
    ASSERT_TRUE(a.slots()[n] == b.slots()[n] || (a.slots()[n] >= 0 && b.slots()[n] >= 0)) << n;
}

void expect_same(const ComputeReport& a, const ComputeReport& b) {
  EXPECT_EQ(a.sign.method, b.sign.method);
  EXPECT_EQ(a.sign.why, b.sign.why);
  EXPECT_EQ(a.sign.sure, b.sign.sure);
  EXPECT_EQ(a.sign.flipped, b.sign.flipped);
  EXPECT_EQ(a.sign.left_out, b.sign.left_out);
  EXPECT_EQ(a.sign.boundary_edges, b.sign.boundary_edges);
  EXPECT_EQ(a.sign.internal, b.sign.internal);
  EXPECT_EQ(a.provenance.sign, b.provenance.sign);
  EXPECT_EQ(a.provenance.mesh_hash, b.provenance.mesh_hash);
  EXPECT_EQ(a.samples_band, b.samples_band);
  EXPECT_EQ(a.skipped, b.skipped);
  EXPECT_EQ(a.tiles_stored, b.tiles_stored);
  for (const ComputeReport& report : {a, b}) EXPECT_EQ(report.seconds.sign > 0, report.sign.method != SignMethod::none);
}

// A field by these options: sparse, and dense.
struct Made {
  ComputeResult sparse;
  ComputeReport dense;
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;

  Made(const Mesh& mesh, const Grid& grid, double thickness, const ComputeOptions& options)
      : sparse(compute(mesh, grid, thickness, options)),
        values(static_cast<std::size_t>(grid.sample_count()), -77.0f),
        nearest(values.size()) {
    dense = compute_into(mesh, grid, thickness, values, nearest, options);
  }
};

// On the device in these orders, and on the CPU.
void expect_as_on_cpu(const Mesh& mesh, const Grid& grid, double thickness, ComputeOptions options,
                      std::initializer_list<Order> orders = {Order::forward}) {
  ComputeOptions on_host = options;
  on_host.execution.backend = Backend::cpu;
  on_host.devices.clear();
  const Made expected(mesh, grid, thickness, on_host);
  for (const Order order : orders) {
    const emulation::OrderScope scope(order);
    const Made made(mesh, grid, thickness, options);
    expect_same(made.sparse.field, expected.sparse.field);
    expect_same(made.sparse.report, expected.sparse.report);
    expect_same(made.dense, expected.dense);
    EXPECT_TRUE(bits_of(made.values) == bits_of(expected.values));
    EXPECT_TRUE(made.nearest == expected.nearest);
  }
}
constexpr std::initializer_list<Order> kAllOrders{Order::forward, Order::reverse, Order::random};

// How many samples get their sign on the device.
std::int64_t signed_on_device(const Mesh& mesh, const Grid& grid, double thickness, const SignOptions& sign = {},
                              std::vector<int> devices = {}) {
  DistanceField field(grid, thickness, true);
  Sink sink(field);
  ProgressMeter progress;
  const Job job{.mesh = mesh,
                .kept = {},
                .grid = grid,
                .thickness = thickness,
                .threads = 2,
                .simd = Simd::automatic,
                .progress = progress,
                .devices = devices,
                .sign = &sign};
  return find_backend(testing::kEmulated, Method::tiles, 1, grid).run(job, sink).samples_signed;
}

std::int64_t launches_of(const Mesh& mesh, const Grid& grid, double thickness, const ComputeOptions& options) {
  const std::int64_t before = emulation::launch_count();
  compute(mesh, grid, thickness, options);
  return emulation::launch_count() - before;
}
// Whether compute() asks the device for the sign.
bool asks_device(const Mesh& mesh, const Grid& grid, double thickness, ComputeOptions options) {
  const std::int64_t with_sign = launches_of(mesh, grid, thickness, options);
  options.sign = {.method = SignMethod::none};
  options.decision = {};
  return with_sign > launches_of(mesh, grid, thickness, options);
}

std::vector<Mesh> certain_meshes() {
  const Mesh ball = moved(sphere(10), {4, 4, 8}, 6.3);
  std::vector<Mesh> all{ball, moved(testing::torus(12, 8), {8, 4, 8}, 5.7)};
  all.push_back(joined(joined(box({0, 0, 0}, {4, 4, 4}), box({2, 2, 2}, {6, 6, 6})), box({4, 0, 0}, {7, 3, 9})));
  all.push_back(joined(ball, moved(sphere(), {4, 4, 8}, 2.2)));      // nested
  all.push_back(joined(ball, moved(sphere(), {17.5, 5, 20}, 3.4)));  // in parts
  all.push_back(box({-40, -30, -20}, {50, 22, 13}));                 // beyond the grid on most sides
  all.push_back(moved(scenes::make("catapult", 800), {0, 0, 0}, 1));
  return all;
}

Mesh stack_of(int sheets, Vec3 at = {}) {
  Mesh mesh;
  for (int n = 0; n < sheets; ++n) mesh = joined(mesh, box(at + Vec3{1, 1, 1}, at + Vec3{6, 6, 6}));
  return mesh;
}

std::vector<Mesh> doubtful_meshes() {
  Mesh with_hole = moved(sphere(10), {4, 4, 8}, 6.3);
  with_hole.triangles.pop_back();
  std::vector<Mesh> all{with_hole, reversed(moved(sphere(), {4, 4, 8}, 6.3)), testing::solid_soup(3, 6), stack_of(128)};
  all.push_back(joined(box({0, 0, 0}, {8, 8, 8}), reversed(box({2, 2, 2}, {5, 5, 5}))));
  all.push_back(moved(testing::terrain(), {8, 4, 8}, 7));  // a sheet has no inside
  all.push_back(moved(testing::moebius(), {8, 4, 8}, 5));  // nor has a surface with one side
  all.push_back(testing::unwelded(moved(sphere(), {4, 4, 8}, 6.3)));
  return all;
}

Grid grid_for(const Mesh& mesh) { return mesh.triangles.size() < 700 ? kCutGrid : testing::coarse_grid(mesh, 18); }

TEST(ComputedSign, ClosedMeshesAreSignedOnTheDevice) {
  bool any_inside = false;
  for (const Mesh& mesh : certain_meshes()) {
    SCOPED_TRACE(mesh.triangles.size());
    const Grid grid = grid_for(mesh);
    for (const double spacings : {1.0, 2.5, 6.0, kInfinity}) {
      if (testing::kSanitized && spacings != 2.5) continue;
      const double thickness = spacings * grid.max_spacing();
      EXPECT_EQ(signed_on_device(mesh, grid, thickness), grid.sample_count());
      // Thick bands take long here.
      expect_as_on_cpu(mesh, grid, thickness, on(testing::kEmulated),
                       spacings < 4 ? kAllOrders : std::initializer_list<Order>{Order::random});
    }
    const double thin = 2 * grid.max_spacing();
    EXPECT_TRUE(asks_device(mesh, grid, thin, on(testing::kEmulated)));
    const DistanceField field = compute(mesh, grid, thin, on(testing::kEmulated)).field;
    any_inside |= std::ranges::count(field.slots(), DistanceField::kInside) > 0;
  }
  EXPECT_TRUE(any_inside);  // tiles that are not stored
  EXPECT_EQ(emulated::memory_taken, 0);
}

TEST(ComputedSign, DoubtfulMeshesAreSignedOnTheHost) {
  for (const Mesh& mesh : doubtful_meshes()) {
    SCOPED_TRACE(mesh.triangles.size());
    EXPECT_EQ(signed_on_device(mesh, kCutGrid, 2.5), 0);
    expect_as_on_cpu(mesh, kCutGrid, 2.5, on(testing::kEmulated), kAllOrders);
    if (mesh.triangles.size() < 100) expect_as_on_cpu(mesh, kCutGrid, kInfinity, on(testing::kEmulated));
  }
}

// No tile is stored, and each is inside.
TEST(ComputedSign, AGridDeepInsideIsInside) {
  const Mesh mesh = box({-100, -100, -100}, {100, 100, 100});
  EXPECT_EQ(signed_on_device(mesh, kCutGrid, 2), kCutGrid.sample_count());
  expect_as_on_cpu(mesh, kCutGrid, 2, on(testing::kEmulated));
  EXPECT_EQ(compute(mesh, kCutGrid, 2, on(testing::kEmulated)).field.value(3, 4, 5), -2);
}

TEST(ComputedSign, OptionsAreObeyed) {
  const Mesh overlapping = joined(box({0, 0, 0}, {6, 6, 6}), box({2, 2, 2}, {9, 9, 9}));
  const Mesh hollow = joined(box({0, 0, 0}, {8, 8, 8}), reversed(box({2, 2, 2}, {5, 5, 5})));
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd})
    for (const bool invert : {false, true}) {
      SignOptions sign{.method = SignMethod::winding, .rule = rule, .invert = invert};
      EXPECT_EQ(signed_on_device(overlapping, kCutGrid, 2, sign), kCutGrid.sample_count());
      expect_as_on_cpu(overlapping, kCutGrid, 2, on(testing::kEmulated, sign));
      sign.as_oriented = true;
      EXPECT_EQ(signed_on_device(hollow, kCutGrid, 2, sign), kCutGrid.sample_count());
      expect_as_on_cpu(hollow, kCutGrid, 2, on(testing::kEmulated, sign));
    }
}

// Where the device cannot decide, or a decision comes before the distances, it is not asked.
TEST(ComputedSign, OtherSignsAreLeftToTheHost) {
  const Mesh mesh = joined(joined(moved(sphere(16), {4, 4, 8}, 6.3), box({4, 0, 0}, {7, 3, 9})), stack_of(20));
  const auto expect_host = [&](const ComputeOptions& options, double thickness = 2) {
    EXPECT_FALSE(asks_device(mesh, kCutGrid, thickness, options));
    expect_as_on_cpu(mesh, kCutGrid, thickness, options);
  };
  for (const SignMethod method :
       {SignMethod::parity, SignMethod::normal, SignMethod::facet, SignMethod::flood, SignMethod::none})
    expect_host(on(testing::kEmulated, {.method = method}));
  expect_host(on(testing::kEmulated, {.method = SignMethod::shell, .shell = 0.4}));
  expect_host(on(testing::kEmulated, {.outer = true}));
  expect_host(on(testing::kEmulated, {.strict = true}));
  expect_host(on(testing::kEmulated), 0.8);  // thinner than the spacing
  ComputeOptions options = on(testing::kEmulated);
  options.skip.kind = SkipRule::Kind::neighbour;
  expect_host(options);
  options = on(testing::kEmulated);
  options.method = Method::thesis;
  expect_host(options);
  options.method = Method::jumpflood_1;
  EXPECT_FALSE(asks_device(mesh, kCutGrid, 2, options));
  // Rules that change no bit leave the sign to the device.
  options = on(testing::kEmulated);
  options.skip.kind = SkipRule::Kind::exact;
  EXPECT_TRUE(asks_device(mesh, kCutGrid, 2, options));
  expect_as_on_cpu(mesh, kCutGrid, 2, options);
  options.skip.kind = SkipRule::Kind::automatic;  // the pile's copies
  EXPECT_GT(compute(stack_of(40), kCutGrid, 2, options).report.skipped, 0);
  EXPECT_TRUE(asks_device(stack_of(40), kCutGrid, 2, options));
  expect_as_on_cpu(stack_of(40), kCutGrid, 2, options);
}

TEST(ComputedSign, ADecisionThatIsThereIsTaken) {
  const Mesh mesh = moved(sphere(16), {4, 4, 8}, 6.3);
  const WindowComputation whole(mesh, kCutGrid, 2, kCutGrid.size, on(testing::kEmulated));
  EXPECT_TRUE(whole.is_whole());
  ComputeOptions options = on(testing::kEmulated);
  options.decision = whole.decision();
  const WindowComputation by_cpu(mesh, kCutGrid, 2, kCutGrid.size, on(Backend::cpu));
  EXPECT_TRUE(std::ranges::equal(options.decision.bytes(), by_cpu.decision().bytes()));
  EXPECT_FALSE(asks_device(mesh, kCutGrid, 2, options));
  expect_as_on_cpu(mesh, kCutGrid, 2, options);
}

TEST(ComputedSign, WindowsAndSlabsHaveTheWholeFieldsSigns) {
  const Mesh mesh = moved(sphere(16), {4, 4, 8}, 6.3);
  const DistanceField whole = compute(mesh, kCutGrid, 2, on(Backend::cpu)).field;
  SlabComputation slabs(mesh, kCutGrid, 2, on(testing::kEmulated), 1);
  std::int64_t first = 0, inside = 0;
  while (const DistanceField* slab = slabs.next()) {
    std::vector<float> got = slab->to_dense(), expected(got.size());
    whole.copy_slices(first, slab->grid().size.z, expected);
    EXPECT_TRUE(bits_of(got) == bits_of(expected)) << first;
    inside += std::ranges::count_if(got, [](float v) { return v < 0; });
    first += slab->grid().size.z;
  }
  EXPECT_EQ(first, kCutGrid.size.z);
  EXPECT_GT(inside, 500);
  const Grid window = kCutGrid.window({16, 0, 16}, {11, 20, 19});
  EXPECT_EQ(signed_on_device(mesh, window, 2), window.sample_count());
  expect_as_on_cpu(mesh, window, 2, on(testing::kEmulated));
}

TEST(ComputedSign, SeveralDevicesSignTheirWindows) {
  const Mesh ball = moved(sphere(10), {4, 4, 14}, 6.3), solid = box({-40, -30, -20}, {50, 22, 30});
  // One window has more layers between two samples than bytes can count: then the others' signs are dropped.
  const Mesh mixed = joined(ball, stack_of(128, {5, 3, 20})), open = moved(testing::terrain(), {8, 4, 8}, 7);
  for (const double thickness : {2.0, 5.0}) {
    EXPECT_EQ(signed_on_device(ball, kCutGrid, thickness, {}, {0, 1}), kCutGrid.sample_count());
    const std::int64_t some = signed_on_device(mixed, kCutGrid, thickness, {}, {0, 1});
    EXPECT_GT(some, 0);
    EXPECT_LT(some, kCutGrid.sample_count());
    for (const Mesh* mesh : {&ball, &solid, &mixed, &open})
      for (const std::vector<int>& devices : {std::vector{3}, {2, 0, 1}}) {
        ComputeOptions options = on(testing::kEmulated);
        options.devices = devices;
        expect_as_on_cpu(*mesh, kCutGrid, thickness, options);
      }
  }
}

// While it lives, tests may change the device's memory.
struct DeviceMemory {
  const std::int64_t usual = emulated::memory_total;
  ~DeviceMemory() { emulated::memory_total = usual; }
};

// The least memory of the device in which a field without a sign fits.
std::int64_t least_memory(const Mesh& mesh, const Grid& grid, double thickness) {
  std::int64_t little = 0, enough = std::int64_t{1} << 30;
  while (enough - little > 256) {
    const std::int64_t middle = (little + enough) / 2;
    emulated::memory_total = middle;
    try {
      compute(mesh, grid, thickness, on(testing::kEmulated, {.method = SignMethod::none}));
      enough = middle;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::limit);
      little = middle;
    }
  }
  return enough;
}

// A field that the device has room for gets its sign, whether or not there is room for that too.
TEST(ComputedSign, WithoutRoomOnTheDeviceTheHostSigns) {
  const DeviceMemory total;
  const Mesh solid = box({-3, -3, -3}, {12, 9, 25});
  // The sign's bytes, one for each sample, are more than what the field needed beside its values.
  const Grid large{{320, 320, 320}, {-5, -5, -5}, {1, 0.9, 1.1}};
  emulated::memory_total = least_memory(solid, large, 1.1);
  EXPECT_EQ(signed_on_device(solid, large, 1.1), 0);
  expect_as_on_cpu(solid, large, 1.1, on(testing::kEmulated));
  emulated::memory_total = total.usual;
  EXPECT_EQ(signed_on_device(solid, large, 1.1), large.sample_count());
  // Many triangles are about equally near: the lists that are no longer needed make room.
  const Mesh ball = sphere(16);
  const Grid middle{{16, 16, 16}, {-0.08, -0.08, -0.08}, {0.01, 0.01, 0.01}};
  const SignOptions sign{.as_oriented = true};
  emulated::memory_total = least_memory(ball, middle, kInfinity);
  EXPECT_EQ(signed_on_device(ball, middle, kInfinity, sign), middle.sample_count());
  expect_as_on_cpu(ball, middle, kInfinity, on(testing::kEmulated, sign));
}

TEST(ComputedSign, ErrorsAreThoseOfTheHost) {
  const Mesh open = moved(testing::terrain(), {8, 4, 8}, 7);
  for (const Backend backend : {Backend::cpu, testing::kEmulated}) {
    expect_error([&] { compute(open, kCutGrid, 2, on(backend, {.method = SignMethod::parity})); }, ErrorCode::input,
                 "not closed");
    expect_error([&] { compute(open, kCutGrid, 2, on(backend, {.method = SignMethod::winding, .strict = true})); },
                 ErrorCode::doubt, "the sign is not certain");
    Mesh broken = open;
    broken.triangles[3][0] = 4711;
    expect_error([&] { compute(broken, kCutGrid, 2, on(backend)); }, ErrorCode::input, "triangle 3");
  }
}

// A device that gives up after it has signed some of the samples.
TEST(ComputedSign, WhatIsGivenUpIsHandedOverAsMagnitudes) {
  using namespace emulated;
  const Mesh mesh = moved(sphere(), {4, 4, 8}, 6.3);
  const DistanceField expected = compute(mesh, kCutGrid, 2, on(Backend::cpu, {.method = SignMethod::none})).field;
  DistanceField field(kCutGrid, 2, true);
  Sink sink(field);
  ProgressMeter progress;
  const Job job{mesh, {}, kCutGrid, 2, 2, Simd::automatic, progress};
  const Counts counts = HostRun<ThinBand>(job, kCutGrid).run(kCutGrid, sink, [](CountedRun& run) {
    for (std::int64_t n = 0; n < 512 * run.output().slot_capacity; n += 3) run.output().values[n] *= -1;
    for (std::int64_t tile = 0; tile < run.lattice.tile_count(); ++tile)
      if (run.output().slots[tile] < 0) run.output().slots[tile] = DistanceField::kInside;
    return false;
  });
  EXPECT_EQ(counts.samples_signed, 0);
  expect_same(field, expected);
}

TEST(ComputedSign, SignsAreDropped) {
  const Mesh mesh = box({-40, -30, -20}, {50, 22, 13});
  DistanceField field = compute(mesh, kCutGrid, 2, on(Backend::cpu)).field;
  EXPECT_GT(std::ranges::count(field.slots(), DistanceField::kInside), 0);
  std::vector<float> values = field.to_dense();
  drop_signs(field);
  drop_signs(values);
  const DistanceField magnitudes = compute(mesh, kCutGrid, 2, on(Backend::cpu, {.method = SignMethod::none})).field;
  expect_same(field, magnitudes);
  EXPECT_TRUE(bits_of(values) == bits_of(magnitudes.to_dense()));
}

}  // namespace
}  // namespace standoff
