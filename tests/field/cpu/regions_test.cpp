// SPDX-License-Identifier: Apache-2.0
// Regions leave out triangles in many blocks, and change no bit: against the same bins without them, and the descent.
#include "field/cpu/regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "field/cpu/tiles.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"
#include "tests/support/welded_ball.h"

namespace standoff::testing {
namespace {

using cpu::BandAlgorithm, cpu::kNoTilt, cpu::Regions;

// Bricks that are cut, and samples around the middle of the meshes.
const Grid kCubes{{45, 40, 52}, {-21.7, -20.1, -25.3}, {1, 1, 1}},
    kBricks{{45, 66, 30}, {-21.7, -20.1, -25.3}, {1, 0.6, 1.7}};

DistanceField gathered_by(cpu::BandChoice choice, const Mesh& mesh, const Grid& grid, double thickness, Simd simd,
                          std::span<const std::uint32_t> kept) {
  DistanceField field;
  field.reset(grid, thickness, true);
  Sink sink(field);
  ProgressMeter progress;
  cpu::run_tiles_by(std::move(choice), {mesh, kept, grid, thickness, 2, simd, progress}, sink);
  return field;
}

Regions regions_of(const Mesh& mesh, const Grid& grid, double thickness, std::span<const std::uint32_t> kept = {},
                   int threads = 2) {
  ProgressMeter progress;
  return cpu::find_regions({mesh, kept, grid, thickness, threads, Simd::automatic, progress},
                           make_lattice(grid, thickness));
}

// The share of triangles that have regions.
double bounded(const Regions& regions) {
  const auto count = std::ranges::count_if(regions, [](const cpu::Region& r) { return r.tilt < kNoTilt; });
  return regions.empty() ? 0 : static_cast<double>(count) / static_cast<double>(regions.size());
}

void expect_same(const Mesh& mesh, const Grid& grid, double thickness, Simd simd = Simd::automatic,
                 std::span<const std::uint32_t> kept = {}) {
  const Regions regions = regions_of(mesh, grid, thickness, kept);
  const DistanceField all = gathered_by({BandAlgorithm::bins, {}}, mesh, grid, thickness, simd, kept),
                      some = gathered_by({BandAlgorithm::bins, regions}, mesh, grid, thickness, simd, kept),
                      descent = gathered_by({BandAlgorithm::descent, {}}, mesh, grid, thickness, simd, kept);
  for (const DistanceField* other : {&some, &descent}) {
    std::int64_t values = 0, nearest = 0;
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      values += all.value(i, j, k) != other->value(i, j, k);
      nearest += all.nearest(i, j, k) != other->nearest(i, j, k);
    });
    EXPECT_EQ(values, 0) << "thickness " << thickness << (other == &some ? ", regions" : ", descent");
    EXPECT_EQ(nearest, 0) << "thickness " << thickness << (other == &some ? ", regions" : ", descent");
  }
}

void expect_same_everywhere(const std::string& name, const Mesh& mesh) {
  SCOPED_TRACE(name);
  for (const double thickness : {4.1, 7.0, 11.5, 16.0}) {
    expect_same(mesh, kCubes, thickness);
    expect_same(mesh, kBricks, thickness);
  }
}

Mesh turned(Mesh mesh, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec3& v : mesh.vertices) {
    v = {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    v = {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
  }
  return mesh;
}

// An open sheet of 2 n^2 triangles over [-1, 1]^2, at height(x, y).
template <class Height>
Mesh sheet(int n, double half, Height height) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = half * (2.0 * i / n - 1), y = half * (2.0 * j / n - 1);
      mesh.vertices.push_back({x, y, height(x, y)});
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(i + (n + 1) * j), b = a + 1, c = a + static_cast<std::uint32_t>(n) + 1,
                 d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

Mesh shaken(Mesh mesh, unsigned seed, double by) {
  Random random(seed);
  for (Vec3& v : mesh.vertices) v = v + random.in_cube(by);
  return mesh;
}

// A cone of rings, each a part of the one before, down to a tip of triangles that are `least` long.
Mesh spike(int sides, double slope, double part, double least) {
  Mesh mesh;
  int rings = 0;
  for (double r = 18; r > least; r *= part, ++rings)
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5 * (rings % 2)) / sides;
      mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), -slope * r});
    }
  const auto at = [&](int ring, int k) { return static_cast<std::uint32_t>(ring * sides + k % sides); };
  for (int ring = 0; ring + 1 < rings; ++ring)
    for (int k = 0; k < sides; ++k) {
      const int inner = ring % 2 == 0 ? k : k + 1;  // rings are turned by half a side
      mesh.triangles.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, inner)});
      mesh.triangles.push_back({at(ring, k + 1), at(ring + 1, inner + 1), at(ring + 1, inner)});
    }
  const auto tip = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({0, 0, 0});
  for (int k = 0; k < sides; ++k) mesh.triangles.push_back({at(rings - 1, k), at(rings - 1, k + 1), tip});
  return mesh;
}

Mesh with_copies(Mesh mesh, bool reversed_too) {
  const std::vector<Triangle> triangles = mesh.triangles;
  for (std::size_t n = 0; n < triangles.size(); n += 3) {
    const auto [a, b, c] = triangles[n];
    mesh.triangles.push_back(n % 2 == 0 || !reversed_too ? Triangle{b, c, a} : Triangle{b, a, c});
  }
  return mesh;
}

TEST(Regions, ClosedScansKeepAllBits) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Mesh mesh = turned(shaken(welded_ball(15, 9), seed, 0.15 * seed), seed);
    EXPECT_GT(bounded(regions_of(mesh, kCubes, 8)), seed < 3 ? 0.9 : 0.5);
    expect_same_everywhere("ball " + std::to_string(seed), mesh);
  }
  expect_same_everywhere("balls across each other",
                         joined(welded_ball(12, 7), turned(welded_ball(13, 8, {5, 1, -3}), 1)));
}

TEST(Regions, SheetsKeepAllBits) {
  for (const double bumps : {0.0, 1e-6, 1e-4, 1e-3, 0.03, 0.3, 1.0}) {
    const Mesh mesh = turned(shaken(sheet(14, 18, [](double, double) { return 0.0; }), 5, bumps), 0.7);
    if (bumps < 0.1) {
      EXPECT_GT(bounded(regions_of(mesh, kCubes, 8)), 0.7) << bumps;
    }
    expect_same_everywhere("bumps " + std::to_string(bumps), mesh);
  }
  const auto saddle = [](double x, double y) { return 0.03 * (x * x - y * y); };
  const auto valleys = [](double x, double) { return 2 * std::cos(x / 2); };
  expect_same_everywhere("saddle", turned(sheet(16, 17, saddle), 0.3));
  expect_same_everywhere("valleys", turned(sheet(18, 17, valleys), 0.4));
}

// Edges lie hardly beside planes of samples, which then are as far from the triangles of both sides but for rounding.
TEST(Regions, EdgesNextToSamplesKeepAllBits) {
  for (const double beside : {0.0, 1e-6, 1e-4, 1e-3, 1.3e-3, 1.6e-3, 2e-3, 3e-3, 4e-3, 6e-3, 0.01, 0.03}) {
    Mesh mesh = shaken(sheet(16, 16, [](double, double) { return 0.0; }), 6, 1e-5);
    for (Vec3& v : mesh.vertices) v = v + Vec3{kCubes.origin.x + 20 - beside, kCubes.origin.y + 20 + beside, 0.3};
    SCOPED_TRACE(beside);
    for (const double thickness : {5.0, 9.0, 14.0}) expect_same(mesh, kCubes, thickness);
  }
}

TEST(Regions, SpikesKeepAllBits) {
  for (const int sides : {5, 6, 8})
    for (const double slope : {0.1, 0.4, 1.0})
      for (const double least : {4.0, 0.02, 1e-4, 1e-6})
        expect_same_everywhere(
            std::to_string(sides) + " sides, slope " + std::to_string(slope) + ", least " + std::to_string(least),
            turned(spike(sides, slope, 0.5, least), 0.2 * sides));
}

TEST(Regions, WhatIsNotClosedKeepsAllBits) {
  expect_same_everywhere("soup", random_soup(7, 400, 20, 3));
  expect_same_everywhere("nasty soup", nasty_soup(8, 200, 9));
  const Mesh ball = turned(welded_ball(15, 8), 0.5);
  expect_same_everywhere("a hole", with_hole(ball, 100, 140));
  expect_same_everywhere("unwelded", unwelded(ball));
  Mesh fins = sheet(10, 17, [](double, double) { return 0.0; });
  const std::size_t flat = fins.triangles.size();
  for (std::size_t n = 0; n < flat; n += 7) {
    const Triangle t = fins.triangles[n];
    const auto apex = static_cast<std::uint32_t>(fins.vertices.size());
    fins.vertices.push_back(fins.vertices[t[0]] + Vec3{0.3, 0.4, n % 2 == 0 ? 3.0 : -0.2});
    fins.triangles.push_back({t[0], t[1], apex});
  }
  expect_same_everywhere("fins", turned(fins, 0.3));
  Mesh flipped = ball;
  for (std::size_t n = 0; n < flipped.triangles.size(); n += 29)
    std::swap(flipped.triangles[n][0], flipped.triangles[n][1]);
  expect_same_everywhere("turned around", flipped);
  expect_same_everywhere("copies", with_copies(ball, false));
  expect_same_everywhere("copies turned around", with_copies(ball, true));
}

TEST(Regions, UnevenTrianglesKeepAllBits) {
  const auto bumpy = [](double x, double y) { return 0.5 * std::sin(x) * std::cos(y); };
  for (const double stretch : {0.02, 0.1, 0.3}) {
    Mesh mesh = sheet(20, 18, bumpy);
    for (Vec3& v : mesh.vertices) v.x *= stretch;
    expect_same_everywhere("stretched " + std::to_string(stretch), turned(mesh, 0.8));
  }
  // Steps grow from 1e-4 to 9 spacings along both axes.
  const auto graded = [](double x) { return std::copysign(18 * std::pow(std::abs(x) / 18, 4), x); };
  Mesh mesh = sheet(30, 18, [](double, double) { return 0.0; });
  for (Vec3& v : mesh.vertices) {
    v = {graded(v.x), graded(v.y), 0};
    v.z = 3 * std::cos(0.2 * v.x) * std::cos(0.15 * v.y);
  }
  expect_same_everywhere("graded", turned(mesh, 0.2));
}

TEST(Regions, EveryInstructionSetAndKeptTriangles) {
  const Mesh mesh = turned(shaken(welded_ball(15, 9), 9, 0.3), 0.4);
  expect_same(mesh, kCubes, 9, Simd::portable);
  expect_same(mesh, kBricks, 6, Simd::avx2);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n)
    if (n % 50 > 3) kept.push_back(n);
  expect_same(mesh, kCubes, 9, Simd::automatic, kept);
  // Of few of a mesh's triangles, nothing is looked for.
  kept.resize(kept.size() / 2);
  EXPECT_TRUE(regions_of(mesh, kCubes, 9, kept).empty());
}

// Rounding decides whether a triangle farther than the thickness by less than that gives a sample a distance. So all
// algorithms must measure it; once those of bricks did not if its box ended there. Tips before the first samples of a
// brick, under a sheet whose triangles have regions.
TEST(Regions, TipsAtTheThicknessAreMeasuredByAllAlgorithms) {
  Random random(1);
  for (const double spacing : {1.0, 1.3, 1.99})
    for (const double thickness : {4.2, 7.3, 9.7, 15.9}) {
      const Grid grid{{48, 48, 32}, {0, 0, 0}, {spacing, spacing, spacing}};
      Mesh mesh = sheet(60, 22, [](double, double) { return 7.0; });
      for (Vec3& v : mesh.vertices) v = v + Vec3{24, 24, 24};
      for (double y = 4; y < 44; ++y)
        for (double x = 8; x < 40; ++x) {
          const Vec3 tip{x, y, 16 - thickness - random.between(2e-6, 1.2e-5)};
          const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
          mesh.vertices.push_back(tip);
          for (int end = 0; end < 2; ++end)
            mesh.vertices.push_back(tip + Vec3{random.between(-1, 1), random.between(-1, 1), -random.between(0.3, 2)});
          mesh.triangles.push_back({first, first + 1, first + 2});
        }
      ASSERT_FALSE(regions_of(mesh, grid, thickness).empty());
      for (Vec3& v : mesh.vertices) v = v * spacing;
      expect_same(mesh, grid, thickness * spacing);
    }
}

TEST(Regions, AreTheSameForAnyNumberOfThreads) {
  const Mesh mesh = turned(shaken(welded_ball(15, 9), 10, 0.4), 0.4);
  const Regions one = regions_of(mesh, kCubes, 9, {}, 1), five = regions_of(mesh, kCubes, 9, {}, 5);
  ASSERT_EQ(one.size(), five.size());
  for (std::size_t n = 0; n < one.size(); ++n) {
    ASSERT_EQ(one[n].tilt, five[n].tilt);
    for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(one[n].reach[axis], five[n].reach[axis]);
  }
}

}  // namespace
}  // namespace standoff::testing
