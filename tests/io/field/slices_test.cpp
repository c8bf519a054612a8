// SPDX-License-Identifier: Apache-2.0
// Slices of files: what is read of any of them is what the whole field has there.
// labels: memory
#include <gtest/gtest.h>

#include <vector>

#include "standoff/field_slices.h"
#include "standoff/io.h"
#include "tests/io/field/odd_field.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// More than one compressed block, and a window of a grid.
const Grid kGrid = Grid{{130, 70, 80}, {1, 2, 3}, {0.5, 1, 2}}.window({20, 10, 3}, {90, 60, 70});

std::vector<float> values_of(const DistanceField& field, std::int64_t first, std::int64_t count) {
  std::vector<float> values;
  for (std::int64_t k = first; k < first + count; ++k)
    for (std::int64_t j = 0; j < field.grid().size.y; ++j)
      for (std::int64_t i = 0; i < field.grid().size.x; ++i) values.push_back(field.value(i, j, k));
  return values;
}

TEST(FieldSlices, AreThoseOfTheField) {
  const TempFolder folder;
  const DistanceField field = odd_field(kGrid, 90'000.5);
  write_field(folder / "packed.vti", field, {.compress = true});
  write_field(folder / "plain.vti", field, {.compress = false});
  write_field(folder / "a.zarr", field);
  for (const char* const name : {"packed.vti", "plain.vti", "a.zarr"}) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(FieldSlices::can_open(folder / name));
    const DistanceField whole = read_field(folder / name);
    const FieldSlices slices = FieldSlices::open(folder / name);
    EXPECT_EQ(slices.grid(), whole.grid());
    EXPECT_EQ(slices.thickness(), whole.thickness());
    EXPECT_FALSE(slices.has_nearest());
    EXPECT_TRUE(slices.sidecars().empty());
    for (const auto& [first, count] :
         std::vector<std::pair<std::int64_t, std::int64_t>>{{0, 70}, {0, 1}, {69, 1}, {13, 29}, {32, 8}}) {
      const DistanceField part = slices.read(first, count);
      EXPECT_EQ(part.grid(), whole.grid().window({0, 0, first}, {90, 60, count}));
      EXPECT_EQ(part.provenance().mesh_hash, whole.provenance().mesh_hash);
      EXPECT_EQ(values_of(part, 0, count), values_of(whole, first, count)) << first << " " << count;
    }
    // As slabs they make the file that the whole makes.
    for (const std::int64_t samples : {std::int64_t{1}, kSlabSamples}) {
      write_field(folder / "again.vti", *slices.slabs({}, samples));
      EXPECT_EQ(read_bytes(folder / "again.vti") == read_bytes(folder / "packed.vti"), name[0] == 'p') << samples;
    }
    EXPECT_EQ(slices.reader()(5, 2).grid().size.z, 2);
    for (const auto& [first, count] :
         std::vector<std::pair<std::int64_t, std::int64_t>>{{-1, 1}, {0, 0}, {70, 1}, {60, 11}})
      expect_error([&] { slices.read(first, count); }, ErrorCode::usage, "ask for a part of it");
    expect_error([&] { slices.slabs({}, 0); }, ErrorCode::usage, "slabs without samples");
  }
}

TEST(FieldSlices, OthersAreNotOpened) {
  const TempFolder folder;
  write_field(folder / "a.npz", odd_field(kGrid, 90'000.5));
  EXPECT_FALSE(FieldSlices::can_open(folder / "a.npz"));
  EXPECT_FALSE(FieldSlices::can_open(folder / "none"));
  expect_error([&] { FieldSlices::open(folder / "a.npz"); }, ErrorCode::usage, "no slices are read alone; convert it");
  expect_error([&] { FieldSlices::open(folder / "none.vti"); }, ErrorCode::input, "none.vti: no such file");
  write_bytes(folder / "bad.vti", "x");
  expect_error([&] { FieldSlices::open(folder / "bad.vti"); }, ErrorCode::input, "bad.vti");
}

}  // namespace
}  // namespace standoff
