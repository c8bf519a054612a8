// SPDX-License-Identifier: Apache-2.0
// Thin bands on the emulated GPU: how the work is cut, and triangles on special paths through the kernels.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "field/cuda/pipeline.cuh"
#include "standoff/compute.h"
#include "standoff/testing/emulation.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff::emulated {
namespace {

ComputeResult on(Backend backend, const Mesh& mesh, const Grid& grid, double thickness) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.execution.backend = backend;
  options.nearest = true;
  options.execution.threads = 2;
  return compute(mesh, grid, thickness, options);
}

void expect_same(const Mesh& mesh, const Grid& grid, double thickness) {
  const ComputeResult cpu = on(Backend::cpu, mesh, grid, thickness),
                      gpu = on(standoff::testing::kEmulated, mesh, grid, thickness);
  EXPECT_GT(cpu.report.samples_band, 0);
  EXPECT_EQ(cpu.report.samples_band, gpu.report.samples_band);
  standoff::testing::expect_same_bits(cpu.field, gpu.field);
}

// The work of lists of given lengths, on a grid of 40x3x2 tiles: two groups of 32 along x, the second one not full.
struct Listed {
  static constexpr std::int64_t kTiles = 40 * 3 * 2;
  std::vector<Counter> start;
  std::vector<WorkItem> items;
  std::vector<std::int64_t> cut_tiles = std::vector<std::int64_t>(kTiles);
  std::vector<std::uint32_t> left = std::vector<std::uint32_t>(kTiles + 1);  // by the second pass: nothing
  Outcome outcome{};
  Lattice lattice = make_lattice({{317, 24, 16}, {0, 0, 0}, {1, 1, 1}}, 1);
  OneField field{lattice, {{}, {}, 0, Method::tiles, {}, &outcome}};
  WorkCounts counts{};
  GatherWork work{};

  Listed(const std::vector<Counter>& lengths, bool fills) : start(lengths.size() + 1) {
    std::partial_sum(lengths.begin(), lengths.end(), start.begin() + 1);
    items.resize(static_cast<std::size_t>(kTiles + kMostParts));
    work = {items.data(), static_cast<std::int64_t>(items.size()), cut_tiles.data(), nullptr, &counts};
    launch(nullptr, "check lists", check_lists<OneField>, blocks_for(kTiles), kThreads, field,
           TileLists{left.data(), start.data(), nullptr, start.back()}, work);
    launch(nullptr, "list work", list_work<OneField>, blocks_for(32 * tile_groups(field)), kThreads, field,
           start.data(), work, fills);
  }
};

TEST(CudaBand, EveryEntryAndEveryEmptyTileIsInOneItem) {
  std::mt19937 random(7);
  for (const Counter longest : {Counter{3}, Counter{600}, Counter{60000}})
    for (const bool fills : {false, true}) {
      std::vector<Counter> lengths(Listed::kTiles);
      for (Counter& length : lengths) length = random() % 3 == 0 ? random() % longest : 0;
      const Listed listed(lengths, fills);
      EXPECT_EQ(listed.outcome.stopped, 0);
      ASSERT_LE(listed.counts.heavy + listed.counts.light, listed.items.size());
      std::vector<int> seen(listed.start.back()), filled(lengths.size());
      const Counter part = least_part(listed.start.back());
      for (Counter n = 0; n < listed.work.size(); ++n) {
        const WorkItem& item = listed.work.at(n);
        const auto tile = listed.lattice.tile(item.tile[0], item.tile[1], item.tile[2]);
        if (item.count == 0) {
          for (int bit = 0; bit < 32; ++bit)
            if (item.cut >> bit & 1) ++filled[static_cast<std::size_t>(tile + bit)];
          continue;
        }
        const Counter length = lengths[static_cast<std::size_t>(tile)];
        EXPECT_EQ(n<listed.counts.heavy, 2 * length> part) << "long lists come first";
        if (item.cut == kWhole) {
          EXPECT_EQ(item.count, length);
          EXPECT_LE(length, part);
        } else {
          EXPECT_LE(item.count, part);
          EXPECT_GT(length, part);
          ASSERT_LT(item.cut, listed.counts.cut);
          EXPECT_EQ(listed.cut_tiles[item.cut], tile);
        }
        EXPECT_GE(item.first, listed.start[static_cast<std::size_t>(tile)]);
        ASSERT_LE(item.first + item.count, listed.start[static_cast<std::size_t>(tile) + 1]);
        for (Counter entry = item.first; entry < item.first + item.count; ++entry) ++seen[entry];
      }
      for (const Counter times : {1, 2})
        EXPECT_EQ(listed.counts.longer[times - 1],
                  std::count_if(lengths.begin(), lengths.end(), [&](Counter n) { return n > times * part; }));
      EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
      for (std::size_t tile = 0; tile < lengths.size(); ++tile)
        ASSERT_EQ(filled[tile], fills && lengths[tile] == 0) << tile;
    }
}

TEST(CudaBand, PartsAreLongerWhereTooManyListsWouldBeCut) {
  WorkCounts counts{};
  const GatherWork work{nullptr, 0, nullptr, nullptr, &counts};
  const Counter entries = 100 * kMostParts - 5;
  EXPECT_EQ(work.part(7), kLeastPart);
  EXPECT_EQ(work.part(entries), 100u);
  counts.longer[0] = kMostCut;
  EXPECT_EQ(work.part(entries), 100u);
  counts.longer[0] = kMostCut + 1;
  counts.longer[1] = kMostCut;
  EXPECT_EQ(work.part(entries), 200u);
  counts.longer[1] = kMostCut + 1;
  EXPECT_EQ(work.part(entries), 400u);
}

TEST(CudaBand, RowsOfATriangleAreToldApartWithoutDividing) {
  for (int ny = 1; ny <= kTileSide; ++ny)
    for (int row = 0; row < kTileSide * kTileSide; ++row) {
      const StagedRows rows = packed({1, 8, 7, ny, 6, 8}, 2047);
      EXPECT_EQ(rows.number & 0xffff, 2047u);
      EXPECT_EQ(row * static_cast<int>(rows.number >> 16) >> 10, row / ny);
    }
}

// Many warps share a triangle across a fine grid, which would keep a single warp busy for long.
TEST(CudaBand, TrianglesAcrossMoreThanAThousandTiles) {
  Mesh mesh = standoff::testing::random_soup(111, 20, 100, 3, {140, 130, 4});
  standoff::testing::add_triangle(mesh, {1, 2, 3}, {270, 263, 4}, {265, 263, 4.5});
  standoff::testing::add_triangle(mesh, {2, 262, 4}, {271, 1, 3}, {271, 2, 3});
  const Grid grid{{272, 264, 8}, {0, 0, 0}, {1, 1, 1}};
  const CellRange whole{{0, 0, 0}, {33, 32, 0}};
  ASSERT_GT(tiles_in(whole), kHugeRange);
  expect_same(mesh, grid, 1.5);
}

TEST(CudaBand, FewLanesShareALongTriangleWhereThereAreMany) {
  const Counter warps = 64;
  EXPECT_EQ(lanes_per_long(0, warps), 32);
  EXPECT_EQ(lanes_per_long(31, warps), 32);
  EXPECT_EQ(lanes_per_long(32, warps), 16);
  EXPECT_EQ(lanes_per_long(511, warps), 2);
  EXPECT_EQ(lanes_per_long(512, warps), 1);
  EXPECT_EQ(lanes_per_long(1'000'000'000'000, warps), 1);
}

// Triangles that lanes bin alone, and among them some that have too many tiles for that.
TEST(CudaBand, WideTrianglesAmongManyLongOnes) {
  const Grid grid{{96, 96, 96}, {-48, -48, -48}, {1, 1, 1}};
  for (const int triangles : {2, 20, 200}) {
    SCOPED_TRACE(triangles);
    Mesh mesh = standoff::testing::random_soup(113, triangles, 40, 14);
    for (int n = 0; n < 1 + triangles / 20; ++n)
      standoff::testing::add_triangle(mesh, {-40.0 + n, -40, 3.0 * n - 20}, {40, 41.0 - n, 20}, {42, -30, 5});
    expect_same(mesh, grid, 1.5);
  }
}

// More long triangles in a warp than it stages at once, in lists of one round and of several, and in one that is cut.
TEST(CudaBand, ManyLongTrianglesInATile) {
  const Grid grid{{9, 8, 8}, {-4, -4, -4}, {1, 1, 1}};
  for (const int triangles : {12, 40, 120, 300}) {
    SCOPED_TRACE(triangles);
    expect_same(standoff::testing::random_soup(112, triangles, 3, 40), grid, 1.5);
  }
}

}  // namespace
}  // namespace standoff::emulated
