// SPDX-License-Identifier: Apache-2.0
// labels: memory threads

#include "field/cpu/bins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using cpu::Bins;
using cpu::Reach;
using Sorted = std::vector<std::vector<std::uint32_t>>;  // triangles of each brick

const Grid kBinsGrid{{70, 40, 33}, {-9, -5, -4}, {0.25, 0.25, 0.25}};

struct Binned {
  Sorted bricks;
  int batches = 0;
  std::int64_t fullest_batch = 0;
};

Binned binned(const Mesh& mesh, double thickness, std::int64_t most_refs, Reach reach = Reach::distance,
              int threads = 2, std::vector<std::uint32_t> kept = {}) {
  const ComputeOptions options{.sign = {SignMethod::none}};
  ProgressMeter progress(options.progress);
  const Job job{mesh, kept, kBinsGrid, thickness, threads, Simd::automatic, progress};
  const cpu::BlockLattice lattice = cpu::make_block_lattice(kBinsGrid, thickness);
  Binned result;
  cpu::for_each_batch(
      job, lattice, most_refs,
      [&](const Bins& bins) {
        EXPECT_EQ(bins.first_brick, static_cast<std::int64_t>(result.bricks.size())) << "batches come in brick order";
        ++result.batches;
        result.fullest_batch = std::max(result.fullest_batch, static_cast<std::int64_t>(bins.refs.size()));
        for (std::int64_t n = 0; n < bins.bricks(); ++n)
          result.bricks.emplace_back(bins.of(n).begin(), bins.of(n).end());
      },
      reach);
  EXPECT_EQ(static_cast<std::int64_t>(result.bricks.size()), lattice.brick_count());
  return result;
}

Mesh short_and_long() {
  Mesh mesh = testing::random_soup(61, 9000, 8, 0.4);
  const Mesh large = testing::random_soup(62, 40, 8, 9);
  for (std::size_t t = 0; t < large.triangles.size(); ++t)
    testing::add_triangle(mesh, MeshView(large).corner(t, 0), MeshView(large).corner(t, 1),
                          MeshView(large).corner(t, 2));
  return mesh;
}

TEST(TilesBins, BatchesOfAnySizeGiveTheSame) {
  const Mesh mesh = short_and_long();
  const Binned whole = binned(mesh, 0.5, 1 << 24);
  EXPECT_EQ(whole.batches, 1);
  std::int64_t fullest_brick = 0;
  for (const auto& brick : whole.bricks)
    fullest_brick = std::max(fullest_brick, static_cast<std::int64_t>(brick.size()));
  for (const std::int64_t most : {1, 100, 5000}) {
    const Binned parts = binned(mesh, 0.5, most);
    EXPECT_GT(parts.batches, 1);
    EXPECT_LE(parts.fullest_batch, std::max(most, fullest_brick));
    EXPECT_TRUE(parts.bricks == whole.bricks) << most;
  }
}

TEST(TilesBins, TrianglesAscendForAnyNumberOfThreads) {
  const Mesh mesh = short_and_long();
  const Binned one = binned(mesh, 0.5, 1 << 24, Reach::distance, 1);
  for (const auto& brick : one.bricks) EXPECT_TRUE(std::ranges::is_sorted(brick));
  for (const int threads : {2, 5}) EXPECT_TRUE(binned(mesh, 0.5, 3000, Reach::distance, threads).bricks == one.bricks);
}

TEST(TilesBins, EveryBrickHasTheTrianglesThatReachItsSamples) {
  const Mesh mesh = testing::random_soup(63, 60, 9, 3);
  for (const double thickness : {0.1, 1.0}) {
    const Binned by_distance = binned(mesh, thickness, 1 << 20), by_box = binned(mesh, thickness, 1 << 20, Reach::box);
    const cpu::BlockLattice lattice = cpu::make_block_lattice(kBinsGrid, thickness);
    std::vector<std::set<std::uint32_t>> within(by_distance.bricks.size()), in_box(within.size());
    testing::for_each_sample(kBinsGrid, [&](auto i, auto j, auto k) {
      const auto brick = static_cast<std::size_t>(i / 16 + lattice.bricks[0] * (j / 16 + lattice.bricks[1] * (k / 16)));
      const Vec3 p = kBinsGrid.position(i, j, k);
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        Box box;
        for (int c = 0; c < 3; ++c) box.include(MeshView(mesh).corner(t, c));
        const Box grown = box.grown(thickness);
        if (min(p, grown.min) == grown.min && max(p, grown.max) == grown.max) in_box[brick].insert(t);
        if (in_box[brick].contains(t) && !within[brick].contains(t) &&
            testing::reference_distance(mesh, t, p) <= thickness)
          within[brick].insert(t);
      }
    });
    std::size_t sorted = 0, needed = 0;
    for (std::size_t brick = 0; brick < within.size(); ++brick) {
      EXPECT_TRUE(std::ranges::includes(by_distance.bricks[brick], within[brick])) << brick;
      EXPECT_TRUE(std::ranges::includes(by_box.bricks[brick], in_box[brick])) << brick;
      sorted += by_distance.bricks[brick].size();
      needed += within[brick].size();
    }
    EXPECT_LE(sorted, 3 * needed) << "bricks should not get triangles far from them";
  }
}

TEST(TilesBins, OnlyTheTrianglesToUse) {
  const Mesh mesh = testing::random_soup(64, 500, 8, 0.5);
  std::vector<std::uint32_t> even;
  for (std::uint32_t t = 0; t < 500; t += 2) even.push_back(t);
  const Binned all = binned(mesh, 0.5, 1 << 20), some = binned(mesh, 0.5, 1 << 20, Reach::distance, 2, even);
  for (std::size_t brick = 0; brick < all.bricks.size(); ++brick) {
    std::vector<std::uint32_t> expected = all.bricks[brick];
    std::erase_if(expected, [](std::uint32_t t) { return t % 2 != 0; });
    EXPECT_EQ(some.bricks[brick], expected);
  }
}

}  // namespace
}  // namespace standoff
