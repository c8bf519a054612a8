// SPDX-License-Identifier: Apache-2.0
// Hermite data: crossings of grid edges against integers that tell them exactly, on samples that lie on corners, edges
// and faces; places and normals against closed forms; signs, threads, limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "scenes/scenes.h"
#include "standoff/crossings.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/expect_error.h"

namespace standoff {
namespace {

using testing::Random;
using Sample = std::array<std::int64_t, 3>;
using Edge = std::tuple<Sample, int>;

Vec3 at(const Grid& grid, const Sample& s) { return grid.position(s[0], s[1], s[2]); }

Sample next(Sample sample, int axis) {
  ++sample[static_cast<std::size_t>(axis)];
  return sample;
}

template <class Use>
void for_each_edge(const Grid& grid, const Use& use) {
  const Sample size{grid.size.x, grid.size.y, grid.size.z};
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const Sample sample{i, j, k};
          if (sample[static_cast<std::size_t>(axis)] + 1 < size[static_cast<std::size_t>(axis)]) use(sample, axis);
        }
}

// Whether the segment passes through the triangle, away from its edges, and neither end is in its plane: as integers
// tell. nullopt: it is not that simple.
std::optional<bool> crosses(const std::array<Vec3, 3>& t, const Vec3& p, const Vec3& q) {
  using testing::orientation;
  const int below = orientation(t[0], t[1], t[2], p), above = orientation(t[0], t[1], t[2], q);
  if (below != 0 && below == above) return false;
  int left = 0, right = 0, on = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const int side = orientation(p, q, t[n], t[(n + 1) % 3]);
    left += side > 0, right += side < 0, on += side == 0;
  }
  if (left > 0 && right > 0) return false;
  if (on > 0 || below == 0 || above == 0) return std::nullopt;
  return true;
}

TEST(EdgeCrossings, OfSimpleEdgesAsIntegersTell) {
  const Grid grid{{13, 14, 12}, {-6, -7, -5}};
  std::int64_t simple = 0, crossed = 0, other = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    Random random(seed);
    const Mesh mesh = testing::mesh_of(testing::integer_tetrahedra(random, 4, 5));
    std::map<std::tuple<Sample, int, std::uint32_t>, EdgeCrossing> found;
    for (const EdgeCrossing& c : edge_crossings(mesh, grid, {.sign = {SignMethod::none}}))
      found[{c.sample, c.axis, c.triangle}] = c;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::array<Vec3, 3> corners = MeshView(mesh).corners(t);
      for_each_edge(grid, [&](const Sample& sample, int axis) {
        const Vec3 p = at(grid, sample), q = at(grid, next(sample, axis));
        const auto known = crosses(corners, p, q);
        const auto one = found.find({sample, axis, t});
        if (!known) return void(++other);
        ++simple;
        ASSERT_EQ(*known, one != found.end()) << seed << ' ' << t;
        if (!*known) return;
        ++crossed;
        const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);  // of integers: exact
        const double before = dot(corners[0] - p, normal), step = dot(q - p, normal);
        EXPECT_NEAR(one->second.place, before / step, 1e-14);
        EXPECT_EQ(one->second.enters, step < 0);
        EXPECT_LE(length(one->second.normal - normal * (1 / length(normal))), 1e-14);
        EXPECT_LE(length(one->second.position(grid) - (p + (q - p) * (before / step))), 1e-13);
      });
    }
  }
  EXPECT_GT(simple, 100000);
  EXPECT_GT(crossed, 1000);
  EXPECT_GT(other, 1000);
}

// Also where edges go through corners, along edges and in the planes of faces: the steps of an edge add up to the
// difference of its ends' winding numbers.
TEST(EdgeCrossings, AddUpToWindingNumbers) {
  const Grid grid{{15, 16, 14}, {-7, -7, -7}};
  std::int64_t steps = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const auto solids = testing::integer_tetrahedra(random, 3, 5);
    std::map<Edge, int> step;
    for (const EdgeCrossing& c : edge_crossings(testing::mesh_of(solids), grid, {.sign = {SignMethod::none}}))
      step[{c.sample, c.axis}] += c.enters ? 1 : -1;
    for_each_edge(grid, [&](const Sample& sample, int axis) {
      const auto here = testing::known_winding(solids, at(grid, sample)),
                 there = testing::known_winding(solids, at(grid, next(sample, axis)));
      if (here.on_surface || there.on_surface) return;
      const auto found = step.find({sample, axis});
      steps += here.winding != there.winding;
      EXPECT_EQ(found == step.end() ? 0 : found->second, there.winding - here.winding) << seed;
    });
  }
  EXPECT_GT(steps, 1000);
}

// A crossing says the same wherever the mesh is, and at any scale.
TEST(EdgeCrossings, FarAwayAndStretched) {
  Random random(5);
  const Mesh mesh = testing::mesh_of(testing::integer_tetrahedra(random, 6, 5));
  const Grid grid{{23, 11, 45}, {-5.5, -5, -5.5}, {0.5, 1, 0.25}};
  const auto near = edge_crossings(mesh, grid, {.sign = {SignMethod::none}});
  EXPECT_GT(near.size(), 1000);
  for (const double scale : {1.0, 0x1p-200, 0x1p200}) {
    const Vec3 shift = scale == 1 ? Vec3{0x1p40, -0x1p41, 0x1p39} : Vec3{};
    Mesh moved = mesh;
    for (Vec3& v : moved.vertices) v = v * scale + shift;
    const Grid to{grid.size, grid.origin * scale + shift, grid.spacing * scale};
    const auto far = edge_crossings(moved, to, {.sign = {SignMethod::none}});
    ASSERT_EQ(far.size(), near.size());
    for (std::size_t n = 0; n < near.size(); ++n) {
      EXPECT_EQ(far[n].sample, near[n].sample);
      EXPECT_EQ(far[n].triangle, near[n].triangle);
      EXPECT_EQ(far[n].axis, near[n].axis);
      EXPECT_EQ(far[n].enters, near[n].enters);
      EXPECT_NEAR(far[n].place, near[n].place, 1e-14);
      EXPECT_LE(length(far[n].normal - near[n].normal), 1e-14);
    }
  }
}

// The box, seen by a grid whose samples lie on its corners, edges and faces.
TEST(EdgeCrossings, SamplesOnTheSurface) {
  const Mesh box = testing::box({0, 0, 0}, {4, 4, 4});
  const Grid grid{{7, 7, 7}, {-1, -1, -1}};
  // Samples count as if they were moved by less than anything towards larger coordinates: those from 0 to 3 are inside.
  std::map<Edge, int> count;
  for (const EdgeCrossing& c : edge_crossings(box, grid, {.sign = {SignMethod::none}})) {
    EXPECT_TRUE(c.place == 0 || c.place == 1);
    EXPECT_EQ(c.enters, c.sample[c.axis] == 0);
    const double along = c.axis == 0 ? c.normal.x : c.axis == 1 ? c.normal.y : c.normal.z;
    EXPECT_EQ(along, c.enters ? -1 : 1);
    ++count[{c.sample, c.axis}];
  }
  EXPECT_EQ(count.size(), 3 * 2 * 16u);
  for (const auto& [edge, times] : count) EXPECT_EQ(times, 1);
}

TEST(EdgeCrossings, NeedlesAndTrianglesWithoutArea) {
  // A needle that is 1e-14 wide has a normal all the same: (0, -1, 1) / sqrt(2), as its corners are exact.
  const double thin = 0x1p-46;
  const Mesh mesh{{{0, 0, 0}, {8, 0, 0}, {4, thin, thin}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}},
                  {{0, 1, 2}, {3, 4, 5}, {3, 3, 3}, {0, 1, 0}}};
  const Grid grid{{9, 2, 2}, {0.5, thin / 4, -0.5}};
  const auto found = edge_crossings(mesh, grid, {.sign = {SignMethod::none}});
  ASSERT_GT(found.size(), 2u);
  for (const EdgeCrossing& c : found) {
    EXPECT_EQ(c.triangle, 0u);
    EXPECT_EQ(c.axis, 2);
    EXPECT_LE(length(c.normal - Vec3{0, -1, 1} * std::sqrt(0.5)), 1e-14);
    EXPECT_FALSE(c.enters);
    EXPECT_NEAR(c.place, 0.5, 1e-12);
  }
}

TEST(EdgeCrossings, GridsOfOneSampleHaveNoEdges) {
  const Mesh box = testing::box({0, 0, 0}, {4, 4, 4});
  EXPECT_TRUE(edge_crossings(box, {{1, 1, 1}, {0, 0, 0}}, {.sign = {SignMethod::none}}).empty());
  EXPECT_TRUE(edge_crossings(box, {{5, 5, 5}, {100, 100, 100}}, {.sign = {SignMethod::none}}).empty());
  const auto column = edge_crossings(box, {{1, 1, 9}, {1.5, 1.25, -2}}, {.sign = {SignMethod::none}});
  ASSERT_EQ(column.size(), 2u);
  EXPECT_EQ(column[0].sample, (Sample{0, 0, 1}));
  EXPECT_TRUE(column[0].enters);
  EXPECT_EQ(column[1].sample, (Sample{0, 0, 5}));
  EXPECT_EQ(column[1].place, 1);
}

TEST(EdgeCrossings, InTheOrientationOfTheSign) {
  Mesh box = testing::reversed(testing::box({0, 0, 0}, {4, 4, 4}));
  box.triangles.push_back(box.triangles.front());  // a copy, which the sign leaves out
  const Grid grid{{7, 7, 7}, {-1.5, -1.25, -1.125}};
  const auto outwards = [&](const EdgeCrossingOptions& options) {
    std::int64_t out = 0, in = 0;
    for (const EdgeCrossing& c : edge_crossings(box, grid, options))
      ++(dot(c.normal, c.position(grid) - Vec3{2, 2, 2}) > 0 ? out : in);
    return std::pair(out, in);
  };
  const auto [none, inwards] = outwards({.sign = {SignMethod::none}});
  EXPECT_EQ(none, 0);
  const auto [out, in] = outwards({});
  EXPECT_EQ(in, 0);
  EXPECT_EQ(out, 3 * 2 * 16);
  EXPECT_LT(out, inwards);  // of the copy
  EXPECT_EQ(outwards({.sign = {.method = SignMethod::automatic, .invert = true}}), std::pair(in, out));
}

// `outer` leaves out what is inside of another.
TEST(EdgeCrossings, OfTheOuterSurface) {
  const Mesh mesh = testing::joined(testing::box({0, 0, 0}, {8, 8, 8}), testing::box({2, 2, 2}, {4, 4, 4}));
  const Grid grid{{11, 11, 11}, {-1.5, -1.25, -1.125}};
  const auto all = edge_crossings(mesh, grid, {.sign = {.method = SignMethod::winding}});
  const auto outer = edge_crossings(mesh, grid, {.sign = {.method = SignMethod::winding, .outer = true}});
  EXPECT_EQ(outer.size(), 3 * 2 * 64u);
  EXPECT_EQ(all.size(), outer.size() + 3 * 2 * 4u);
}

TEST(EdgeCrossings, SortedAndTheSameForAnyThreads) {
  const Mesh mesh = scenes::make("sphere", 3000);
  const Grid grid = fit_resolution(bounds(mesh), 60);
  const auto one = edge_crossings(mesh, grid, {.sign = {SignMethod::none}, .execution = {.threads = 1}});
  EXPECT_GT(one.size(), 10000u);
  const auto key = [](const EdgeCrossing& c) {
    return std::tuple(c.sample[2], c.sample[1], c.sample[0], c.axis, c.place, c.triangle);
  };
  EXPECT_TRUE(std::ranges::is_sorted(one, {}, key));
  const auto many = edge_crossings(mesh, grid, {.sign = {SignMethod::none}, .execution = {.threads = 5}});
  ASSERT_EQ(one.size(), many.size());
  for (std::size_t n = 0; n < one.size(); ++n) {
    EXPECT_EQ(key(one[n]), key(many[n]));
    EXPECT_EQ(one[n].normal, many[n].normal);
    EXPECT_EQ(one[n].enters, many[n].enters);
  }
}

TEST(EdgeCrossings, Errors) {
  const Mesh box = testing::box({0, 0, 0}, {4, 4, 4});
  const Grid grid{{70, 70, 70}, {-1, -1, -1}, {0.09, 0.09, 0.09}};
  const Mesh open{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const auto fails = [&](ErrorCode code, const std::string& words, const EdgeCrossingOptions& options,
                         const Mesh& mesh) { expect_error([&] { edge_crossings(mesh, grid, options); }, code, words); };
  fails(ErrorCode::limit, "memory limit", {.memory_limit = 100000}, box);
  fails(ErrorCode::usage, "shell", {.sign = {.method = SignMethod::shell, .shell = 1}}, box);
  fails(ErrorCode::limit, "scale them down", {}, testing::box({0, 0, 0}, {1e101, 1, 1}));
  fails(ErrorCode::input, "not closed", {.sign = {.method = SignMethod::parity}}, open);
  fails(ErrorCode::interrupted, "cancelled", {.progress = [](const Progress&) { return false; }}, box);
}

}  // namespace
}  // namespace standoff
