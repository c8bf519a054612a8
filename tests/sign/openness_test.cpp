// SPDX-License-Identifier: Apache-2.0
// The openness of meshes: against the sum of all other triangles' solid angles, and of shapes whose kind is known.
#include "sign/diagnosis/openness.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/threads.h"
#include "tests/sign/brute_winding.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;

double openness(const Mesh& mesh, std::span<const std::int8_t> use = {}) {
  const OrientedMesh oriented{mesh, use};
  return openness_of(oriented, net_boundary(oriented, MeshEdges(mesh)));
}

// As it is defined, at all centroids.
double brute_openness(const Mesh& mesh) {
  double sum = 0, areas = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = MeshView(mesh).corners(t);
    const double area = length(cross(b - a, c - a)) / 2;
    const double behind = brute_winding(without(mesh, t), a + ((b - a) + (c - a)) * (1.0 / 3)).value + 0.5;
    sum += area * 2 * std::abs(behind - std::round(behind));
    areas += area;
  }
  return sum / areas;
}

Mesh hemisphere(std::uint32_t n) {
  Mesh mesh = sphere(n);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return mesh.vertices[v].z < -1e-9; });
  });
  return mesh;
}

// A tube of radius 1; `turn`: how much of it there is.
Mesh tube(double length, double turn) {
  return surface(
      20, 12,
      [=](double u, double v) {
        return Vec3{std::cos(kTurn * turn * u), std::sin(kTurn * turn * u), length * v};
      },
      [=](std::uint32_t i, std::uint32_t j) {
        return Place{turn == 1 ? i % 20 : i, j};
      });
}

Mesh lidless() { return without(without(box(), 0), 0); }

TEST(Openness, IsThatOfTheWindingNumbers) {
  std::vector<Mesh> meshes = {lidless(),        hemisphere(10),
                              terrain(10, 0.3), with_flipped(sphere(6), 40),
                              moebius(),        with_holes(sphere(8), 0.4, 1),
                              sphere(6),        moved(lidless(), {1e6, 2e6, 0}),
                              tube(1, 1),       with_copy(box(), 3, false),
                              without(box(), 4)};
  for (unsigned seed = 0; seed < 6; ++seed) meshes.push_back(random_soup(seed, 80, 1, 0.2 + 0.3 * seed));
  for (const Mesh& mesh : meshes) {
    ASSERT_LE(mesh.triangles.size(), kMostPoints);
    EXPECT_NEAR(openness(mesh), brute_openness(mesh), 1e-5);
  }
}

TEST(Openness, OfSomePointsIsAboutThatOfAll) {
  for (const Mesh& mesh :
       {hemisphere(24), with_holes(sphere(20), 0.3, 1), cut_off(sphere(20), 0.2), terrain(20, 0.3)}) {
    ASSERT_GT(mesh.triangles.size(), kMostPoints);
    EXPECT_NEAR(openness(mesh), brute_openness(mesh), 0.02);
    EXPECT_NEAR(openness(shuffled(mesh, 1)), openness(mesh), 0.03);
  }
}

// Two large triangles of openness 1, and a ball of very many small ones.
TEST(Openness, CountsTrianglesByTheirArea) {
  const Mesh square = terrain(1, 0), ball = moved(sphere(20), {8, 0, 0}, 0.3);
  const auto area = [](const Mesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [a, b, c] = MeshView(mesh).corners(t);
      sum += length(cross(b - a, c - a)) / 2;
    }
    return sum;
  };
  const double expected = area(square) / (area(square) + area(ball));
  EXPECT_NEAR(openness(joined(square, ball)), expected, 0.02);
  EXPECT_NEAR(openness(joined(ball, square)), expected, 0.02);
}

TEST(Openness, OfBodiesIsNothing) {
  EXPECT_EQ(openness(sphere()), 0);
  // Inside one another, overlapping, with cavities, inside out: whatever the winding numbers are, they are integers.
  const Mesh many = joined(joined(box({-2, -2, -2}, {2, 2, 2}), reversed(sphere(7))),
                           joined(moved(sphere(5), {0.1, 0.2, 0.3}, 0.4), box({1, 1, 1}, {3, 3.1, 3.2})));
  for (const Mesh& mesh : {many, reversed(many)}) {
    EXPECT_LT(openness(cracked(mesh, 1e-9, 1)), 1e-6);
    EXPECT_LT(openness(cracked_floats(mesh, 2)), 1e-4);
  }
  EXPECT_LT(openness(box_of_t_junctions({0, 0, 0}, {2, 1, 1}, 2)), 1e-6);
}

// Cracks do not make a sheet a body, nor what is missing of a body less.
TEST(Openness, SeesThroughCracks) {
  for (const Mesh& mesh : {lidless(), hemisphere(10), terrain(10, 0.3), tube(2, 1), tube(2, 0.5), sphere(6)})
    EXPECT_NEAR(openness(cracked(mesh, 1e-9, 1)), openness(mesh), 1e-6);
}

TEST(Openness, TellsBodiesFromSheets) {
  EXPECT_NEAR(openness(lidless()), 0.2, 0.01);
  EXPECT_LT(openness(cut_off(sphere(16), 0.33)), 0.3);
  EXPECT_LT(openness(tube(6, 1)), 0.2);
  EXPECT_GT(openness(hemisphere(16)), 0.35);
  EXPECT_GT(openness(tube(1, 1)), 0.5);
  EXPECT_GT(openness(tube(30, 0.5)), 0.5);
  EXPECT_GT(openness(terrain(12, 0.1)), 0.9);
  EXPECT_NEAR(openness(terrain(4, 0)), 1, 1e-6);
  EXPECT_GT(openness(random_soup(4, 100, 1, 0.1)), 0.9);
}

TEST(Openness, IsThatOfTheTrianglesInUse) {
  const Mesh mesh = joined(sphere(6), terrain(4));
  std::vector<std::int8_t> use(mesh.triangles.size(), 1);
  EXPECT_GT(openness(mesh, use), 0.1);
  std::fill(use.begin() + 120, use.end(), 0);
  EXPECT_EQ(openness(mesh, use), 0);
  use[60] = 0;
  const double hole = openness(mesh, use);
  EXPECT_NEAR(hole, openness(without(sphere(6), 60)), 1e-3);  // the bounds, and so the apex, are others
  use.assign(mesh.triangles.size(), 0);
  EXPECT_EQ(openness(mesh, use), 0);
}

TEST(Openness, DoesNotDependOnThreads) {
  const Mesh mesh = cracked(hemisphere(16), 1e-3, 1);
  const double expected = openness(mesh);
  for (const int threads : {1, 3}) Threads(threads).run([&] { EXPECT_EQ(openness(mesh), expected); });
}

}  // namespace
}  // namespace standoff
