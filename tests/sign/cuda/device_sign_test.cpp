// SPDX-License-Identifier: Apache-2.0
// Signs in device memory, emulated: the device's own have the bits of the CPU's, on samples on the surface too; where
// it has doubts it says which, and the host decides.
// labels: memory threads
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "backends/cuda/fields.h"
#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "sign/cuda/sign.cuh"
#include "sign/diagnosis/closed.h"
#include "standoff/compute.h"
#include "standoff/cuda_compute.h"
#include "standoff/error.h"
#include "tests/field/cuda/on_stream.h"
#include "tests/sign/cuda/coarse_grid.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/fields.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using cuda::Outcome;
using emulation::Order;
using testing::bits_of;
using testing::box;
using testing::joined;
using testing::moved;
using testing::reversed;
using testing::sphere;

std::vector<float> signed_on_cpu(const MeshView& mesh, const Grid& grid, double thickness, const SignOptions& sign,
                                 Method method = Method::tiles) {
  std::vector<float> values(static_cast<std::size_t>(grid.sample_count()));
  ComputeOptions options{.sign = sign};
  options.method = method;
  options.skip.kind = SkipRule::Kind::none;
  options.execution.backend = Backend::cpu;
  compute_into(mesh, grid, thickness, values, {}, options);
  return values;
}

Outcome run(cuda::Task task) {
  Outcome outcome{};
  task.outcome = &outcome;
  const std::int64_t bytes = emulated::workspace_bytes(
      task, 4 * cuda::likely_entries(task.mesh.triangle_count, task.grid, task.thickness, task.method));
  const emulated::Memory workspace(bytes);
  emulated::enqueue(task, workspace.as<void>(), bytes);
  return outcome;
}

// Dense values of the device.
struct Dense {
  Outcome outcome;
  std::vector<float> values;
};
Dense dense(const Mesh& mesh, const Grid& grid, double thickness, const SignOptions& sign = {},
            Method method = Method::tiles) {
  Dense made{{}, std::vector<float>(static_cast<std::size_t>(grid.sample_count()), -77.0f)};
  cuda::Task task = emulated_task(mesh, grid, thickness, sign);
  task.method = method;
  task.output.values = made.values.data();
  made.outcome = run(task);
  return made;
}

// Sparse output, with the samples outside the tiles that are stored.
Dense sparse(const Mesh& mesh, const Grid& grid, double thickness, const SignOptions& sign) {
  const Size3 tiles = DistanceField::tiles_of(grid.size);
  std::vector<std::int32_t> slots(static_cast<std::size_t>(tiles.count()));
  std::vector<float> stored(slots.size() * DistanceField::kTileSamples, 0.0f);
  cuda::Task task = emulated_task(mesh, grid, thickness, sign);
  task.output = {.values = stored.data(), .slots = slots.data(), .slot_capacity = tiles.count()};
  Dense made{run(task), std::vector<float>(static_cast<std::size_t>(grid.sample_count()))};
  testing::for_each_sample(grid, [&](auto i, auto j, auto k) {
    const std::int32_t slot = slots[static_cast<std::size_t>(i / 8 + tiles.x * (j / 8 + tiles.y * (k / 8)))];
    const float far = static_cast<float>(slot == DistanceField::kInside ? -thickness : thickness);
    made.values[static_cast<std::size_t>(grid.index(i, j, k))] =
        slot < 0 ? far : stored[static_cast<std::size_t>(512 * slot + i % 8 + 8 * (j % 8 + 8 * (k % 8)))];
  });
  return made;
}

// On samples on faces, edges and corners of boxes with whole corners, and on slanted planes of whole tetrahedra.
const Grid kWholeGrid{{21, 20, 19}, {-5, -5, -5}, {1, 1, 1}};

std::vector<Mesh> closed_meshes() {
  std::vector<Mesh> all{sphere(), moved(sphere(16), {2.5, 3, 2}, 4.3), moved(testing::torus(), {4, 4, 4}, 3.7),
                        scenes::make("catapult", 3000)};
  all.push_back(joined(joined(box({0, 0, 0}, {4, 4, 4}), box({2, 2, 2}, {6, 6, 6})), box({4, 0, 0}, {7, 3, 5})));
  all.push_back(joined(box({-40, -30, -20}, {50, 2, 3}), box({1, 1, 1}, {300, 90, 80})));  // of many rows
  testing::Random random(7);
  for (const std::uint32_t half : {3u, 9u}) {
    std::vector<testing::Tetrahedron> outwards;
    for (testing::Tetrahedron t : testing::integer_tetrahedra(random, 40, half)) {
      const int side = testing::orientation(t[0], t[1], t[2], t[3]);
      if (side == 0) continue;
      if (side < 0) std::swap(t[0], t[1]);
      outwards.push_back(t);
    }
    all.push_back(testing::mesh_of(outwards));
  }
  return all;
}

Grid grid_around(const Mesh& mesh) {
  return mesh.triangles.size() < 1000 ? kWholeGrid : testing::coarse_grid(mesh, 22);
}

TEST(DeviceSign, ClosedMeshesHaveTheBitsOfTheCpu) {
  for (const Mesh& mesh : closed_meshes()) {
    const Grid grid = grid_around(mesh);
    SCOPED_TRACE(mesh.triangles.size());
    for (const double thickness : {2.0 * grid.max_spacing(), testing::kInfinity}) {
      const std::vector<float> expected = signed_on_cpu(mesh, grid, thickness, {});
      EXPECT_TRUE(std::ranges::any_of(expected, [](float v) { return v < 0; }));
      for (const Order order : {Order::forward, Order::reverse, Order::random}) {
        if (testing::kSanitized && order != Order::random) continue;
        const emulation::OrderScope scope(order);
        const Dense made = dense(mesh, grid, thickness);
        EXPECT_EQ(made.outcome.doubts, 0u);
        EXPECT_TRUE(bits_of(made.values) == bits_of(expected));
      }
      if (thickness == testing::kInfinity) continue;
      const Dense tiles = sparse(mesh, grid, thickness, {});
      EXPECT_TRUE(bits_of(tiles.values) == bits_of(expected));
      EXPECT_TRUE(bits_of(dense(mesh, grid, thickness, {}, Method::thesis).values) ==
                  bits_of(signed_on_cpu(mesh, grid, thickness, {}, Method::thesis)));
    }
  }
}

TEST(DeviceSign, RulesInversionAndOrientationAreObeyed) {
  const Mesh overlapping = joined(box({0, 0, 0}, {6, 6, 6}), box({2, 2, 2}, {9, 9, 9}));
  const Mesh hollow = joined(box({0, 0, 0}, {8, 8, 8}), reversed(box({2, 2, 2}, {5, 5, 5})));
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd})
    for (const bool invert : {false, true}) {
      const SignOptions sign{.method = SignMethod::winding, .rule = rule, .invert = invert};
      EXPECT_TRUE(bits_of(dense(overlapping, kWholeGrid, 2, sign).values) ==
                  bits_of(signed_on_cpu(overlapping, kWholeGrid, 2, sign)));
      EXPECT_TRUE(bits_of(sparse(overlapping, kWholeGrid, 2, sign).values) ==
                  bits_of(signed_on_cpu(overlapping, kWholeGrid, 2, sign)));
      SignOptions as_oriented = sign;
      as_oriented.as_oriented = true;
      const Dense made = dense(hollow, kWholeGrid, 2, as_oriented);
      EXPECT_EQ(made.outcome.doubts, 0u);
      EXPECT_TRUE(bits_of(made.values) == bits_of(signed_on_cpu(hollow, kWholeGrid, 2, as_oriented)));
    }
}

TEST(DeviceSign, WindowsHaveTheSignsOfTheWholeGrid) {
  const Mesh mesh = moved(sphere(16), {20.3, 21, 19}, 17);
  const Grid grid{{44, 45, 43}, {-1, -1, -1}, {1, 1, 1}};
  const std::vector<float> whole = signed_on_cpu(mesh, grid, 2, {});
  const Grid window = grid.window({16, 16, 16}, {17, 24, 20});
  const Dense made = dense(mesh, window, 2);
  std::int64_t inside = 0;
  testing::for_each_sample(window, [&](auto i, auto j, auto k) {
    const float value = made.values[static_cast<std::size_t>(window.index(i, j, k))];
    inside += value < 0;
    ASSERT_EQ(value, whole[static_cast<std::size_t>(grid.index(i + 16, j + 16, k + 16))]);
  });
  EXPECT_GT(inside, 1000);
}

// Few steps are held at a time: then it takes several passes.
TEST(DeviceSign, LayersOfTilesTakeTurns) {
  const Mesh mesh = moved(sphere(16), {20.3, 21, 19}, 17);
  const Grid grid{{44, 45, 43}, {-1, -1, -1}, {1, 1, 1}};
  for (const std::int64_t most : {std::int64_t{1}, std::int64_t{2 * 512 * 36}}) {
    std::vector<float> values = on_cpu(mesh, grid, 2);
    Outcome outcome{};
    cuda::Task task = emulated_task(mesh, grid, 2, {});
    task.output.values = values.data();
    task.outcome = &outcome;
    gpu::Workspace measure(nullptr);
    const emulated::SignArrays sizes(measure, task, most);
    EXPECT_LT(sizes.layers_at_once, 6);
    const emulated::Memory memory(measure.used());
    gpu::Workspace room(memory.as<void>());
    emulated::SignArrays(room, task, most).enqueue(task, nullptr);
    EXPECT_TRUE(bits_of(values) == bits_of(signed_on_cpu(mesh, grid, 2, {})));
  }
}

Mesh pile(int sheets) {
  Mesh mesh;
  for (int n = 0; n < sheets; ++n) mesh = joined(mesh, box({1, 1, 1}, {6, 6, 6}));
  return mesh;
}

TEST(DeviceSign, DoubtsAreToldAndTheHostDecides) {
  Mesh with_hole = sphere();
  with_hole.triangles.pop_back();
  Mesh flat = box();
  for (Vec3& v : flat.vertices) v.z = 0;
  const Mesh soup = [] {
    Mesh apart;
    const Mesh ball = sphere();
    for (const Triangle& t : ball.triangles)
      testing::add_triangle(apart, ball.vertices[t[0]], ball.vertices[t[1]], ball.vertices[t[2]]);
    return apart;
  }();
  struct Case {
    Mesh mesh;
    unsigned long long doubts;
  };
  const Case cases[] = {{with_hole, Outcome::kOpen | Outcome::kNotOutwards},
                        {reversed(sphere()), Outcome::kNotOutwards},
                        {joined(box({0, 0, 0}, {8, 8, 8}), reversed(box({2, 2, 2}, {5, 5, 5}))), Outcome::kNotOutwards},
                        {soup, Outcome::kNotOutwards},
                        {flat, Outcome::kNotOutwards},
                        {testing::solid_soup(3, 6), Outcome::kNotOutwards},
                        {pile(127), 0},
                        {pile(128), Outcome::kTooDeep}};
  for (const Case& each : cases) {
    SCOPED_TRACE(each.mesh.triangles.size());
    const Dense made = dense(each.mesh, kWholeGrid, 2);
    EXPECT_EQ(made.outcome.doubts, each.doubts);
    const std::vector<float> expected = signed_on_cpu(each.mesh, kWholeGrid, 2, {});
    std::vector<float> values(expected.size(), -77.0f);
    const cuda::FieldRequest request{each.mesh, kWholeGrid, 2, values.data(), Method::tiles, {}};
    const ComputeReport report = cuda::value_or_throw(cuda::compute_each({&request, 1}, kEmulated)[0]);
    EXPECT_TRUE(bits_of(values) == bits_of(expected));
    ComputeOptions options;
    options.execution.backend = Backend::cpu;
    const ComputeReport on_cpu = compute(each.mesh, kWholeGrid, 2, options).report;
    EXPECT_EQ(report.sign.method, on_cpu.sign.method);
    EXPECT_EQ(report.sign.why, on_cpu.sign.why);
    EXPECT_EQ(report.sign.sure, on_cpu.sign.sure);
    EXPECT_EQ(report.provenance.sign, on_cpu.provenance.sign);
    if (each.doubts == 0) continue;
    for (std::size_t n = 0; n < values.size(); ++n) ASSERT_EQ(std::abs(made.values[n]), std::abs(values[n]));
    try {
      cuda::check(made.outcome, cuda::Task{});
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
    }
  }
}

// Tetrahedra around one vertex, as many facing inwards: about so much, as a share of the magnitude, is left of the
// volume.
Mesh balanced(unsigned seed, double excess) {
  testing::Random random(seed);
  Mesh mesh{{{0, 0, 0}}, {}};
  for (int n = 0; n < 7; ++n) {
    Vec3 a = random.in_cube(2) + Vec3{3, 3, 3}, b = random.in_cube(2) + Vec3{3, 3, 3},
         c = random.in_cube(2) + Vec3{3, 3, 3};
    if (dot(a, cross(b, c)) < 0) std::swap(b, c);
    for (const double way : {1.0, -1.0}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      const double longer = n == 0 && way > 0 ? 1 + 14 * excess : 1;
      mesh.vertices.insert(mesh.vertices.end(), {a * (way * longer), b * way, c * way});
      for (const Triangle& t : {Triangle{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}})
        mesh.triangles.push_back(
            {t[0] ? first + t[0] - 1 : 0, t[1] ? first + t[1] - 1 : 0, t[2] ? first + t[2] - 1 : 0});
    }
  }
  return mesh;
}

// The device rounds sums in another order: where that might matter it has doubts.
TEST(DeviceSign, PartsNearAThresholdAreLeftToTheCpu) {
  int outwards = 0, signed_ones = 0;
  for (unsigned seed = 1; seed < 9; ++seed)
    for (const double share : {0.0, 0.5, 0.97, 0.99, 0.999, 1.0, 1.001, 1.01, 1.03, 1.5, 4.0, 10.0}) {
      const Mesh mesh = balanced(seed, share * OutwardTerms::kRounding);
      const bool on_cpu = faces_outwards(mesh), on_device = dense(mesh, kWholeGrid, 2).outcome.doubts == 0;
      EXPECT_TRUE(on_cpu || !on_device) << seed << ' ' << share;
      outwards += on_cpu, signed_ones += on_device;
    }
  EXPECT_GT(outwards, signed_ones);  // between the thresholds
  EXPECT_GT(signed_ones, 0);
}

// Whole calls: each mesh gets its sign, from wherever it comes.
TEST(DeviceSign, MeshesOfOneCallAreDecidedOneByOne) {
  const Mesh closed = moved(sphere(), {4, 4, 4}, 3.3), open = testing::terrain(), inward = reversed(closed);
  const SignOptions choices[] = {{},
                                 {.method = SignMethod::none},
                                 {.method = SignMethod::parity},
                                 {.method = SignMethod::flood},
                                 {.method = SignMethod::winding, .rule = WindingRule::odd, .invert = true},
                                 {.method = SignMethod::winding, .as_oriented = true}};
  std::vector<std::vector<float>> values;
  std::vector<cuda::FieldRequest> requests;
  for (const Mesh* mesh : {&closed, &open, &inward})
    for (const SignOptions& sign : choices) {
      if (mesh == &open && sign.method == SignMethod::parity) continue;
      values.emplace_back(static_cast<std::size_t>(kWholeGrid.sample_count()), -77.0f);
      requests.push_back({*mesh, kWholeGrid, 2.5, values.back().data(), Method::tiles, sign});
    }
  const auto answers = cuda::compute_each(requests, kEmulated);
  for (std::size_t n = 0; n < requests.size(); ++n) {
    SCOPED_TRACE(n);
    cuda::value_or_throw(answers[n]);
    EXPECT_TRUE(bits_of(values[n]) == bits_of(signed_on_cpu(requests[n].mesh, kWholeGrid, 2.5, requests[n].sign)));
  }
  EXPECT_EQ(emulated::memory_taken, 0);
}

template <class Use>
std::optional<ErrorCode> code_of(const Use& use) {
  try {
    use();
  } catch (const Error& error) {
    return error.code();
  }
  return std::nullopt;
}

TEST(DeviceSign, WhatHasNoSignIsAnError) {
  const Mesh mesh = sphere(), open = testing::terrain();
  std::vector<float> values(static_cast<std::size_t>(kWholeGrid.sample_count()), -77.0f);
  const auto asked = [&](const Mesh& of, const SignOptions& sign) {
    const cuda::FieldRequest request{of, kWholeGrid, 2, values.data(), Method::tiles, sign};
    return code_of([&] { cuda::value_or_throw(cuda::compute_each({&request, 1}, kEmulated)[0]); });
  };
  EXPECT_EQ(asked(mesh, {.method = SignMethod::normal}), ErrorCode::usage);
  EXPECT_EQ(asked(mesh, {.method = SignMethod::shell, .shell = 0.1}), ErrorCode::usage);
  EXPECT_EQ(asked(mesh, {.outer = true}), ErrorCode::usage);
  EXPECT_EQ(asked(mesh, {.method = SignMethod::none, .invert = true}), ErrorCode::usage);
  EXPECT_EQ(asked(open, {.method = SignMethod::parity}), ErrorCode::input);
  EXPECT_EQ(asked(open, {.method = SignMethod::winding, .strict = true}), ErrorCode::doubt);
  Mesh broken = mesh;
  broken.triangles[3][0] = 4711;
  EXPECT_EQ(asked(broken, {}), ErrorCode::input);

  cuda::Task wide = emulated_task(mesh, {{std::int64_t{1} << 31, std::int64_t{1} << 31, 1}, {}, {1, 1, 1}}, 2, {});
  EXPECT_EQ(code_of([&] { emulated::workspace_bytes(wide, 0); }), ErrorCode::limit);
  wide = emulated_task(mesh, kWholeGrid, 2, {});
  const std::uint32_t none_kept = 0;
  wide.mesh.kept = &none_kept;
  wide.mesh.kept_count = 1;
  wide.mesh.triangle_count = 0;
  wide.output.values = values.data();
  EXPECT_EQ(code_of([&] { run(wide); }), ErrorCode::usage);

  std::vector<std::int32_t> slots(27);
  cuda::Task task = emulated_task(mesh, kWholeGrid, 0.5, {});
  task.output = {.values = values.data(), .slots = slots.data(), .slot_capacity = 0};
  EXPECT_EQ(code_of([&] { run(task); }), ErrorCode::usage);
  task.thickness = 2;
  task.method = Method::jumpflood;
  EXPECT_EQ(code_of([&] { run(task); }), ErrorCode::usage);
  task.method = Method::tiles;
  task.sign.method = SignMethod::flood;
  EXPECT_EQ(code_of([&] { run(task); }), ErrorCode::usage);
  // Lists without room, and triangles that the field leaves out but the sign reads.
  task.sign = {};
  EXPECT_NE(run(task).stopped, 0u);
  Mesh left_out = mesh;
  left_out.triangles.push_back({0, 1, 4711});
  std::vector<std::uint32_t> kept(mesh.triangles.size());
  for (std::uint32_t n = 0; n < kept.size(); ++n) kept[n] = n;
  cuda::Task some = emulated_task(left_out, kWholeGrid, 2, {});
  some.mesh.kept = kept.data();
  some.mesh.kept_count = static_cast<std::int64_t>(kept.size());
  some.output.values = values.data();
  EXPECT_EQ(run(some).bad_triangle, mesh.triangles.size());
}

}  // namespace
}  // namespace standoff
