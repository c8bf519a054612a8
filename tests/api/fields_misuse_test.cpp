// SPDX-License-Identifier: Apache-2.0
// grid.h, mesh.h, field.h, compute.h and verify.h with arguments that make no sense.
#include "standoff/compute.h"
#include "standoff/confidence.h"
#include "standoff/exposed.h"
#include "standoff/inspect.h"
#include "standoff/mesh_report.h"
#include "standoff/occupancy.h"
#include "standoff/points.h"
#include "standoff/sign_decision.h"
#include "standoff/slabs.h"
#include "standoff/testing/emulation.h"
#include "standoff/thesis.h"
#include "standoff/update.h"
#include "standoff/verify.h"
#include "standoff/windows.h"
#include "tests/api/misuse.h"

namespace standoff {
namespace {

using namespace testing;

const Grid kFieldGrid{{9, 9, 9}, {-1, -1, -1}, {0.4, 0.4, 0.4}};

ComputeOptions on_cpu() { return {.sign = {SignMethod::none}, .execution = {.threads = 1, .backend = Backend::cpu}}; }

TEST(Misuse, Grids) {
  const Mesh mesh = one_triangle();
  std::vector<float> values(8);
  for (const Grid& grid : odd_grids()) {
    const std::string name = "grid " + std::to_string(grid.size.x) + "x" + std::to_string(grid.size.y) + "x" +
                             std::to_string(grid.size.z) + ", spacing " + std::to_string(grid.spacing.y);
    EXPECT_GE(grid.sample_count(), 0) << name;
    expect_answer_or_error(name, [&] { validate(grid); });
    expect_answer_or_error(name, [&] { DistanceField(grid, 1, true); });
    expect_answer_or_error(name, [&] {
      if (grid.sample_count() < 1'000'000) inspect(DistanceField(grid, 1));
    });
    expect_answer_or_error(name, [&] { DistanceField::from_dense(grid, 1, {}); });
    expect_answer_or_error(name, [&] { DistanceField().reset(grid, 1); });
    expect_answer_or_error(name, [&] { compute(mesh, grid, kFullField, on_cpu()); });
    expect_answer_or_error(name, [&] { compute_into(mesh, grid, 1, values, on_cpu()); });
    for (const double thickness : {1.0, kInfinite}) {
      expect_answer_or_error(name, [&] { EXPECT_GT(estimate(mesh, grid, thickness, on_cpu()).whole, 0); });
      expect_answer_or_error(name, [&] { EXPECT_GT(estimate(1, grid, thickness, on_cpu()).dense, 0); });
      expect_answer_or_error(name, [&] { EXPECT_GT(estimate(mesh, grid, thickness, on_cpu()).slabs, 0); });
      expect_answer_or_error(name, [&] { SlabComputation(mesh, grid, thickness, on_cpu(), 1).next(); });
    }
  }
}

TEST(Misuse, Windows) {
  const Mesh triangle = one_triangle();
  WindowComputation windows(triangle, kFieldGrid, 1, {9, 9, 9}, on_cpu());
  DistanceField field;
  for (const std::int64_t n : kCounts)
    for (const std::int64_t m : kCounts) {
      const std::string name = named("first", n) + ", " + named("size", m);
      expect_answer_or_error(name, [&] { windows.compute({n, 0, 0}, {m, 1, 1}, field); });
      expect_answer_or_error(name, [&] { windows.compute({0, 0, n}, {1, 1, m}, field); });
      expect_answer_or_error(name, [&] { static_cast<void>(windows.is_reached({0, n, 0}, {1, m, 1})); });
      expect_answer_or_error(name, [&] { WindowComputation(triangle, kFieldGrid, 1, {n, m, 1}, on_cpu()); });
      expect_answer_or_error(name, [&] {
        EXPECT_GT(estimate_window(triangle, kFieldGrid, 1, {n, 1, m}, on_cpu()), 0);
      });
    }
  for (const Mesh& mesh : unusable_meshes())
    expect_answer_or_error("mesh", [&] { WindowComputation(mesh, kFieldGrid, 1, {9, 9, 9}, on_cpu()); });
}

TEST(Misuse, SignDecisions) {
  const Mesh triangle = one_triangle();
  const SignDecision none, made = WindowComputation(triangle, kFieldGrid, 1, {9, 9, 9}, on_cpu()).decision();
  EXPECT_TRUE(none.bytes().empty());
  expect_usage("empty", [&] { static_cast<void>(none.report()); });
  expect_usage("empty", [&] { static_cast<void>(none.mesh_hash()); });
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{19}, std::size_t{5000}})
    expect_answer_or_error("bytes", [&] { SignDecision::from_bytes(std::vector<std::byte>(bytes)); });
  ComputeOptions decided = on_cpu();
  decided.decision = made;
  for (const Mesh& mesh : unusable_meshes())
    expect_answer_or_error("mesh", [&] { WindowComputation(mesh, kFieldGrid, 1, {9, 9, 9}, decided); });
  for (const Grid& grid : odd_grids())
    expect_answer_or_error("grid", [&] {
      if (grid.sample_count() < 1'000'000) compute(triangle, grid, 1, decided);
    });
}

TEST(Misuse, Updates) {
  const Mesh triangle = one_triangle();
  const DistanceField computed = compute(triangle, kFieldGrid, 1, on_cpu()).field;
  for (const bool hash : {false, true})
    for (const Mesh& mesh : unusable_meshes()) {
      ComputeOptions options = on_cpu();
      options.hash_mesh = hash;
      std::vector<std::uint32_t> all;
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) all.push_back(t);
      for (const std::vector<std::uint32_t>& changed : {all, {}, {0}, {kNoTriangle}, {7, 0, 7}}) {
        DistanceField field = computed;
        expect_answer_or_error("after", [&] { update_field(triangle, mesh, changed, field, options); });
        field = computed;
        expect_answer_or_error("before", [&] { update_field(mesh, triangle, changed, field, options); });
      }
      expect_answer_or_error("changed", [&] { static_cast<void>(changed_triangles(triangle, mesh)); });
      expect_answer_or_error("changed", [&] { static_cast<void>(changed_triangles(mesh, triangle)); });
    }
  DistanceField empty;
  expect_usage("empty", [&] { update_field(triangle, triangle, {}, empty, on_cpu()); });
}

TEST(Misuse, LiveFields) {
  const Mesh triangle = one_triangle();
  for (const Mesh& mesh : unusable_meshes())
    expect_answer_or_error("mesh", [&] { LiveField(mesh, kFieldGrid, 1, on_cpu()); });
  LiveField live(triangle, kFieldGrid, 1, on_cpu());
  const std::vector<double> odd{0, -1, 1e-320, 1e300, std::numeric_limits<double>::infinity(), std::nan("")};
  for (const double x : odd)
    for (const std::vector<std::uint32_t>& vertices :
         std::vector<std::vector<std::uint32_t>>{{}, {0}, {2, 2}, {3}, {kNoTriangle}})
      for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
        const std::vector<Vec3> positions(count, Vec3{x, 0.1, x});
        expect_answer_or_error("move", [&] { live.move(vertices, positions); });
        EXPECT_EQ(live.field().grid(), kFieldGrid);
        EXPECT_EQ(live.mesh().triangles.size(), live.report().triangles == 0 ? 0u : triangle.triangles.size());
      }
}

TEST(Misuse, Slabs) {
  const Mesh triangle = one_triangle();
  for (const std::int64_t n : kCounts) {
    expect_answer_or_error(named("samples", n), [&] {
      SlabComputation slabs(triangle, kFieldGrid, 1, on_cpu(), n);
      EXPECT_NE(slabs.next(), nullptr);
    });
    expect_answer_or_error(named("samples", n),
                           [&] { EXPECT_GT(estimate(triangle, kFieldGrid, 1, on_cpu(), n).slabs, 0); });
  }
  for (const double x : kNumbers)
    expect_answer_or_error(named("thickness", x), [&] { SlabComputation(triangle, kFieldGrid, x, on_cpu()).next(); });
  for (const Mesh& mesh : odd_meshes())
    expect_answer_or_error("mesh", [&] { SlabComputation(mesh, kFieldGrid, 1, on_cpu()).next(); });
  for (const Mesh& mesh : unusable_meshes()) {
    expect_answer_or_error("mesh", [&] { SlabComputation(mesh, kFieldGrid, 1, on_cpu()).next(); });
    expect_answer_or_error("mesh", [&] { estimate(mesh, kFieldGrid, 1, on_cpu()); });
  }
}

TEST(Misuse, CountsOfSamplesDoNotOverflow) {
  EXPECT_EQ((Size3{kMost, kMost, kMost}.count()), kMost);
  EXPECT_EQ((Size3{std::int64_t{1} << 32, std::int64_t{1} << 31, 1}.count()), kMost);
  EXPECT_EQ((Size3{std::int64_t{1} << 31, std::int64_t{1} << 31, 1}.count()), std::int64_t{1} << 62);
  EXPECT_EQ((Size3{-1, -1, 5}.count()), 0);
  EXPECT_EQ((Size3{3, 4, 5}.count()), 60);
}

TEST(Misuse, FittingGrids) {
  std::vector<Box> boxes(1);
  for (const double x : kNumbers) boxes.push_back({{0, 0, 0}, {x, 1, 1}});
  boxes.push_back({{-1e308, 0, 0}, {1e308, 1, 1}});
  for (const Box& box : boxes) {
    for (const std::int64_t n : kCounts) {
      expect_answer_or_error(named("samples", n), [&] { fit_resolution(box, n); });
      expect_answer_or_error(named("size", n), [&] { fit_size(box, {n, 1, n}); });
    }
    for (const double x : kNumbers) {
      expect_answer_or_error(named("padding", x), [&] { fit_resolution(box, 5, {.samples = x}); });
      expect_answer_or_error(named("thickness", x), [&] { fit_resolution(box, 5, x); });
      expect_answer_or_error(named("band", x), [&] { fit_resolution(box, 5, padding_for_samples(x)); });
      expect_answer_or_error(named("padding", x), [&] { fit_size(box, {2, 2, 2}, {.length = x}); });
      expect_answer_or_error(named("padding", x), [&] { fit_size(box, {9, 9, 9}, {.least_samples = x}); });
      expect_answer_or_error(named("padding", x), [&] { fit_spacing(box, {1, 1, 1}, {.length = 5, .most_share = x}); });
      expect_answer_or_error(named("spacing", x), [&] { fit_spacing(box, {1, x, 1}, 1); });
      expect_answer_or_error(named("thickness", x), [&] { minimum_grid(box, x); });
      expect_answer_or_error(named("e", x), [&] { minimum_grid(box, 1, x); });
      expect_answer_or_error(named("speed", x), [&] { minimum_grid(box, 1, 2, x); });
    }
  }
}

TEST(Misuse, MemoryLimits) {
  expect_answer_or_error("limit", [] { EXPECT_NE(default_memory_limit(), 0); });
}

TEST(Misuse, Meshes) {
  for (const Mesh& mesh : odd_meshes()) {
    expect_answer_or_error("validate", [&] { validate(mesh); });
    expect_answer_or_error("bounds", [&] { bounds(mesh); });
    expect_answer_or_error("hash", [&] { content_hash(mesh); });
    expect_answer_or_error("report", [&] { report(mesh); });
    expect_answer_or_error("points", [&] { closest_points(mesh, std::vector<Vec3>(2)); });
    expect_answer_or_error("occupancy", [&] { occupancy(mesh, kFieldGrid); });
    expect_answer_or_error("exposed", [&] { exposed_triangles(mesh); });
    expect_answer_or_error("confidence", [&] { winding_margins(mesh, kFieldGrid); });
    expect_answer_or_error("confidence", [&] { sign_confidence(mesh, DistanceField(kFieldGrid, 1), {}); });
    expect_answer_or_error("estimate", [&] { estimate(mesh, kFieldGrid, 1, on_cpu()); });
    expect_answer_or_error("verify", [&] { verify(DistanceField(kFieldGrid, 1), mesh); });
    for (const double thickness : {1.0, kInfinite})
      for (const Method method : {Method::tiles, Method::thesis}) {
        ComputeOptions options = on_cpu();
        options.method = method;
        expect_answer_or_error("compute", [&] { compute(mesh, kFieldGrid, thickness, options); });
      }
  }
}

void expect_options(const std::string& name, const ComputeOptions& options, double thickness = kFullField) {
  const Mesh mesh = one_triangle();
  std::vector<float> values(static_cast<std::size_t>(kFieldGrid.sample_count()));
  DistanceField field;
  expect_answer_or_error(name, [&] { compute(mesh, kFieldGrid, thickness, options); });
  expect_answer_or_error(name, [&] { compute_into(mesh, kFieldGrid, thickness, field, options); });
  expect_answer_or_error(name, [&] { compute_into(mesh, kFieldGrid, thickness, values, options); });
  expect_answer_or_error(name, [&] { EXPECT_GT(estimate(mesh, kFieldGrid, thickness, options).whole, 0); });
}

TEST(Misuse, OptionsOfCompute) {
  const auto with = [](auto ComputeOptions::*member, auto value) {
    ComputeOptions options = on_cpu();
    options.*member = value;
    return options;
  };
  for (const double x : kNumbers) {
    expect_options(named("thickness", x), on_cpu(), x);
    expect_options(named("fraction", x), with(&ComputeOptions::skip, SkipRule{SkipRule::Kind::neighbour, x}));
  }
  for (const std::int64_t n : kCounts) expect_options(named("memory limit", n), with(&ComputeOptions::memory_limit, n));
  for (const ComputeOptions& options : {with(&ComputeOptions::method, none_of<Method>()),
                                        with(&ComputeOptions::skip, SkipRule{none_of<SkipRule::Kind>(), 1})}) {
    expect_options("no such number", options);
    expect_usage("no such number", [&] { compute(one_triangle(), kFieldGrid, 1, options); });
  }
}

// Every call that runs somewhere says the same about where it cannot run.
TEST(Misuse, Executions) {
  std::vector<Execution> refused{{.device = -1}, {.backend = none_of<Backend>()}, {.simd = none_of<Simd>()}};
  for (const int threads : kThreads) refused.push_back({.threads = threads});  // a million ended in a crash inside TBB
  std::vector<float> values(static_cast<std::size_t>(kFieldGrid.sample_count()));
  DistanceField field(kFieldGrid, 1);
  for (const Execution& execution : refused) {
    const ComputeOptions options{.execution = execution};
    expect_usage("compute", [&] { compute(one_triangle(), kFieldGrid, 1, options); });
    expect_usage("compute_into", [&] { compute_into(one_triangle(), kFieldGrid, 1, values, options); });
    expect_usage("compute_into", [&] { compute_into(one_triangle(), kFieldGrid, 1, field, options); });
    expect_usage("estimate", [&] { estimate(one_triangle(), kFieldGrid, 1, options); });
    expect_usage("estimate", [&] { estimate(1, kFieldGrid, 1, options); });
    expect_usage("verify", [&] { verify(field, one_triangle(), {.execution = execution}); });
    expect_usage("points", [&] { closest_points(one_triangle(), {}, {.execution = execution}); });
    expect_usage("occupancy", [&] {
      occupancy(one_triangle(), kFieldGrid, {.sign = {SignMethod::automatic}, .execution = execution});
    });
    expect_usage("exposed",
                 [&] { exposed_triangles(one_triangle(), {.sign = {SignMethod::automatic}, .execution = execution}); });
  }
  for (const Backend backend : {Backend::cuda, testing::kEmulated})
    expect_usage("verify", [&] { verify(field, one_triangle(), {.execution = {.backend = backend}}); });
  expect_usage("points", [&] { closest_points(one_triangle(), {}, {.execution = {.backend = Backend::cuda}}); });
  expect_answer_or_error("device", [&] {
    compute(one_triangle(), kFieldGrid, 1,
            {.sign = {SignMethod::none}, .execution = {.backend = Backend::cuda, .device = 1'000'000}});
  });
  ComputeOptions most = on_cpu();
  most.execution.threads = kMaxThreads;
  EXPECT_EQ(compute(one_triangle(), kFieldGrid, 1, most).report.threads, kMaxThreads);
}

// A count of 2^62 triangles gave a negative number of bytes, and -1 was a count.
TEST(Misuse, MemoryOfAnyCount) {
  for (const std::int64_t n : kCounts)
    for (const double thickness : {0.5, kInfinite})
      for (const Method method : {Method::tiles, Method::thesis})
        for (const Backend backend : {Backend::cpu, testing::kEmulated}) {
          ComputeOptions options = on_cpu();
          options.method = method;
          options.execution.backend = backend;
          const auto ask = [&] { EXPECT_GT(estimate(n, kFieldGrid, thickness, options).whole, 0) << n; };
          if (n < 1)
            expect_usage(named("triangles", n), ask);
          else
            expect_answer_or_error(named("triangles", n), ask);
          const Grid largest{{std::int64_t{1} << 40, std::int64_t{1} << 22, 1}, {}};
          expect_answer_or_error(named("triangles", n),
                                 [&] { EXPECT_GT(estimate(n, largest, thickness, options).whole, 0) << n; });
        }
}

void expect_field(const std::string& name, DistanceField& field) {
  for (const std::int64_t a : kCounts)
    for (const std::int64_t b : {std::int64_t{0}, std::int64_t{-8}, kMost}) {
      expect_answer_or_error(name, [&] { field.value(a, b, 0); });
      expect_answer_or_error(name, [&] { field.nearest(0, a, b); });
      expect_answer_or_error(name, [&] { field.tile(b, 0, a); });
      expect_answer_or_error(name, [&] { field.tile_nearest(a, b, a); });
      expect_answer_or_error(name, [&] { field.background(a, b, 0); });
      expect_answer_or_error(name, [&] { field.mark_inside(a, b, a); });
      expect_answer_or_error(name, [&] { field.mark_outside(a, b, a); });
      expect_answer_or_error(name, [&] { field.erase_tile(b, a, b); });
      expect_answer_or_error(name, [&] { field.erase_tiles(std::vector<Size3>{{0, 0, 0}, {a, b, a}}); });
      expect_answer_or_error(name, [&] { field.store_nearest(a, b, b); });
      expect_answer_or_error(name, [&] { field.store_tile(a, b, b); });
      std::vector<float> values(81);
      std::vector<std::uint32_t> nearest(81);
      expect_answer_or_error(name, [&] { field.copy_slices(a, b, values); });
      expect_answer_or_error(name, [&] { field.copy_slices(b, a, values); });
      expect_answer_or_error(name, [&] { field.copy_slices(a, b, {}); });
      expect_answer_or_error(name, [&] { field.copy_nearest_slices(b, a, nearest); });
    }
  for (const double x : kNumbers) {
    expect_answer_or_error(name, [&] { field.interpolate({x, 0, x}); });
    expect_answer_or_error(name, [&] { field.gradient({0, x, 0}); });
  }
  expect_answer_or_error(name, [&] { field.to_dense(); });
  expect_answer_or_error(name, [&] { field.tile_coordinates(); });
  expect_answer_or_error(name, [&] { field.tile_nearest_values(); });
  expect_answer_or_error(name, [&] { EXPECT_EQ(std::ssize(field.tile_values()), 512 * field.stored_tiles()); });
  expect_answer_or_error(name, [&] { EXPECT_GE(field.memory_bytes(), 0); });
  expect_answer_or_error(name, [&] { verify(field, one_triangle()); });
  expect_answer_or_error(name, [&] { field.erase_nearest(); });
  expect_answer_or_error(name, [&] { DistanceField(field).value(0, 0, 0); });
}

TEST(Misuse, Points) {
  for (const double x : kNumbers)
    expect_answer_or_error(named("point", x), [&] { closest_points(one_triangle(), std::vector<Vec3>{{0, x, 0}}); });
  expect_usage("not finite", [&] { closest_points(one_triangle(), std::vector<Vec3>{{0, kNaN, 0}}); });
}

TEST(Misuse, Fields) {
  DistanceField empty, plain(kFieldGrid, 1), with_nearest(kFieldGrid, 1, true), moved_from(kFieldGrid, 1, true);
  const DistanceField taken = std::move(moved_from);
  expect_field("empty field", empty);
  expect_field("field", plain);
  expect_field("field with nearest triangles", with_nearest);
  expect_field("moved from", moved_from);  // NOLINT(bugprone-use-after-move): it is an empty field
  for (const double x : kNumbers) expect_answer_or_error(named("thickness", x), [&] { DistanceField(kFieldGrid, x); });
  expect_usage("no sample", [&] { plain.value(9, 0, 0); });
  expect_usage("no sample", [&] { plain.value(0, -1, 0); });
  expect_usage("no tile", [&] { plain.tile(0, 2, 0); });
  expect_usage("no nearest", [&] { plain.nearest(0, 0, 0); });
}

TEST(Misuse, Verify) {
  const DistanceField field = compute(one_triangle(), kFieldGrid, kFullField, on_cpu()).field;
  for (const std::int64_t n : kCounts) {
    VerifyOptions options{.samples = n, .execution = {.threads = 1}};
    expect_answer_or_error(named("samples", n), [&] { EXPECT_TRUE(verify(field, one_triangle(), options).ok()); });
  }
  const DistanceField long_one = compute(one_triangle(), {{5000, 1, 1}, {}}, kFullField, on_cpu()).field;
  EXPECT_TRUE(verify(long_one, one_triangle()).ok());
  for (const double x : kNumbers) expect_answer_or_error("bound", [&] { allowed_error(kFieldGrid, x); });
  for (const Grid& grid : odd_grids())
    if (grid.size.x > 0 && grid.size.y > 0 && grid.size.z > 0) allowed_error(grid, 1);
}

// What a callback throws is its caller's, whatever it is.
TEST(Misuse, WhatCallbacksThrowComesOut) {
  ComputeOptions options = on_cpu();
  options.progress = [](const Progress&) -> bool { throw 5; };
  EXPECT_THROW(compute(one_triangle(), kFieldGrid, 1, options), int);
  options.progress = [](const Progress&) -> bool { throw std::bad_alloc(); };
  EXPECT_THROW(compute(one_triangle(), kFieldGrid, 1, options), std::bad_alloc);
  VerifyOptions verifying;
  verifying.progress = [](const Progress&) -> bool { throw std::string("mine"); };
  EXPECT_THROW(verify(DistanceField(kFieldGrid, 1), one_triangle(), verifying), std::string);
}

}  // namespace
}  // namespace standoff
