// SPDX-License-Identifier: Apache-2.0
// Crossed edges: closed meshes are crossed an even number of times by each closed path, although samples lie on
// corners, edges and faces; each edge against the sides of its ends, which integers tell exactly; and the bits of tiles
// against the edges one by one.
#include "sign/flood/grid_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "sign/flood/lattice.h"
#include "tests/sign/solid_soup.h"

namespace standoff::testing {
namespace {

using GridSample = std::array<std::int64_t, 3>;

// How often each edge of the lattice crosses the mesh.
class EdgeCrossings {
 public:
  EdgeCrossings(const Mesh& mesh, const TileLattice& lattice) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for_each_crossed_edge(MeshView(mesh).corners(t), lattice.axes,
                            [&](std::size_t axis, const GridSample& from) { ++times_[axis][from]; });
  }
  int along(std::size_t axis, const GridSample& from) const {
    const auto found = times_[axis].find(from);
    return found == times_[axis].end() ? 0 : found->second;
  }
  std::size_t count() const { return times_[0].size() + times_[1].size() + times_[2].size(); }

 private:
  std::array<std::map<GridSample, int>, 3> times_;
};

GridSample next(GridSample sample, std::size_t axis) {
  ++sample[axis];
  return sample;
}

template <class Use>
void for_each_sample_of(const TileLattice& lattice, std::int64_t margin, const Use& use) {
  for (std::int64_t k = 0; k < lattice.axes[2].size() - margin; ++k)
    for (std::int64_t j = 0; j < lattice.axes[1].size() - margin; ++j)
      for (std::int64_t i = 0; i < lattice.axes[0].size() - margin; ++i) use(GridSample{i, j, k});
}

std::int64_t odd_squares(const Mesh& mesh, const TileLattice& lattice, std::size_t least_crossings) {
  const EdgeCrossings crossings(mesh, lattice);
  EXPECT_GE(crossings.count(), least_crossings);
  std::int64_t odd = 0;
  for_each_sample_of(lattice, 1, [&](const GridSample& at) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3;
      const int around = crossings.along(a, at) + crossings.along(b, next(at, a)) + crossings.along(a, next(at, b)) +
                         crossings.along(b, at);
      odd += around % 2 != 0;
    }
  });
  return odd;
}

TEST(GridEdges, SquaresCrossClosedMeshesAnEvenNumberOfTimes) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    // Nearly all samples are on a corner, an edge or a plane of some triangle.
    const Mesh mesh = mesh_of(integer_tetrahedra(random, 5, 4));
    EXPECT_EQ(odd_squares(mesh, TileLattice::of({{14, 15, 16}, {-7, -7, -7}}), 50), 0) << seed;
  }
  // Three faces in planes of samples.
  const Mesh corner = mesh_of({{Vec3{2, 2, 2}, Vec3{10, 2, 2}, Vec3{2, 10, 2}, Vec3{2, 2, 10}}});
  EXPECT_EQ(odd_squares(corner, TileLattice::of({{13, 13, 13}, {}}), 90), 0);
}

// Of a tetrahedron whose inside integers tell: an edge is crossed an odd number of times where one end is inside.
TEST(GridEdges, OddExactlyBetweenInsideAndOutside) {
  std::int64_t crossed = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const std::vector<Tetrahedron> solid = integer_tetrahedra(random, 1, 6);
    const TileLattice lattice = TileLattice::of({{15, 16, 14}, {-7, -7, -7}});
    const EdgeCrossings crossings(mesh_of(solid), lattice);
    const auto known = [&](const GridSample& s) {
      return known_winding(solid, {lattice.axes[0].at(s[0]), lattice.axes[1].at(s[1]), lattice.axes[2].at(s[2])});
    };
    for_each_sample_of(lattice, 1, [&](const GridSample& at) {
      const auto here = known(at);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto there = known(next(at, axis));
        if (here.on_surface || there.on_surface) continue;
        const bool between = (here.winding != 0) != (there.winding != 0);
        crossed += between;
        EXPECT_EQ(crossings.along(axis, at) % 2 != 0, between) << seed;
      }
    });
  }
  EXPECT_GT(crossed, 1000);
}

TEST(GridEdges, BitsOfTiles) {
  const Mesh mesh = random_soup(3, 300, 2, 0.8);
  for (const bool around : {false, true}) {
    const Grid grid{{33, 20, 17}, {-2, -1.5, -1.2}, {0.11, 0.12, 0.13}};
    const TileLattice lattice = around ? TileLattice::around(grid, bounds(mesh)) : TileLattice::of(grid);
    const ProgressCallback none;
    ProgressMeter progress(none);
    const GridEdges edges(mesh, lattice, progress);
    const EdgeCrossings crossings(mesh, lattice);
    std::int64_t wrong = 0, found = 0;
    for_each_sample_of(lattice, 0, [&](const GridSample& at) {
      const auto [x, y, z] = at;
      const std::size_t tile = lattice.index(x / 8, y / 8, z / 8);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool bit = (edges.of_tile(tile).crossed[axis][z % 8] >> (x % 8 + 8 * (y % 8)) & 1) != 0;
        wrong += bit != (crossings.along(axis, at) > 0);
        found += bit;
      }
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(found, 3000);
  }
}

TEST(TileLattice, ReachesBeyondTheBox) {
  const Grid grid{{20, 9, 8}, {1, 2, 3}, {0.5, 0.25, 1}};
  const auto expect_around = [&](const Box& box) {
    const TileLattice lattice = TileLattice::around(grid, box);
    const double low[3] = {box.min.x, box.min.y, box.min.z}, high[3] = {box.max.x, box.max.y, box.max.z};
    for (std::size_t n = 0; n < 3; ++n) {
      const LatticeAxis& axis = lattice.axes[n];
      EXPECT_LT(axis.at(0), low[n]);
      EXPECT_GT(axis.at(axis.size() - 1), high[n]);
      for (std::int64_t m = 1; m < axis.size(); ++m) EXPECT_LT(axis.at(m - 1), axis.at(m));
      for (const double value : {low[n], high[n], axis.at(axis.size() / 2)}) {
        const std::int64_t first = axis.first_from(value);
        EXPECT_TRUE(axis.at(first) >= value && (first == 0 || axis.at(first - 1) < value));
      }
    }
    for (std::int64_t i = 0; i < grid.size.x; ++i)
      EXPECT_EQ(lattice.axes[0].at(8 * lattice.origin.x + i), grid.position(i, 0, 0).x);
    return lattice.tiles;
  };
  EXPECT_EQ(expect_around({{1.1, 2.1, 3.1}, {10, 4, 9.9}}), (Size3{3, 2, 1}));  // within the grid: nothing is added
  EXPECT_EQ(expect_around({{1, 2.1, 3.1}, {10, 4, 9.9}}), (Size3{4, 2, 1}));    // touches its first face
  EXPECT_EQ(expect_around({{1.1, 2.1, 3.1}, {10, 6, 10}}), (Size3{3, 3, 2}));   // beyond the second, touches the third
  expect_around({{-30, -5, -20}, {40, 30, 50}});
  // Evenly it would take 10^15 tiles.
  const Size3 far = expect_around({{-1e5, -1e5, -1e5}, {1e5, 1e5, 1e12}});
  EXPECT_LE(far.x + far.y + far.z, 40);
  // The spacing is lost in rounding: all samples of the grid are at 1.
  const double spacing = std::ldexp(1.0, -90);
  const TileLattice lost =
      TileLattice::around({{8, 8, 8}, {1, 1, 1}, {spacing, spacing, spacing}}, {{1, 1, 1}, {1, 1, 1}});
  EXPECT_LT(lost.axes[0].at(0), 1);
  EXPECT_GT(lost.axes[0].at(lost.axes[0].size() - 1), 1);
  EXPECT_LE(lost.tiles.x, 20);
}

}  // namespace
}  // namespace standoff::testing
