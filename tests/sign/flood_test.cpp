// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// The flood: on closed solids it agrees with the winding number; of soups, walls within walls, gaps and meshes that
// leave the grid the answer is known; and on anything it is what a flood from sample to sample finds.
#include "sign/flood/flood.h"

#include <gtest/gtest.h>

#include <queue>

#include "scenes/scenes.h"
#include "sign/flood/grid_edges.h"
#include "sign/rows/row_crossings.h"
#include "tests/sign/cases/solids.h"
#include "tests/sign/sides_of.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/fields.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using testing::sides_of;

using testing::Random;

struct Flooded {
  std::vector<bool> inside;
  std::int64_t count;
  bool leaks;
};

Flooded flood(const Mesh& mesh, const Grid& grid) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  Flood flood(mesh, grid, progress);
  Flooded result{sides_of(flood, grid), flood.inside_samples(), flood.leaks()};
  EXPECT_EQ(std::ranges::count(result.inside, true), result.count);
  return result;
}

std::vector<bool> winding(const Mesh& mesh, const Grid& grid) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  IntegerWinding sides({mesh}, grid, WindingRule::nonzero, progress);
  return sides_of(sides, grid);
}

// A flood from sample to sample over the lattice.
std::vector<bool> flood_by_samples(const Mesh& mesh, const Grid& grid) {
  const TileLattice lattice = TileLattice::around(grid, bounds(mesh));
  const ProgressCallback none;
  ProgressMeter progress(none);
  const GridEdges edges(mesh, lattice, progress);
  const std::array<std::int64_t, 3> size{lattice.axes[0].size(), lattice.axes[1].size(), lattice.axes[2].size()};
  using Sample = std::array<std::int64_t, 3>;
  const auto index = [&](const Sample& s) {
    return static_cast<std::size_t>(s[0] + size[0] * (s[1] + size[1] * s[2]));
  };
  const auto is_crossed = [&](const Sample& s, std::size_t axis) {
    const TileEdges& tile = edges.of_tile(lattice.index(s[0] / 8, s[1] / 8, s[2] / 8));
    return (tile.crossed[axis][static_cast<std::size_t>(s[2] % 8)] >> (s[0] % 8 + 8 * (s[1] % 8)) & 1) != 0;
  };
  std::vector<bool> reached(static_cast<std::size_t>(size[0] * size[1] * size[2]));
  std::queue<Sample> next;
  const auto enter = [&](const Sample& s) {
    if (reached[index(s)]) return;
    reached[index(s)] = true;
    next.push(s);
  };
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x)
        if (x == 0 || y == 0 || z == 0 || x + 1 == size[0] || y + 1 == size[1] || z + 1 == size[2]) enter({x, y, z});
  while (!next.empty()) {
    const Sample at = next.front();
    next.pop();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Sample up = at, down = at;
      if (++up[axis] < size[axis] && !is_crossed(at, axis)) enter(up);
      if (--down[axis] >= 0 && !is_crossed(down, axis)) enter(down);
    }
  }
  std::vector<bool> inside;
  testing::for_each_sample(grid, [&](auto i, auto j, auto k) {
    inside.push_back(!reached[index({i + 8 * lattice.origin.x, j + 8 * lattice.origin.y, k + 8 * lattice.origin.z})]);
  });
  return inside;
}

// Each side of a box is two triangles of corners of their own.
void add_box(Mesh& mesh, const Box& box) { testing::append(mesh, testing::unwelded(testing::box(box.min, box.max))); }

// Samples within the box.
std::vector<bool> within(const Box& box, const Grid& grid) {
  std::vector<bool> inside;
  testing::for_each_sample(grid, [&](auto i, auto j, auto k) {
    const Vec3 p = grid.position(i, j, k);
    inside.push_back(p.x > box.min.x && p.y > box.min.y && p.z > box.min.z && p.x < box.max.x && p.y < box.max.y &&
                     p.z < box.max.z);
  });
  return inside;
}

const Box kBox{{-1.03, -0.87, -1.11}, {1.01, 0.93, 0.98}};
const Grid kGrid{{33, 30, 31}, {-1.6, -1.5, -1.5}, {0.1, 0.1, 0.1}};

TEST(Flood, AgreesWithTheWindingNumberOfSolids) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const Mesh mesh = testing::mesh_of(testing::integer_tetrahedra(random, 1, 9));
    const Grid grid{{22, 21, 23}, {-10, -10, -10}};
    EXPECT_EQ(flood(mesh, grid).inside, winding(mesh, grid)) << seed;
  }
  const Mesh sphere = scenes::make("sphere", 2000);
  const Grid grid = fit_resolution(bounds(sphere), 60);
  const Flooded flooded = flood(sphere, grid);
  EXPECT_EQ(flooded.inside, winding(sphere, grid));
  EXPECT_GT(flooded.count, 5000);
}

TEST(Flood, OrientationAndInnerWallsDoNotMatter) {
  Mesh mesh;
  add_box(mesh, kBox);
  Random random(5);
  for (Triangle& t : mesh.triangles)
    if (random.below(2) == 0) std::swap(t[0], t[1]);
  EXPECT_EQ(flood(mesh, kGrid).inside, within(kBox, kGrid));
  testing::add_triangle(mesh, {-1.03, -0.87, 0}, {1.01, -0.87, 0}, {0, 0.93, 0.2});  // a wall inside
  add_box(mesh, {{-0.5, -0.5, -0.5}, {0.4, 0.4, 0.4}});                              // and a body
  add_box(mesh, kBox);                                                               // every face twice
  const Flooded flooded = flood(mesh, kGrid);
  EXPECT_EQ(flooded.inside, within(kBox, kGrid));
  EXPECT_FALSE(flooded.leaks);
}

// A slot in one side. The flood comes through where an edge of the grid does that keeps half a spacing from both sides.
TEST(Flood, LeaksThroughGapsWiderThanASpacing) {
  const auto with_slot = [](double from, double to) {
    Mesh mesh;
    add_box(mesh, kBox);
    mesh.triangles.resize(mesh.triangles.size() - 2);  // the side at max.x, made anew of two parts
    const double x = kBox.max.x;
    const auto rectangle = [&](double y0, double y1) {
      const double z0 = kBox.min.z, z1 = kBox.max.z;
      testing::add_triangle(mesh, {x, y0, z0}, {x, y1, z0}, {x, y1, z1});
      testing::add_triangle(mesh, {x, y0, z0}, {x, y1, z1}, {x, y0, z1});
    };
    rectangle(kBox.min.y, from);
    rectangle(to, kBox.max.y);
    return mesh;
  };
  // Samples have y = 0 and 0.1.
  for (const double past : {0.09, 0.12, 0.14})
    EXPECT_EQ(flood(with_slot(0.01, past), kGrid).inside, within(kBox, kGrid));
  const Flooded leaking = flood(with_slot(0.01, 0.16), kGrid);
  EXPECT_TRUE(leaking.leaks);
  EXPECT_EQ(leaking.count, 0);
  Mesh mesh = with_slot(0.01, 0.16);
  add_box(mesh, {{-0.55, -0.55, -0.55}, {-0.25, -0.25, -0.25}});
  const Flooded some = flood(mesh, kGrid);  // what else is closed stays inside
  EXPECT_FALSE(some.leaks);
  EXPECT_EQ(some.inside, within({{-0.55, -0.55, -0.55}, {-0.25, -0.25, -0.25}}, kGrid));
}

TEST(Flood, MeshesThatReachOrLeaveTheBorderOfTheGrid) {
  Mesh mesh;
  add_box(mesh, kBox);
  const Grid grids[] = {{{21, 20, 22}, {-1.03, -0.87, -1.11}, {0.1, 0.1, 0.1}},  // begins at the box's corner
                        {{16, 16, 16}, {-0.75, -0.75, -0.75}, {0.1, 0.1, 0.1}},  // within the box
                        {{17, 12, 9}, {-0.1, -1.2, 0.2}, {0.12, 0.1, 0.15}},     // cuts it
                        {{1, 1, 1}, {0, 0, 0}},
                        {{1, 30, 1}, {0, -1.5, 0}, {1, 0.1, 1}},
                        {{9, 9, 9}, {-4e-6, -4e-6, -4e-6}, {1e-6, 1e-6, 1e-6}}};  // doubles its spacing to get out
  for (const Grid& grid : grids) {
    // Samples on the box's faces have no side.
    const std::vector<bool> found = flood(mesh, grid).inside, expected = within(kBox, grid);
    std::size_t n = 0, wrong = 0;
    testing::for_each_sample(grid, [&](auto i, auto j, auto k) {
      const bool on_face = testing::reference_distance(mesh, grid.position(i, j, k)) < 1e-12;
      wrong += !on_face && found[n] != expected[n];
      ++n;
    });
    EXPECT_EQ(wrong, 0u);
  }
}

// Each triangle of a solid is moved by itself. Whatever the cracks, and where the mesh is aligned with the grid too,
// the sides of samples farther from the surface than the cracks are wide are those of the solid; also in a plate of one
// or two layers of samples, which has no inside that keeps half a spacing from its cracks.
TEST(Flood, CracksBelowASpacingAreWalls) {
  const Mesh solids[] = {testing::box({0, 0, 0}, {1, 0.8, 0.6}), scenes::make("sphere", 1200),
                         testing::box({0, 0, 0}, {1, 1, 0.03}),
                         testing::box_of_t_junctions({0, 0, 0}, {1, 1, 0.08}, 3)};
  for (const Mesh& solid : solids) {
    const Box box = bounds(solid);
    const double extent = box.longest_side();
    for (const double far : {1e-9, 1e-7, 1e-5, 1e-3})
      for (const double offset : {0.0, 0.37}) {
        SCOPED_TRACE(std::to_string(far) + " " + std::to_string(offset));
        const double h = extent / 40;
        const Grid grid{{47, 47, 47}, box.min - Vec3{1, 1, 1} * ((3 + offset) * h), {h, h, h}};
        const std::vector<bool> known = winding(solid, grid);
        Mesh mesh = testing::cracked(solid, far * extent, 7);
        for (std::size_t t = 0; t < mesh.triangles.size(); t += 3)
          std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
        const std::vector<bool> found = flood(mesh, grid).inside;
        std::size_t n = 0, wrong = 0;
        testing::for_each_sample(grid, [&](auto i, auto j, auto k) {
          const bool differs = found[n] != known[n];
          wrong += differs && testing::reference_distance(solid, grid.position(i, j, k)) > 4 * far * extent;
          ++n;
        });
        EXPECT_EQ(wrong, 0u);
        EXPECT_GT(std::ranges::count(known, true), 1000);
      }
  }
}

// Rims alone hold nothing off: beside sheets, and around a body with a hole of some spacings, no sample is inside.
TEST(Flood, RimsLeaveNothingInside) {
  const double h = 0.07;
  const Grid grid{{40, 40, 40}, {-1.37, -1.38, -1.39}, {h, h, h}};
  for (const Mesh& mesh : {testing::terrain(12, 0.1), testing::moebius(), testing::cut_off(testing::sphere(16), 0.5),
                           testing::without(testing::sphere(8), 60)})
    EXPECT_EQ(flood(mesh, grid).count, 0);
}

// Triangles without area have no rims, wherever they are.
TEST(Flood, DegenerateTrianglesChangeNothing) {
  const Mesh ball = testing::sphere(10);
  Mesh mesh = ball;
  Random random(11);
  for (int n = 0; n < 300; ++n) {
    // Multiples of a power of two, so that the three are on one line exactly.
    const auto whole = [&] { return static_cast<double>(random.below(192)) / 64 - 1.5; };
    const Vec3 at{whole(), whole(), whole()}, along{whole(), whole(), whole()};
    testing::add_triangle(mesh, at, at + along * 0.25, at + along);
  }
  const Grid grid{{40, 40, 40}, {-1.37, -1.38, -1.39}, {0.07, 0.07, 0.07}};
  EXPECT_EQ(flood(mesh, grid).inside, flood(ball, grid).inside);
}

// What rounding makes of triangles without area, as in a file of single precision: their edges are no rims.
TEST(Flood, NeedlesChangeNothing) {
  const Mesh ball = testing::sphere(10);
  Mesh mesh = ball;
  Random random(12);
  for (int n = 0; n < 300; ++n) {
    const Vec3 at = random.in_cube(1.5), along = random.in_cube(1.5);
    testing::add_triangle(mesh, at, at + along * 0.25 + random.in_cube(1e-7), at + along);
  }
  const Grid grid{{40, 40, 40}, {-1.37, -1.38, -1.39}, {0.07, 0.07, 0.07}};
  EXPECT_EQ(flood(mesh, grid).inside, flood(ball, grid).inside);
}

// A path keeps half a spacing from rims, whichever spacing is the smallest.
TEST(Flood, DistancesToRimsAreThoseOfBruteForce) {
  Random random(3);
  const Grid grid{{21, 18, 19}, {-1, -1, -1}, {0.1, 0.12, 0.11}};
  const TileLattice lattice = TileLattice::of(grid);
  std::vector<RimEdge> rims = {{Vec3{0, 0, 0}, Vec3{0, 0, 0}}, {Vec3{0, 0, -0.5}, Vec3{0, 0, 0.7}}};
  for (int n = 0; n < 12; ++n) rims.push_back({random.in_cube(1.3), random.in_cube(1.3)});
  const double reach = 0.08;
  const ProgressCallback none;
  ProgressMeter progress(none);
  const RimDistances found(rims, lattice, reach, progress);
  const auto brute = [&](const Vec3& p, const Vec3& q) {
    // Segments as degenerate triangles, so that the reference is another algorithm: the least over many points.
    double least = 1e9;
    for (const RimEdge& rim : rims) {
      Mesh segment{{rim[0], rim[1], rim[1]}, {{0, 1, 2}}};
      double low = 0, high = 1;  // the distance along the edge is convex
      for (int step = 0; step < 40; ++step) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        const double at_a = testing::reference_distance(segment, p + (q - p) * a),
                     at_b = testing::reference_distance(segment, p + (q - p) * b);
        (at_a < at_b ? high : low) = at_a < at_b ? b : a;
      }
      least = std::min(least, testing::reference_distance(segment, p + (q - p) * low));
    }
    return least;
  };
  std::int64_t wrong = 0, near = 0;
  testing::for_each_sample(grid, [&](auto i, auto j, auto k) {
    if (testing::kSanitized && (i + j + k) % 5 != 0) return;
    const std::size_t tile = lattice.index(i / 8, j / 8, k / 8);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vec3 p = grid.position(i, j, k), q = grid.position(i + (axis == 0), j + (axis == 1), k + (axis == 2));
      const std::uint16_t steps = found.of(tile, axis, static_cast<std::size_t>(i % 8 + 8 * (j % 8 + 8 * (k % 8))));
      const double expected = brute(p, q) / reach * RimDistances::kFar;
      near += steps < RimDistances::kFar;
      wrong += expected < RimDistances::kFar - 1 ? std::abs(steps + 0.5 - expected) > 1.5
                                                 : expected > RimDistances::kFar + 1 && steps != RimDistances::kFar;
    }
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(near, testing::kSanitized ? 40 : 200);
}

TEST(Flood, IsWhatAFloodFromSampleToSampleFinds) {
  std::int64_t inside = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    // Bodies that overlap, and cavities between them. They have no rims, and so no gaps.
    Random random(seed);
    Mesh mesh = testing::mesh_of(testing::integer_tetrahedra(random, 14, 9));
    for (Vec3& v : mesh.vertices) v = v * 0.1;
    const Grid grid{{27, 25, 24}, {-0.9, -0.8, -0.7}, {0.07, 0.06, 0.065}};
    const Flooded flooded = flood(mesh, grid);
    EXPECT_EQ(flooded.inside, flood_by_samples(mesh, grid)) << seed;
    inside += flooded.count;
  }
  EXPECT_GT(inside, 1000);
}

}  // namespace
}  // namespace standoff
