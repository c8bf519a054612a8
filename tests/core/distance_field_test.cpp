// SPDX-License-Identifier: Apache-2.0
// Distance fields as containers: what is stored, and what is read back.
#include "standoff/field.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>
#include <vector>

#include "field_samples.h"
#include "standoff/error.h"
#include "tests/support/error_code.h"
#include "tests/support/fields.h"

namespace standoff::testing {
namespace {

TEST(DistanceField, NewOnesAreFarEverywhere) {
  const DistanceField field(kGrid, 3.5, true);
  EXPECT_EQ(field.grid(), kGrid);
  EXPECT_EQ(field.thickness(), 3.5);
  EXPECT_EQ(field.tile_count(), (Size3{3, 2, 4}));
  EXPECT_EQ(field.stored_tiles(), 0);
  EXPECT_FALSE(field.tile(2, 1, 3));
  EXPECT_FALSE(field.tile_nearest(2, 1, 3));
  for_each_sample(kGrid, [&](auto i, auto j, auto k) {
    ASSERT_EQ(field.value(i, j, k), 3.5f);
    ASSERT_EQ(field.nearest(i, j, k), kNoTriangle);
  });
  EXPECT_EQ(field.interpolate(kGrid.position(3, 4, 5)), 3.5);
  EXPECT_EQ(field.gradient(kGrid.position(3, 4, 5)), Vec3{});
}

TEST(DistanceField, RefusesWhatCannotBe) {
  const auto made = [](const Grid& grid, double thickness) { return [=] { DistanceField(grid, thickness); }; };
  EXPECT_EQ(code_of(made(kGrid, 0)), ErrorCode::usage);
  EXPECT_EQ(code_of(made(kGrid, -1)), ErrorCode::usage);
  EXPECT_EQ(code_of(made(kGrid, std::nan(""))), ErrorCode::usage);
  EXPECT_EQ(code_of(made(Grid{{0, 1, 1}, {}, {1, 1, 1}}, 1)), ErrorCode::usage);
  // 2^33 tiles: more than their table counts, and refused before it is made.
  EXPECT_EQ(code_of(made(Grid{{1 << 14, 1 << 14, 1 << 14}, {}, {1, 1, 1}}, 1)), ErrorCode::limit);
  const std::vector<float> few(5);
  EXPECT_EQ(code_of([&] { DistanceField::from_dense(kGrid, 1, few); }), ErrorCode::usage);
  const std::vector<float> all(static_cast<std::size_t>(kGrid.sample_count()));
  const std::vector<std::uint32_t> few_nearest(5);
  EXPECT_EQ(code_of([&] { DistanceField::from_dense(kGrid, 1, all, few_nearest); }), ErrorCode::usage);
}

TEST(DistanceField, DenseInIsDenseOut) {
  const auto values = numbers(kGrid, 3);
  std::vector<std::uint32_t> nearest;
  for (std::size_t n = 0; n < values.size(); ++n) nearest.push_back(static_cast<std::uint32_t>(7 * n));
  const auto field = DistanceField::from_dense(kGrid, 3.5, values, nearest);
  EXPECT_TRUE(field.has_nearest());
  EXPECT_EQ(field.to_dense(), values);
  EXPECT_EQ(all_nearest(field), nearest);
  for_each_sample(kGrid, [&](auto i, auto j, auto k) {
    ASSERT_EQ(field.value(i, j, k), values[kGrid.index(i, j, k)]);
    ASSERT_EQ(field.nearest(i, j, k), nearest[kGrid.index(i, j, k)]);
  });
}

TEST(DistanceField, OnlyTilesWithAValueBelowTheThicknessAreStored) {
  std::vector<float> values(static_cast<std::size_t>(kGrid.sample_count()), 2);
  values[kGrid.index(8, 7, 23)] = 1.5f;   // tile (1, 0, 2)
  values[kGrid.index(18, 9, 25)] = 0.5f;  // the last sample, tile (2, 1, 3)
  const auto field = DistanceField::from_dense(kGrid, 2, values);
  EXPECT_EQ(field.stored_tiles(), 2);
  for (std::int64_t z = 0; z < 4; ++z)
    for (std::int64_t y = 0; y < 2; ++y)
      for (std::int64_t x = 0; x < 3; ++x)
        EXPECT_EQ(field.tile(x, y, z).has_value(), (x == 1 && y == 0 && z == 2) || (x == 2 && y == 1 && z == 3))
            << x << y << z;
  EXPECT_EQ(field.to_dense(), values);
  // Past the grid a stored tile holds the thickness.
  const DistanceField::TileValues last = field.tile(2, 1, 3).value();
  EXPECT_EQ(last[2 + 8 * (1 + 8 * 1)], 0.5f);
  EXPECT_EQ(last[3 + 8 * (1 + 8 * 1)], 2);
  EXPECT_EQ(last[7 + 8 * (7 + 8 * 7)], 2);
  EXPECT_EQ(field.memory_bytes(), 2 * 512 * 4 + 24 * 4);
}

TEST(DistanceField, TilesWithNearestTrianglesAtTheThicknessAreStored) {
  const Grid grid{{8, 8, 8}, {}, {1, 1, 1}};
  const std::vector<float> values(512, 2);
  std::vector<std::uint32_t> nearest(512, kNoTriangle);
  EXPECT_EQ(DistanceField::from_dense(grid, 2, values, nearest).stored_tiles(), 0);
  nearest[100] = 3;
  const auto field = DistanceField::from_dense(grid, 2, values, nearest);
  EXPECT_EQ(field.stored_tiles(), 1);
  EXPECT_EQ(all_nearest(field), nearest);
}

TEST(DistanceField, StoredTilesAreReadBack) {
  DistanceField field(kGrid, 9, true);
  const auto values = field.store_tile(1, 1, 2);
  const auto nearest = field.store_nearest(1, 1, 2);
  for (int n = 0; n < 512; ++n) values[n] = static_cast<float>(n) / 100, nearest[n] = static_cast<std::uint32_t>(n);
  EXPECT_EQ(field.stored_tiles(), 1);
  EXPECT_EQ(field.value(8, 8, 16), 0);
  EXPECT_EQ(field.value(9, 8, 16), 0.01f);
  EXPECT_EQ(field.value(8, 9, 16), 0.08f);
  EXPECT_EQ(field.value(8, 8, 17), 0.64f);
  EXPECT_EQ(field.nearest(15, 9, 23), 7u + 8 + 7 * 64);
  EXPECT_EQ(field.value(7, 8, 16), 9);
  EXPECT_EQ(field.nearest(7, 8, 16), kNoTriangle);
}

TEST(DistanceField, SlicesAreCopied) {
  const auto values = numbers(kGrid, 3);
  const auto field = DistanceField::from_dense(kGrid, 3.5, values);
  const auto slice = static_cast<std::size_t>(kGrid.size.x * kGrid.size.y);
  for (const auto& [first, count] : {std::pair<std::size_t, std::size_t>{0, 1}, {7, 2}, {25, 1}, {3, 0}}) {
    std::vector<float> out(slice * count);
    field.copy_slices(static_cast<std::int64_t>(first), static_cast<std::int64_t>(count), out);
    EXPECT_TRUE(std::equal(out.begin(), out.end(), values.begin() + static_cast<std::ptrdiff_t>(first * slice)));
  }
  std::vector<float> out(slice);
  std::vector<std::uint32_t> nearest(slice);
  EXPECT_EQ(code_of([&] { field.copy_slices(-1, 1, out); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { field.copy_slices(26, 1, out); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { field.copy_slices(0, 2, out); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { field.copy_slices(0, -1, out); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { field.copy_nearest_slices(0, 1, nearest); }), ErrorCode::usage);  // it has none
}

TEST(DistanceField, CopiesAreDeepAndMovesAreWhole) {
  const auto values = numbers(kGrid, 3);
  const std::vector<std::uint32_t> nearest(values.size(), 5);
  auto field = DistanceField::from_dense(kGrid, 3.5, values, nearest);
  field.set_provenance({"tiles", 42, "1.2.3", "winding"});
  DistanceField copy(field);
  EXPECT_EQ(copy.provenance().method, "tiles");
  EXPECT_EQ(copy.provenance().mesh_hash, 42u);
  EXPECT_EQ(copy.provenance().version, "1.2.3");
  EXPECT_EQ(copy.memory_bytes(), field.memory_bytes());
  const_cast<float&>((*field.tile(0, 0, 0))[0]) = 3.25f;
  EXPECT_EQ(field.value(0, 0, 0), 3.25f);
  EXPECT_EQ(copy.to_dense(), values);
  EXPECT_EQ(all_nearest(copy), nearest);

  DistanceField assigned(Grid{{1, 1, 1}, {}, {1, 1, 1}}, 1);
  assigned = copy;
  const DistanceField& itself = assigned;
  assigned = itself;
  EXPECT_EQ(assigned.to_dense(), values);
  const DistanceField moved(std::move(copy));
  EXPECT_EQ(moved.to_dense(), values);
  EXPECT_EQ(moved.grid(), kGrid);
}

void expect_empty(DistanceField& field) {
  EXPECT_EQ(field.grid(), (Grid{{1, 1, 1}, {}, {1, 1, 1}}));
  EXPECT_EQ(field.thickness(), kInfinity);
  EXPECT_FALSE(field.has_nearest());
  EXPECT_EQ(field.provenance().method, "");
  EXPECT_EQ(field.provenance().mesh_hash, 0u);
  EXPECT_EQ(field.tile_count(), (Size3{1, 1, 1}));
  EXPECT_EQ(field.stored_tiles(), 0);
  EXPECT_EQ(field.memory_bytes(), 0);
  EXPECT_FALSE(field.tile(0, 0, 0));
  EXPECT_FALSE(field.tile_nearest(0, 0, 0));
  EXPECT_EQ(field.value(0, 0, 0), kInfinity);
  EXPECT_EQ(field.nearest(0, 0, 0), kNoTriangle);
  EXPECT_EQ(field.interpolate({}), kInfinity);
  EXPECT_EQ(field.interpolate({3, 4, 5}, Outside::border), kInfinity);
  EXPECT_EQ(field.gradient({3, 4, 5}, Outside::border), Vec3{});
  EXPECT_EQ(field.to_dense(), std::vector<float>{std::numeric_limits<float>::infinity()});
  EXPECT_EQ(code_of([&] { field.store_tile(0, 0, 0); }), ErrorCode::usage);
  EXPECT_EQ(DistanceField(field).stored_tiles(), 0);
}

TEST(DistanceField, EmptyOnesAreFarEverywhere) {
  DistanceField empty;
  expect_empty(empty);
}

TEST(DistanceField, MovedFromOnesAreEmpty) {
  const auto values = numbers(kGrid, 3);
  auto field = DistanceField::from_dense(kGrid, 3.5, values, std::vector<std::uint32_t>(values.size(), 5));
  field.set_provenance({"tiles", 42, "1.2.3", "winding"});
  DistanceField moved(std::move(field));
  expect_empty(field);
  field = std::move(moved);
  expect_empty(moved);
  DistanceField& itself = field;
  field = std::move(itself);
  EXPECT_EQ(field.to_dense(), values);
  EXPECT_EQ(field.provenance().mesh_hash, 42u);
}

TEST(DistanceField, TilesOfAGridAreKnownBeforeTheField) {
  for (const Size3 samples : {Size3{1, 8, 9}, Size3{7, 16, 17}, Size3{64, 1, 65}}) {
    const DistanceField field({samples, {}, {1, 1, 1}}, 1);
    EXPECT_EQ(DistanceField::tiles_of(samples), field.tile_count());
    EXPECT_EQ(std::ssize(field.slots()), field.tile_count().count());
  }
  EXPECT_EQ(DistanceField::tiles_of({7, 16, 17}), (Size3{1, 2, 3}));
}

TEST(DistanceField, TilesAreStoredOnce) {
  DistanceField field(kGrid, 9, true);
  EXPECT_EQ(code_of([&] { field.store_nearest(1, 1, 2); }), ErrorCode::usage) << "not stored";
  field.store_tile(1, 1, 2);
  EXPECT_NO_THROW(field.store_nearest(1, 1, 2));
  EXPECT_EQ(code_of([&] { field.store_tile(1, 1, 2); }), ErrorCode::usage);
  for (const Size3 t : {Size3{-1, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 4}})
    EXPECT_EQ(code_of([&] { field.store_tile(t.x, t.y, t.z); }), ErrorCode::usage) << t.x << t.y << t.z;
  EXPECT_EQ(field.stored_tiles(), 1);
  DistanceField plain(kGrid, 9);
  plain.store_tile(0, 0, 0);
  EXPECT_EQ(code_of([&] { plain.store_nearest(0, 0, 0); }), ErrorCode::usage);
}

// More tiles than a chunk of the pool holds.
TEST(DistanceField, CopiesManyTiles) {
  const Grid grid{{64, 64, 72}, {}, {1, 1, 1}};
  const auto values = numbers(grid, 3);
  const auto field = DistanceField::from_dense(grid, 3.5, values);
  EXPECT_EQ(field.stored_tiles(), 576);
  EXPECT_EQ(DistanceField(field).to_dense(), values);
}

TEST(DistanceField, StoredTilesAreGoneThroughInOrder) {
  DistanceField field(kGrid, 9, true);
  for (const Size3 at : {Size3{2, 1, 3}, {0, 0, 0}, {1, 0, 2}}) {
    std::ranges::fill(field.store_tile(at.x, at.y, at.z), static_cast<float>(at.x));
    std::ranges::fill(field.store_nearest(at.x, at.y, at.z), static_cast<std::uint32_t>(at.z));
  }
  field.mark_inside(1, 1, 1);
  std::vector<Size3> found;
  for (const DistanceField::Tile& tile : field.tiles()) {
    found.push_back(tile.at);
    EXPECT_EQ(tile.index, tile.at.x + 3 * (tile.at.y + 2 * tile.at.z));
    EXPECT_EQ(tile.values.data(), field.tile(tile.at.x, tile.at.y, tile.at.z)->data());
    EXPECT_EQ(tile.values[511], static_cast<float>(tile.at.x));
    ASSERT_EQ(tile.nearest.size(), 512u);
    EXPECT_EQ(tile.nearest[511], static_cast<std::uint32_t>(tile.at.z));
  }
  EXPECT_EQ(found, (std::vector<Size3>{{0, 0, 0}, {1, 0, 2}, {2, 1, 3}}));
  const DistanceField none(kGrid, 9), empty;
  EXPECT_TRUE(none.tiles().begin() == none.tiles().end());
  EXPECT_TRUE(empty.tiles().begin() == empty.tiles().end());
  static_assert(std::ranges::forward_range<DistanceField::TileRange>);
}

// What a GPU or numpy takes: one array, in which slots() tells where each tile lies.
TEST(DistanceField, StoredTilesLieInOneArray) {
  const Grid grid{{64, 64, 72}, {}, {1, 1, 1}};
  const auto values = numbers(grid, 3);
  const std::vector<std::uint32_t> nearest(values.size(), 5);
  const auto field = DistanceField::from_dense(grid, 3.5, values, nearest);
  EXPECT_EQ(field.slots().size(), 576u);
  EXPECT_EQ(field.tile_values().size(), 576u * 512);
  EXPECT_EQ(field.tile_nearest_values().size(), 576u * 512);
  const auto coordinates = field.tile_coordinates();
  ASSERT_EQ(coordinates.size(), 576u);
  for (std::size_t slot = 0; slot < coordinates.size(); ++slot) {
    const auto& [x, y, z] = coordinates[slot];
    EXPECT_EQ(field.slots()[static_cast<std::size_t>(x + 8 * (y + 8 * z))], static_cast<std::int32_t>(slot));
    EXPECT_EQ(field.tile(x, y, z)->data(), &field.tile_values()[512 * slot]);
    EXPECT_EQ(field.tile_nearest(x, y, z)->data(), &field.tile_nearest_values()[512 * slot]);
  }
  const DistanceField empty;
  EXPECT_TRUE(empty.slots().empty() && empty.tile_values().empty() && empty.tile_coordinates().empty());
  EXPECT_EQ(code_of([] { return DistanceField(kGrid, 1).tile_nearest_values(); }), ErrorCode::usage);
}

TEST(DistanceField, TilesStayWhereTheyAreWhileThreadsStoreMore) {
  const Grid grid{{160, 160, 160}, {}, {1, 1, 1}};
  DistanceField field(grid, 9, true);
  const std::int64_t count = field.tile_count().count();
  tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t n) {
    const Size3 at{n % 20, n / 20 % 20, n / 400};
    const auto values = field.store_tile(at.x, at.y, at.z);
    const auto nearest = field.store_nearest(at.x, at.y, at.z);
    for (int s = 0; s < 512; ++s) values[s] = static_cast<float>(n), nearest[s] = static_cast<std::uint32_t>(n);
  });
  EXPECT_EQ(field.stored_tiles(), count);
  for (const DistanceField::Tile& tile : field.tiles()) {
    ASSERT_TRUE(std::ranges::all_of(tile.values, [&](float v) { return v == static_cast<float>(tile.index); }));
    ASSERT_TRUE(std::ranges::all_of(tile.nearest, [&](auto t) { return t == tile.index; }));
  }
}

TEST(DistanceField, TilesDeepInsideNeedNotBeStored) {
  DistanceField field(kGrid, 2, true);
  std::ranges::fill(field.store_tile(0, 0, 0), 0.5f);
  std::ranges::fill(field.store_nearest(0, 0, 0), 7u);
  field.mark_inside(1, 0, 0);
  EXPECT_EQ(field.background(1, 0, 0), -2);
  EXPECT_EQ(field.background(2, 0, 0), 2);
  EXPECT_EQ(field.background(0, 0, 0), 2) << "a stored one";
  EXPECT_EQ(field.slots()[1], DistanceField::kInside);
  EXPECT_EQ(field.slots()[2], DistanceField::kOutside);
  EXPECT_FALSE(field.tile(1, 0, 0));
  EXPECT_EQ(field.value(8, 0, 0), -2);
  EXPECT_EQ(field.nearest(8, 0, 0), kNoTriangle);
  EXPECT_EQ(field.interpolate(kGrid.position(9, 1, 1)), -2);
  EXPECT_EQ(field.interpolate((kGrid.position(15, 1, 1) + kGrid.position(16, 1, 1)) * 0.5), 0) << "-2 and 2";
  EXPECT_EQ(field.gradient((kGrid.position(15, 1, 1) + kGrid.position(16, 1, 1)) * 0.5).x, 4 / kGrid.spacing.x);
  std::vector<float> slice(static_cast<std::size_t>(kGrid.size.x * kGrid.size.y));
  field.copy_slices(0, 1, slice);
  EXPECT_EQ(slice[7], 0.5f);
  EXPECT_EQ(slice[8], -2);
  EXPECT_EQ(slice[16], 2);
  EXPECT_EQ(DistanceField(field).value(8, 0, 0), -2);
  EXPECT_EQ(field.stored_tiles(), 1);
  EXPECT_EQ(code_of([&] { field.mark_inside(0, 0, 0); }), ErrorCode::usage) << "stored";
  EXPECT_EQ(code_of([&] { field.mark_inside(3, 0, 0); }), ErrorCode::usage) << "no tile";
  EXPECT_EQ(code_of([] { DistanceField().mark_inside(0, 0, 0); }), ErrorCode::usage);
  field.store_tile(1, 0, 0)[0] = 1;
  EXPECT_EQ(field.value(8, 0, 0), 1);
  field.reset(kGrid, 2);
  EXPECT_EQ(field.background(1, 0, 0), 2);
}

TEST(DistanceField, SignedFieldsComeBackFromDenseMemory) {
  const Grid grid{{33, 20, 17}, {}, {1, 1, 1}};
  std::vector<float> values;
  for_each_sample(grid,
                  [&](auto i, auto, auto) { values.push_back(std::clamp(static_cast<float>(i) - 20, -2.0f, 2.0f)); });
  const auto field = DistanceField::from_dense(grid, 2, values);
  // Along x: two tiles inside, one stored, one outside, and one that holds a single sample of the grid.
  for (std::size_t n = 0; n < field.slots().size(); ++n) {
    const std::size_t tx = n % 5;
    if (tx == 2)
      EXPECT_GE(field.slots()[n], 0);
    else
      EXPECT_EQ(field.slots()[n], tx < 2 ? DistanceField::kInside : DistanceField::kOutside) << n;
  }
  EXPECT_EQ(field.to_dense(), values);
  for_each_sample(grid, [&](auto i, auto j, auto k) { ASSERT_EQ(field.value(i, j, k), values[grid.index(i, j, k)]); });
  const auto again = DistanceField::from_dense(grid, 2, field.to_dense());
  EXPECT_TRUE(std::ranges::equal(again.slots(), field.slots()));
  // Of a tile at the grid's end only the samples in the grid count.
  const auto last =
      DistanceField::from_dense({{9, 1, 1}, {}, {1, 1, 1}}, 2, std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, -2});
  EXPECT_EQ(last.stored_tiles(), 1);
  EXPECT_EQ(last.background(1, 0, 0), -2);
}

}  // namespace
}  // namespace standoff::testing
