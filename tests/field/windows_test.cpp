// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// A window of a field is that part of the whole: every sample, nearest triangle and sidecar, bit for bit.
#include "standoff/windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <span>
#include <string>
#include <vector>

#include "standoff/sidecars.h"
#include "tests/collision/bodies.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_mesh.h"
#include "tests/support/sanitized.h"

namespace standoff::testing::of_windows {
namespace {

// Far from the origin, so that any other way to compute a position has other bits.
const Vec3 kFar{1000.1, -20000.3, 0.7};
const Grid kWindowsGrid{{53, 61, 77}, kFar - Vec3{1.25, 1.3, 1.35}, {0.049, 0.044, 0.0351}};

Mesh at_grid(const Mesh& mesh) { return moved(mesh, kFar); }
Mesh open_ball() { return with_hole(ball_mesh(1, 6), 40, 55); }
std::vector<Mesh> meshes() {
  return {at_grid(ball_mesh(1, 6)), at_grid(open_ball()), at_grid(random_soup(3, 200, 1, 0.3)),
          at_grid(nasty_soup(3, 60, 1))};
}

struct Part {
  Size3 first, size;
};
// Of whole bricks, across the grid's end, and of any samples.
const std::vector<Part> kParts{{{0, 0, 0}, {16, 16, 16}},   {{16, 32, 48}, {32, 29, 29}}, {{48, 0, 64}, {5, 16, 13}},
                               {{7, 11, 13}, {20, 19, 30}}, {{52, 60, 76}, {1, 1, 1}},    {{0, 0, 0}, {53, 61, 77}},
                               {{0, 17, 30}, {53, 1, 2}}};

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }

void expect_part(const DistanceField& whole, const DistanceField& window, const Part& part) {
  ASSERT_EQ(window.grid(), whole.grid().window(part.first, part.size));
  EXPECT_EQ(window.thickness(), whole.thickness());
  EXPECT_EQ(window.provenance().sign, whole.provenance().sign);
  EXPECT_EQ(window.provenance().mesh_hash, whole.provenance().mesh_hash);
  ASSERT_EQ(window.has_nearest(), whole.has_nearest());
  std::int64_t wrong = 0;
  const auto& [f, n] = part;
  for (std::int64_t k = 0; k < n.z; ++k)
    for (std::int64_t j = 0; j < n.y; ++j)
      for (std::int64_t i = 0; i < n.x; ++i) {
        wrong += bits_of(window.value(i, j, k)) != bits_of(whole.value(f.x + i, f.y + j, f.z + k));
        if (whole.has_nearest()) wrong += window.nearest(i, j, k) != whole.nearest(f.x + i, f.y + j, f.z + k);
      }
  EXPECT_EQ(wrong, 0) << "from " << f.x << ", " << f.y << ", " << f.z;
}

void expect_parts(const Mesh& mesh, double thickness, const ComputeOptions& options) {
  const DistanceField whole = compute(mesh, kWindowsGrid, thickness, options).field;
  WindowComputation windows(mesh, kWindowsGrid, thickness, kWindowsGrid.size, options);
  WindowComputation small(mesh, kWindowsGrid, thickness, {53, 29, 30}, options);
  DistanceField field;
  for (const Part& part : std::span(kParts).first(kSanitized ? 2 : kParts.size())) {
    windows.compute(part.first, part.size, field);
    expect_part(whole, field, part);
    if (part.size.y > 29 || part.size.z > 30) continue;
    small.compute(part.first, part.size, field);
    expect_part(whole, field, part);
    if (small.is_reached(part.first, part.size)) continue;
    for (const DistanceField::Tile& tile : field.tiles())
      for (const float value : tile.values) EXPECT_EQ(std::abs(value), static_cast<float>(thickness));
  }
}

ComputeOptions by(SignMethod method) {
  return {.sign = {.method = method, .shell = method == SignMethod::shell ? 0.2 : 0},
          .execution = {.threads = 2, .backend = Backend::cpu}};
}

TEST(Windows, ThinThickAndFull) {
  for (const Mesh& mesh : meshes())
    for (const double thickness : {0.05, 0.15, 0.7, kFullField})
      for (const bool nearest : {false, true}) {
        SCOPED_TRACE(thickness);
        ComputeOptions options = by(SignMethod::none);
        options.nearest = nearest;
        expect_parts(mesh, thickness, options);
      }
}

TEST(Windows, EverySign) {
  const std::vector<Mesh> all = meshes();
  for (const SignMethodInfo& sign : kSignMethods)
    for (std::size_t n = 0; n < all.size(); ++n)
      for (const bool invert : {false, true}) {
        if (sign.method == SignMethod::parity && n != 0) continue;  // closed meshes alone
        if (sign.method == SignMethod::none && invert) continue;
        if (kSanitized && invert != (n % 2 != 0)) continue;
        SCOPED_TRACE(std::string(sign.name) + ", mesh " + std::to_string(n));
        ComputeOptions options = by(sign.method);
        options.sign.invert = invert;
        options.nearest = n == 1;
        expect_parts(all[n], n == 2 ? kFullField : 0.11, options);
      }
}

// Windows in which no triangle is, outside and inside, whose tiles are stored or not; row by row and in another order.
TEST(Windows, OfOneSide) {
  const Mesh ball = at_grid(ball_mesh(1, 6));
  const Grid grid{{96, 80, 64}, kFar - Vec3{1.7, 1.4, 1.1}, {0.035, 0.035, 0.035}};
  for (const double thickness : {0.05, 0.5, kFullField})
    for (const bool invert : {false, true}) {
      ComputeOptions options = by(SignMethod::winding);
      options.sign.invert = invert;
      const DistanceField whole = compute(ball, grid, thickness, options).field;
      WindowComputation windows(ball, grid, thickness, {16, 16, 16}, options);
      DistanceField field;
      for (std::int64_t n = 0; n < 6 * 5 * 4; ++n) {
        const std::int64_t m = 7 * n % 120;
        const Part part{{16 * (m % 6), 16 * (m / 6 % 5), 16 * (m / 30)}, {16, 16, 16}};
        windows.compute(part.first, part.size, field);
        expect_part(whole, field, part);
      }
    }
}

TEST(Windows, EveryMethod) {
  for (const MethodInfo& method : kComputeMethods) {
    SCOPED_TRACE(method.name);
    ComputeOptions options = by(SignMethod::winding);
    options.method = method.method;
    expect_parts(at_grid(ball_mesh(1, 6)), 0.15, options);
  }
}

TEST(Windows, SkipRulesAndTheUnionOfParts) {
  const Mesh two = at_grid(joined(ball_mesh(0.6, 5), ball_mesh(0.6, 5, {0.3, 0.3, 0.3})));
  for (const SkipRule::Kind kind : {SkipRule::Kind::exact, SkipRule::Kind::neighbour}) {
    ComputeOptions options = by(SignMethod::winding);
    options.skip.kind = kind;
    options.sign.outer = kind == SkipRule::Kind::exact;
    expect_parts(two, 0.15, options);
  }
}

// Sidecars follow from the positions of samples, which a window has from the whole grid.
TEST(Windows, TheirSidecars) {
  const Mesh mesh = at_grid(open_ball());
  ComputeOptions options = by(SignMethod::winding);
  options.nearest = true;
  const DistanceField whole = compute(mesh, kWindowsGrid, 0.15, options).field;
  const SidecarKind kinds[] = {SidecarKind::closest_point, SidecarKind::barycentric, SidecarKind::feature,
                               SidecarKind::gradient};
  const std::vector<Sidecar> of_whole = sidecars(mesh, whole, kinds);
  WindowComputation windows(mesh, kWindowsGrid, 0.15, {32, 32, 32}, options);
  DistanceField field;
  const Part part{{16, 16, 32}, {32, 32, 32}};
  windows.compute(part.first, part.size, field);
  const std::vector<Sidecar> of_window = sidecars(mesh, field, kinds);
  std::int64_t compared = 0, wrong = 0;
  for (std::int64_t tz = 0; tz < 4; ++tz)
    for (std::int64_t ty = 0; ty < 4; ++ty)
      for (std::int64_t tx = 0; tx < 4; ++tx) {
        const auto slot_of = [](const DistanceField& f, std::int64_t x, std::int64_t y, std::int64_t z) {
          const Size3 tiles = f.tile_count();
          return f.slots()[static_cast<std::size_t>(x + tiles.x * (y + tiles.y * z))];
        };
        const std::int64_t mine = slot_of(field, tx, ty, tz), theirs = slot_of(whole, tx + 2, ty + 2, tz + 4);
        if (mine < 0 || theirs < 0) continue;
        for (std::size_t kind = 0; kind < of_whole.size(); ++kind)
          std::visit(
              [&](const auto& all) {
                const auto& part_of = std::get<std::remove_cvref_t<decltype(all)>>(of_window[kind].values);
                const std::int64_t numbers = 512 * of_whole[kind].components;
                for (std::int64_t n = 0; n < numbers; ++n) {
                  ++compared;
                  wrong += part_of[static_cast<std::size_t>(mine * numbers + n)] !=
                           all[static_cast<std::size_t>(theirs * numbers + n)];
                }
              },
              of_whole[kind].values);
      }
  EXPECT_GT(compared, 10000);
  EXPECT_EQ(wrong, 0);
}

TEST(Windows, OfNothingAreRefused) {
  const Mesh mesh = at_grid(ball_mesh(1, 4));
  WindowComputation windows(mesh, kWindowsGrid, 0.15, {32, 32, 32}, by(SignMethod::none));
  DistanceField field;
  windows.compute({0, 0, 0}, {16, 16, 16}, field);
  const auto refused = [&](const Size3& first, const Size3& size, const char* why) {
    expect_error([&] { windows.compute(first, size, field); }, ErrorCode::usage, why);
    EXPECT_EQ(field.stored_tiles(), 0);
  };
  refused({0, 0, 0}, {0, 1, 1}, "no window of the grid");
  refused({-16, 0, 0}, {16, 16, 16}, "no window of the grid");
  refused({48, 0, 0}, {16, 16, 16}, "along x");
  refused({0, 0, 64}, {16, 16, 14}, "which has 77 there");
  refused({std::numeric_limits<std::int64_t>::max(), 0, 0}, {16, 16, 16}, "no window of the grid");
  refused({0, 0, 0}, {32, 33, 32}, "announce");
  expect_error([&] { static_cast<void>(windows.is_reached({0, 0, 70}, {16, 16, 16})); }, ErrorCode::usage, "along z");
  expect_error([&] { WindowComputation(mesh, kWindowsGrid, 0.15, {0, 1, 1}); }, ErrorCode::usage, "has no samples");
}

// Signs of SignScope::window need no more than the window: a grid that is a window of another one is computed alone.
TEST(Windows, AreGrids) {
  const Mesh mesh = at_grid(ball_mesh(1, 6));
  const DistanceField whole = compute(mesh, kWindowsGrid, 0.15, by(SignMethod::winding)).field;
  const Part part{{16, 32, 48}, {32, 29, 29}};
  const Grid grid = kWindowsGrid.window(part.first, part.size);
  expect_part(whole, compute(mesh, grid, 0.15, by(SignMethod::winding)).field, part);
  std::vector<float> dense(static_cast<std::size_t>(grid.sample_count()));
  compute_into(mesh, grid, 0.15, dense, by(SignMethod::winding));
  DistanceField same;
  WindowComputation(mesh, kWindowsGrid, 0.15, part.size, by(SignMethod::winding)).compute(part.first, part.size, same);
  EXPECT_TRUE(std::ranges::equal(dense, same.to_dense()));
  const Vec3 inside = grid.position(3, 4, 5) + Vec3{0.01, 0.01, 0.01};
  EXPECT_EQ(whole.interpolate(inside), same.interpolate(inside));
  expect_error(
      [&] {
        compute(mesh, kWindowsGrid.window({8, 0, 0}, {16, 16, 16}), 0.15, by(SignMethod::none));
      },
      ErrorCode::usage, "no multiple of 16");
}

// Grids of so many bricks, and so many rows, that their windows share neither bins of triangles nor crossings of rows.
TEST(Windows, OfGridsThatAreMostlyEmpty) {
  const Mesh closed = at_grid(ball_mesh(1, 6)), open = at_grid(open_ball());
  for (const Size3& size : {Size3{40, 2200, 2200}, Size3{1200, 1100, 1200}}) {
    const Vec3 spacing{0.11, 0.05, 0.05};
    const Vec3 first{spacing.x * static_cast<double>(size.x / 2), spacing.y * static_cast<double>(size.y / 2),
                     spacing.z * static_cast<double>(size.z / 2)};
    const Grid grid{size, kFar - first, spacing};
    for (const Mesh* const mesh : {&closed, &open}) {
      const DistanceField whole = compute(*mesh, grid, 0.15, by(SignMethod::winding)).field;
      WindowComputation windows(*mesh, grid, 0.15, {48, 48, 48}, by(SignMethod::winding));
      DistanceField field;
      const auto middle = [&](std::int64_t samples) { return samples / 2 / 16 * 16; };
      const Size3 at{middle(size.x) - 16, middle(size.y) - 16, middle(size.z) - 16};
      for (const Part& part : {Part{at, {32, 48, 32}}, Part{{at.x + 5, at.y + 7, at.z}, {9, 16, 20}},
                               Part{{0, 0, 0}, {16, 16, 16}}, Part{{at.x, at.y, 16}, {16, 16, 16}}}) {
        windows.compute(part.first, part.size, field);
        expect_part(whole, field, part);
      }
      EXPECT_TRUE(windows.is_reached(at, {32, 48, 32}));
      EXPECT_FALSE(windows.is_reached({0, 0, 0}, {16, 16, 16}));
      EXPECT_TRUE(windows.is_empty({0, 0, 0}, {16, 16, 16}));
    }
  }
}

// A window costs the memory of a window.
TEST(Windows, OfGridsLargerThanMemory) {
  const Mesh mesh = at_grid(ball_mesh(1, 6));
  const double h = 2.5 / 30000;
  const Grid grid{{30000, 30000, 30000}, kFar - Vec3{1.25, 1.25, 1.25}, {h, h, h}};
  ComputeOptions options = by(SignMethod::winding);
  options.memory_limit = std::int64_t{200} << 20;
  WindowComputation windows(mesh, grid, 2 * h, {128, 128, 128}, options);
  DistanceField field;
  windows.compute({14976, 14976, 14976}, {128, 128, 128}, field);
  EXPECT_EQ(field.value(5, 5, 5), static_cast<float>(-2 * h));
  EXPECT_FALSE(windows.is_reached({14976, 14976, 14976}, {128, 128, 128}));
  EXPECT_EQ(field.stored_tiles(), 0);
  EXPECT_FALSE(windows.is_empty({14976, 14976, 14976}, {128, 128, 128})) << "it is inside";
  EXPECT_TRUE(windows.is_empty({64, 64, 64}, {128, 128, 128}));
  windows.compute({64, 64, 64}, {128, 128, 128}, field);
  EXPECT_EQ(field.value(5, 5, 5), static_cast<float>(2 * h));
  expect_error([&] { compute(mesh, grid, 2 * h, options); }, ErrorCode::limit, "may need");
}

}  // namespace
}  // namespace standoff::testing::of_windows
