// SPDX-License-Identifier: Apache-2.0
// Tiles of distance fields that are removed again.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "field_samples.h"
#include "standoff/error.h"
#include "standoff/field.h"
#include "tests/support/error_code.h"
#include "tests/support/fields.h"

namespace standoff::testing {
namespace {

TEST(ErasedTiles, ErasedTilesAreGone) {
  const auto values = numbers(kGrid, 3);
  const std::vector<std::uint32_t> nearest(values.size(), 5);
  auto field = DistanceField::from_dense(kGrid, 3.5, values, nearest);
  ASSERT_EQ(field.stored_tiles(), 24);
  for (const Size3 at : {Size3{1, 0, 2}, {2, 1, 3}, {0, 0, 0}}) field.erase_tile(at.x, at.y, at.z);
  EXPECT_EQ(field.stored_tiles(), 21);
  EXPECT_EQ(field.tile_values().size(), 21u * 512);
  for_each_sample(kGrid, [&](auto i, auto j, auto k) {
    const Size3 at{i / 8, j / 8, k / 8};
    const bool erased = at == Size3{1, 0, 2} || at == Size3{2, 1, 3} || at == Size3{0, 0, 0};
    ASSERT_EQ(field.value(i, j, k), erased ? 3.5f : values[kGrid.index(i, j, k)]);
    ASSERT_EQ(field.nearest(i, j, k), erased ? kNoTriangle : 5u);
  });
  EXPECT_EQ(code_of([&] { field.erase_tile(1, 0, 2); }), ErrorCode::usage);
  std::ranges::fill(field.store_tile(1, 0, 2), 1.0f);
  EXPECT_EQ(field.stored_tiles(), 22);
  EXPECT_EQ(field.value(8, 0, 16), 1);
}

TEST(ErasedTiles, ManyTilesAreErasedOrNone) {
  const auto values = numbers(kGrid, 3);
  const std::vector<std::uint32_t> nearest(values.size(), 5);
  const auto full = DistanceField::from_dense(kGrid, 3.5, values, nearest);
  const Size3 tiles = full.tile_count();
  for (unsigned seed = 0; seed < 20; ++seed) {
    auto field = full, one_by_one = full;
    std::vector<Size3> erased;
    std::mt19937 random(seed);
    for (std::int64_t n = 0; n < tiles.count(); ++n)
      if (random() % 3 != 0) erased.push_back({n % tiles.x, n / tiles.x % tiles.y, n / (tiles.x * tiles.y)});
    std::ranges::shuffle(erased, random);
    auto twice = erased;
    twice.push_back(erased[0]);
    EXPECT_EQ(code_of([&] { field.erase_tiles(twice); }), ErrorCode::usage);
    EXPECT_EQ(field.to_dense(), values);
    field.erase_tiles(erased);
    for (const Size3& at : erased) one_by_one.erase_tile(at.x, at.y, at.z);
    EXPECT_EQ(field.stored_tiles(), tiles.count() - std::ssize(erased));
    EXPECT_EQ(field.to_dense(), one_by_one.to_dense());
    std::vector<std::uint32_t> left(values.size()), left_one_by_one(values.size());
    field.copy_nearest_slices(0, kGrid.size.z, left);
    one_by_one.copy_nearest_slices(0, kGrid.size.z, left_one_by_one);
    EXPECT_EQ(left, left_one_by_one);
    field.erase_nearest();
    EXPECT_FALSE(field.has_nearest());
    EXPECT_EQ(field.to_dense(), one_by_one.to_dense());
    EXPECT_EQ(code_of([&] { field.nearest(0, 0, 0); }), ErrorCode::usage);
  }
}

// A tile that is not stored was +thickness, whatever side it lies on.
}  // namespace
}  // namespace standoff::testing
