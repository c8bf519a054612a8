// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// Sides of open meshes against the sum of all solid angles, at every sample of small grids.
#include "sign/open_winding/open_winding.h"

#include <gtest/gtest.h>

#include "sign/rows/row_crossings.h"
#include "tests/sign/brute_winding.h"
#include "tests/sign/shapes.h"
#include "tests/sign/sides_of.h"

namespace standoff {
namespace {

using testing::sides_of;

using namespace testing;

constexpr WindingRule kRules[] = {WindingRule::positive, WindingRule::nonzero, WindingRule::odd};

// The definition, for values that are not at a threshold.
bool is_inside_by_definition(double winding, WindingRule rule) {
  if (rule == WindingRule::positive) return winding > 0.5;
  if (rule == WindingRule::nonzero) return winding > 0.5 || winding < -0.5;
  return std::lround(std::abs(winding)) % 2 == 1;
}

double distance_to_threshold(double winding, WindingRule rule) {
  if (rule == WindingRule::positive) return std::abs(winding - 0.5);
  if (rule == WindingRule::nonzero) return std::abs(std::abs(winding) - 0.5);
  return std::abs(std::remainder(winding - 0.5, 1.0));
}

struct Outcome {
  std::int64_t inside = 0, outside = 0, on_surface = 0, near_half = 0, wrong = 0, off = 0;
};

// Compares each sample, or one in `step`, with the definition. `tolerance` is that of the values: theirs and ours.
Outcome compare(const Mesh& mesh, const Grid& grid, std::int64_t step = 1, double tolerance = 1e-9) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  const auto caps = std::make_shared<const Caps>(net_boundary({mesh}, MeshEdges(mesh)), progress);
  std::vector<BruteWinding> brute;
  const auto position = [&](std::int64_t n) {
    return std::array{n % grid.size.x, n / grid.size.x % grid.size.y, n / grid.size.x / grid.size.y};
  };
  for (std::int64_t n = 0; n < grid.sample_count(); n += step) {
    const auto [i, j, k] = position(n);
    brute.push_back(brute_winding(mesh, grid.position(i, j, k)));
  }
  Outcome outcome;
  for (const WindingRule rule : kRules) {
    OpenWinding winding({mesh}, caps, grid, rule, progress);
    const std::vector<bool> inside = sides_of(winding, grid);
    std::int64_t surely_doubtful = 0, perhaps_doubtful = 0;
    for (std::int64_t n = 0; n < grid.sample_count(); n += step) {
      const auto [value, on_surface] = brute[static_cast<std::size_t>(n / step)];
      const double distance = distance_to_threshold(value, rule);
      surely_doubtful += !on_surface && distance < 0.024;
      perhaps_doubtful += on_surface || distance < 0.076;
      if (on_surface) {
        ++outcome.on_surface;
        continue;
      }
      if (rule == WindingRule::positive) {
        const auto [i, j, k] = position(n);
        outcome.off += std::abs(winding.winding_number(i, j, k) - value) > tolerance;
      }
      if (distance < tolerance) {
        ++outcome.near_half;
        continue;
      }
      const bool is_inside = inside[static_cast<std::size_t>(n)];
      ++(is_inside ? outcome.inside : outcome.outside);
      outcome.wrong += is_inside != is_inside_by_definition(value, rule);
    }
    if (step == 1) {
      EXPECT_GE(winding.doubtful(), surely_doubtful);
      EXPECT_LE(winding.doubtful(), perhaps_doubtful);
    }
  }
  return outcome;
}

void expect_right(const Mesh& mesh, const Grid& grid, std::int64_t step = 1, double tolerance = 1e-9) {
  const Outcome outcome = compare(mesh, grid, step, tolerance);
  EXPECT_EQ(outcome.wrong, 0);
  EXPECT_EQ(outcome.off, 0);
  EXPECT_GT(outcome.inside + outcome.outside, outcome.on_surface);
}

Mesh without_random_triangles(Mesh mesh, double share, unsigned seed) {
  Random random(seed);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random.between(0, 1) < share; });
  return mesh;
}

template <class IsOff>
Mesh without(Mesh mesh, const IsOff& is_off) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return is_off((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) * (1 / 3.0));
  });
  return mesh;
}

Grid grid_of(const Mesh& mesh, std::int64_t samples) { return fit_resolution(bounds(mesh), samples); }

TEST(OpenWinding, TrianglesRemovedAtRandom) {
  for (const double share : {0.01, 0.1, 0.5}) {
    const Mesh mesh = without_random_triangles(sphere(8), share, 5);
    SCOPED_TRACE(share);
    expect_right(mesh, grid_of(mesh, 30), 3);
  }
}

TEST(OpenWinding, OneLargeHole) {
  // Its boundary has enough edges to be cut up twice, and the field is smooth in many tiles that the cap passes
  // through.
  Mesh tall = surface(
      450, 2,
      [](double u, double v) {
        return Vec3{std::cos(kTurn * u) + 0.2 * std::cos(3 * kTurn * u), std::sin(kTurn * u), 1.5 * v - 0.6};
      },
      [](std::uint32_t i, std::uint32_t j) {
        return Place{i % 450, j};
      });
  expect_right(tall, grid_of(tall, 48), 97);
  const Mesh cut = without(sphere(9), [](Vec3 v) { return v.x + 0.3 * v.z > 0.35; });
  expect_right(cut, grid_of(cut, 41), 7);
}

TEST(OpenWinding, CapsEdgesAndCornersOnSamples) {
  // An open box and a hemisphere on the samples' lattice: samples are on the planes of caps, on chords and apexes.
  const Mesh lidless = without(box({0, 0, 0}, {8, 8, 8}), [](Vec3 v) { return v.z == 8; });
  expect_right(lidless, {{13, 13, 13}, {-2, -2, -2}});
  expect_right(lidless, {{25, 25, 25}, {-2, -2, -2}, {0.5, 0.5, 0.5}}, 3);
  const Mesh sides = without(lidless, [](Vec3 v) { return v.x == 0; });
  expect_right(sides, {{13, 13, 13}, {-2, -2, -2}});
  Mesh rough = sphere(12);
  for (Vec3& v : rough.vertices) v = {std::round(6 * v.x), std::round(6 * v.y), std::round(6 * v.z)};
  const Mesh bowl = without(rough, [](Vec3 v) { return v.z > 0; });
  expect_right(bowl, {{17, 17, 17}, {-8, -8, -8}});
}

TEST(OpenWinding, SingleTriangleAndSoup) {
  Mesh one;
  add_triangle(one, {0, 0, 0}, {1, 0.2, 0}, {0.1, 1, 0.3});
  expect_right(one, {{12, 12, 12}, {-0.3, -0.3, -0.3}, {0.15, 0.15, 0.15}});
  for (unsigned seed = 0; seed < 3; ++seed) {
    expect_right(random_soup(seed, 40, 1, 1), {{15, 14, 13}, {-1.5, -1.4, -1.3}, {0.2, 0.2, 0.2}}, 2);
    expect_right(nasty_soup(seed, 40, 4), {{11, 11, 11}, {-5.3, -5.1, -5.2}});
  }
}

TEST(OpenWinding, BoundariesWithWeights) {
  Mesh mesh = sphere(8);
  // Flipped: an excess of two at three edges. Twice: a hole in the other direction. Three sheets meet at an edge.
  std::swap(mesh.triangles[40][0], mesh.triangles[40][1]);
  for (int copy = 0; copy < 3; ++copy) mesh.triangles.push_back(mesh.triangles[90]);
  add_triangle(mesh, mesh.vertices[mesh.triangles[60][0]], mesh.vertices[mesh.triangles[60][1]], {2, 0, 1});
  const Boundary boundary = net_boundary({mesh}, MeshEdges(mesh));
  EXPECT_TRUE(std::ranges::any_of(boundary.edges, [](const BoundaryEdge& edge) { return edge.weight == 2; }));
  EXPECT_TRUE(std::ranges::any_of(boundary.edges, [](const BoundaryEdge& edge) { return edge.weight == 3; }));
  expect_right(mesh, grid_of(mesh, 25), 3);
  std::ranges::for_each(mesh.triangles, [](Triangle& t) { std::swap(t[0], t[1]); });
  expect_right(mesh, grid_of(mesh, 25), 5);  // inside out
}

TEST(OpenWinding, CracksAddNothing) {
  // Vertices moved by some ulps in half of the triangles.
  Mesh soup;
  Random random(3);
  const Mesh whole = sphere(7);
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    auto [a, b, c] = MeshView(whole).corners(t);
    for (Vec3* v : {&a, &b, &c})
      if (random.below(2) == 0) *v = *v + random.in_cube(1e-13);
    add_triangle(soup, a, b, c);
  }
  expect_right(soup, grid_of(soup, 30), 11);
}

TEST(OpenWinding, FarFromTheOriginAndAnisotropic) {
  Mesh mesh = without_random_triangles(sphere(8), 0.05, 9);
  mesh = without(mesh, [](Vec3 v) { return v.y > 0.7; });
  const Grid squeezed{{40, 11, 21}, {-1.2, -1.1, -1.3}, {0.06, 0.21, 0.13}};
  expect_right(mesh, squeezed, 3);
  const Vec3 far{1e6, -3e6, 2e6};
  for (Vec3& v : mesh.vertices) v = v + far;
  expect_right(mesh, {squeezed.size, squeezed.origin + far, squeezed.spacing}, 3, 1e-8);
}

TEST(OpenWinding, GridsBesideAndInsideTheMesh) {
  const Mesh mesh = without(sphere(8), [](Vec3 v) { return v.z > 0.6; });
  expect_right(mesh, {{20, 20, 20}, {0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}}, 3);   // partly
  expect_right(mesh, {{9, 10, 11}, {-0.2, -0.3, 0.3}, {0.05, 0.05, 0.06}});  // across the hole
  expect_right(mesh, {{9, 9, 9}, {1.5, -0.5, -0.5}, {0.1, 0.1, 0.1}});       // beside
  expect_right(mesh, {{1, 40, 1}, {0.05, -1.3, 0.02}, {0.1, 0.0651, 0.1}});  // a single row of samples
}

TEST(OpenWinding, ClosedMeshesAreThoseOfIntegerWinding) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  const Mesh mesh = joined(sphere(8), torus());
  const Grid grid = grid_of(mesh, 40);
  const auto caps = std::make_shared<const Caps>(Boundary{}, progress);
  for (const WindingRule rule : kRules) {
    OpenWinding open({mesh}, caps, grid, rule, progress);
    IntegerWinding closed({mesh}, grid, rule, progress);
    EXPECT_EQ(sides_of(open, grid), sides_of(closed, grid));
    EXPECT_EQ(open.doubtful(), 0);
  }
}

}  // namespace
}  // namespace standoff
