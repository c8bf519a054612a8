// SPDX-License-Identifier: Apache-2.0
// Level sets of OpenVDB read by us, and trees at every level of which whole nodes are inside.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

void write_foreign(const std::filesystem::path& path, const std::string& kind) {
  const std::string command = std::string(kPython) + " -B " + kSourceFolder + "/tests/io/field/foreign.py write '" +
                              path.string() + "' '" + kind + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

DistanceField read_foreign(const std::string& kind) {
  const TempFolder folder;
  write_foreign(folder / "a.vdb", kind);
  return read_field(folder / "a.vdb");
}

// The distance to the ball of foreign.py.
void expect_ball(const DistanceField& field, double tolerance, Vec3 scale = {0.5, 0.5, 0.5}) {
  EXPECT_EQ(field.thickness(), 2);
  EXPECT_EQ(field.grid().spacing, scale);
  EXPECT_LT(field.stored_tiles(), field.tile_count().count() / 2);
  const Size3 n = field.grid().size;
  std::int64_t wrong = 0;
  for (std::int64_t k = 0; k < n.z; ++k)
    for (std::int64_t j = 0; j < n.y; ++j)
      for (std::int64_t i = 0; i < n.x; ++i) {
        const double distance = length(field.grid().position(i, j, k) - Vec3{3, -7, 100}) - 30.25;
        const double value = field.value(i, j, k), wanted = std::clamp(distance, -2.0, 2.0);
        if (std::abs(value - wanted) > tolerance) ++wrong;
      }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(std::ranges::count(field.slots(), DistanceField::kInside), 100);
}

TEST(OpenVdb, LevelSetsAreRead) {
  expect_ball(read_foreign("openvdb ball"), 1e-5);
  expect_ball(read_foreign("openvdb half"), 2e-3);
  expect_ball(read_foreign("openvdb named distance"), 1e-5);
}

TEST(OpenVdb, SpacingsMayDiffer) {
  const DistanceField field = read_foreign("openvdb anisotropic");
  EXPECT_EQ(field.grid().spacing, (Vec3{1, 2, 3}));
  const DistanceField plain = read_foreign("openvdb ball");
  EXPECT_TRUE(field.to_dense() == plain.to_dense());
}

TEST(OpenVdb, ActiveTilesAreSamples) {
  const DistanceField field = read_foreign("openvdb tiles");
  EXPECT_EQ(field.grid().size, (Size3{209, 149, 139}));
  EXPECT_EQ(field.grid().origin, (Vec3{-8, -8, -8}));
  EXPECT_EQ(field.value(0, 0, 0), 2);
  EXPECT_EQ(field.value(8, 8, 8), 1);
  EXPECT_EQ(field.value(208, 148, 138), 1);
  EXPECT_EQ(field.value(208, 0, 0), 5);
}

TEST(OpenVdb, WhatIsNotReadIsSaid) {
  const TempFolder folder;
  const auto refused = [&](const char* kind, const char* words) {
    write_foreign(folder / "a.vdb", kind);
    expect_error([&] { read_field(folder / "a.vdb"); }, ErrorCode::input, words);
  };
  refused("openvdb several",
          "it holds several grids: 'ball' (Tree_float_5_4_3), 'FloatGrid' (Tree_float_5_4_3), "
          "'Vec3SGrid' (Tree_vec3s_5_4_3); save one");
  refused("openvdb sheared", "the axes of the grid must be those of the world; resample it");
  refused("openvdb empty", "no sample of the grid is active");
}

class Trees : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, Trees, ::testing::Values("vdb", "nvdb"));

// Leaves, nodes of 128 and nodes of 4096 samples a side that are inside throughout; a little of each level is stored.
DistanceField mostly_inside(const Size3& size) {
  DistanceField field({size, {1, 2, 3}, {1, 0.5, 2}}, 0.75);
  const Size3 tiles = field.tile_count();
  for (std::int64_t z = 0; z < tiles.z; ++z)
    for (std::int64_t y = 0; y < tiles.y; ++y)
      for (std::int64_t x = 0; x < tiles.x; ++x) {
        if (x == tiles.x - 1 && y == 0 && z == 0) {
          const auto values = field.store_tile(x, y, z);
          std::ranges::fill(values, 0.75f);
          values[0] = -0.5f;
        } else if (x % 37 != 36) {
          field.mark_inside(x, y, z);
        }
      }
  return field;
}

TEST_P(Trees, KeepWhatIsInsideAtEveryLevel) {
  const TempFolder folder;
  const auto path = folder / (std::string("a.") + GetParam());
  for (const Size3& size : {Size3{300, 130, 257}, {8300, 9, 9}, {4096, 128, 16}}) {
    const DistanceField field = mostly_inside(size);
    write_field(path, field);
    const DistanceField read = read_field(path);
    EXPECT_EQ(read.grid(), field.grid());
    ASSERT_EQ(read.slots().size(), field.slots().size());
    EXPECT_TRUE(std::ranges::equal(read.slots(), field.slots()));
    EXPECT_EQ(read.value(size.x - 1 - (size.x - 1) % 8, 0, 0), -0.5f);
  }
}

}  // namespace
}  // namespace standoff
