// SPDX-License-Identifier: Apache-2.0
// Our .nvdb files read by NanoVDB, and its own read by us.
#include <gtest/gtest.h>

#if __has_include(<nanovdb/NanoVDB.h>)
#define NANOVDB_USE_ZIP 1
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>
#include <nanovdb/util/Primitives.h>

#include "odd_field.h"
#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

void expect_read(const DistanceField& field, nanovdb::GridClass grid_class) {
  const TempFolder folder;
  write_field(folder / "a.nvdb", field);
  const auto handle = nanovdb::io::readGrid((folder / "a.nvdb").string(), std::string("distance"));
  const auto* const grid = handle.grid<float>();
  ASSERT_NE(grid, nullptr);
  EXPECT_EQ(nanovdb::GridValidator<float>::check(*grid, true), "");
  EXPECT_EQ(grid->gridClass(), grid_class);
  const Grid& wanted = field.grid();
  const nanovdb::Vec3d last = grid->indexToWorld(nanovdb::Vec3d(1, 2, 3));
  const Vec3 position = wanted.position(1, 2, 3);
  EXPECT_EQ((Vec3{last[0], last[1], last[2]}), position);
  auto accessor = grid->getAccessor();
  std::int64_t wrong = 0, active = 0;
  for (std::int64_t k = 0; k < wanted.size.z; ++k)
    for (std::int64_t j = 0; j < wanted.size.y; ++j)
      for (std::int64_t i = 0; i < wanted.size.x; ++i) {
        const nanovdb::Coord at(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
        const float value = field.value(i, j, k);
        const bool in_band = std::abs(value) < static_cast<float>(field.thickness());
        wrong += accessor.getValue(at) != value || accessor.isActive(at) != in_band;
        active += in_band;
      }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(static_cast<std::int64_t>(grid->activeVoxelCount()), active);
}

TEST(NanoVdb, ReadsOurFiles) {
  expect_read(odd_field(), nanovdb::GridClass::Unknown);
  expect_read(odd_field(odd_grid(), 4200.5), nanovdb::GridClass::Unknown);
  expect_read(ball_field(), nanovdb::GridClass::LevelSet);
}

TEST(NanoVdb, IsReadPackedOrNot) {
  const TempFolder folder;
  const auto path = folder / "a.nvdb";
  auto handle = nanovdb::createLevelSetSphere<float>(20.25f, nanovdb::Vec3<float>(1, 2, -30), 0.5, 3);
  for (const auto codec : {nanovdb::io::Codec::NONE, nanovdb::io::Codec::ZIP}) {
    nanovdb::io::writeGrid(path.string(), handle, codec);
    const DistanceField field = read_field(path);
    EXPECT_EQ(field.thickness(), 1.5);
    EXPECT_EQ(field.grid().spacing, (Vec3{0.5, 0.5, 0.5}));
    const Size3 n = field.grid().size;
    std::int64_t wrong = 0;
    for (std::int64_t k = 0; k < n.z; ++k)
      for (std::int64_t j = 0; j < n.y; ++j)
        for (std::int64_t i = 0; i < n.x; ++i) {
          const double distance = length(field.grid().position(i, j, k) - Vec3{1, 2, -30}) - 20.25;
          wrong += std::abs(field.value(i, j, k) - std::clamp(distance, -1.5, 1.5)) > 1e-5;
        }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(std::ranges::count(field.slots(), DistanceField::kInside), 100);
  }
}

TEST(NanoVdb, OtherKindsOfGridsAreRefused) {
  const TempFolder folder;
  const auto path = folder / "a.nvdb";
  auto handle = nanovdb::createLevelSetSphere<double>(20.25, nanovdb::Vec3d(1, 2, -30), 0.5, 3);
  nanovdb::io::writeGrid(path.string(), handle);
  expect_error([&] { read_field(path); }, ErrorCode::input, "it holds no grid of floats, but 'sphere_ls'; save one");
}

}  // namespace
}  // namespace standoff
#else
TEST(NanoVdb, IsMissing) { GTEST_SKIP() << "NanoVDB is missing (script/bootstrap test; Debian: libnanovdb-dev)"; }
#endif
