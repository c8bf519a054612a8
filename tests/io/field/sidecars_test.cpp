// SPDX-License-Identifier: Apache-2.0
// labels: memory
// Not threads: files are packed by a tbb::parallel_pipeline, which the thread sanitizer's stand-in does not have.
// Arrays beside a field: written, read back by us and by others, and refused where they do not fit.
#include <gtest/gtest.h>

#include <cstdlib>

#include "odd_field.h"
#include "standoff/io.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// What foreign.py expects too, at stored samples of the grid.
std::vector<Sidecar> sidecars_of(const DistanceField& field) {
  std::vector<float> points(field.tile_values().size() * 3);
  std::vector<std::uint8_t> features(field.tile_values().size());
  const Size3 size = field.grid().size;
  for (const DistanceField::Tile& tile : field.tiles()) {
    const auto slot = static_cast<std::size_t>(field.slots()[static_cast<std::size_t>(tile.index)]);
    for (std::size_t n = 0; n < 512; ++n) {
      const std::int64_t i = 8 * tile.at.x + static_cast<std::int64_t>(n % 8),
                         j = 8 * tile.at.y + static_cast<std::int64_t>(n / 8 % 8),
                         k = 8 * tile.at.z + static_cast<std::int64_t>(n / 64);
      if (i >= size.x || j >= size.y || k >= size.z) continue;
      float* const point = points.data() + 3 * (512 * slot + n);
      point[0] = static_cast<float>(i) + 0.5f;
      point[1] = 100 * static_cast<float>(j);
      point[2] = static_cast<float>(k);
      features[512 * slot + n] = static_cast<std::uint8_t>((i + j + k) % 7);
    }
  }
  return {{"closest_point", 3, points}, {"feature", 1, features}};
}

DistanceField band() { return odd_field(odd_grid(), 4200.5); }

// Slots of two fields may differ.
void expect_same(const FieldFile& read, const DistanceField& field, const std::vector<Sidecar>& wanted) {
  EXPECT_TRUE(read.field.to_dense() == field.to_dense());
  ASSERT_EQ(read.field.stored_tiles(), field.stored_tiles());
  ASSERT_EQ(read.sidecars.size(), wanted.size());
  const std::vector<Sidecar> found = sidecars_of(read.field);
  for (std::size_t n = 0; n < wanted.size(); ++n) {
    EXPECT_EQ(read.sidecars[n].name, wanted[n].name);
    EXPECT_EQ(read.sidecars[n].components, wanted[n].components);
    EXPECT_TRUE(read.sidecars[n].values == found[n].values) << wanted[n].name;
  }
}

class Sidecars : public ::testing::TestWithParam<FileFormat> {};
INSTANTIATE_TEST_SUITE_P(AllFormats, Sidecars, ::testing::ValuesIn(field_formats()),
                         [](const auto& format) { return format.param.extension; });

TEST_P(Sidecars, AreKeptOrRefused) {
  const TempFolder folder;
  const auto path = folder / ("a." + GetParam().extension);
  const DistanceField field = band();
  const auto sidecars = sidecars_of(field);
  for (const bool compress : {true, false}) {
    if (!GetParam().sidecars) {
      expect_error([&] { write_field(path, field, {.compress = compress, .sidecars = sidecars}); }, ErrorCode::usage,
                   "cannot carry sidecars such as closest_point; write .vti or .npz, or leave them out");
      EXPECT_TRUE(folder.names().empty());
      continue;
    }
    write_field(path, field, {.compress = compress, .sidecars = sidecars});
    expect_same(read_field_file(path), field, sidecars);
    EXPECT_TRUE(read_field(path).to_dense() == field.to_dense());
    const std::string command =
        std::string(kPython) + " -B " + kSourceFolder + "/tests/io/field/foreign.py sidecars '" + path.string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
  }
}

TEST_P(Sidecars, FilesDoNotDependOnThreads) {
  const TempFolder folder;
  // Several blocks, the last one not whole.
  const DistanceField field = odd_field({{130, 90, 99}, {}, {1, 1, 1}}, 9000.5);
  const auto sidecars = sidecars_of(field);
  std::string first;
  for (const int threads : {1, 2, 5}) {
    const auto path = folder / ("a." + GetParam().extension);
    FieldWriteOptions options{.threads = threads};
    if (GetParam().sidecars) options.sidecars = sidecars;
    write_field(path, field, options);
    if (first.empty()) first = read_bytes(path);
    EXPECT_TRUE(read_bytes(path) == first);
  }
  const auto path = folder / ("a." + GetParam().extension);
  if (GetParam().sidecars) expect_same(read_field_file(path), field, sidecars);
  EXPECT_TRUE(read_field(path).to_dense() == field.to_dense());
}

TEST(SidecarErrors, WhatDoesNotFitIsRefused) {
  const TempFolder folder;
  const DistanceField field = band();
  const auto refused = [&](std::vector<Sidecar> sidecars, const char* words) {
    expect_error([&] { write_field(folder / "a.vti", field, {.sidecars = sidecars}); }, ErrorCode::usage, words);
    EXPECT_TRUE(folder.names().empty());
  };
  auto good = sidecars_of(field);
  const auto with = [&](auto change) {
    auto changed = good;
    change(changed[0]);
    return changed;
  };
  refused(with([](Sidecar& s) { s.name = ""; }), "its name is not made of letters, digits and underscores");
  refused(with([](Sidecar& s) { s.name = "a\"><b"; }), "its name is not made of letters, digits and underscores");
  refused(with([](Sidecar& s) { s.name = "distance"; }), "its name is taken");
  refused(with([](Sidecar& s) { s.name = "feature"; }), "its name is taken");
  refused(with([](Sidecar& s) { s.components = 0; }), "it has 0 numbers per sample; give 1 to 64");
  refused(with([](Sidecar& s) { s.components = 2; }), "numbers, where the field's stored tiles need");
  refused(with([](Sidecar& s) { s.values = std::vector<float>(); }), "it has 0 numbers, where");
  expect_error([&] { write_field(folder / "a.vti", field, {.threads = -1}); }, ErrorCode::usage, "threads must be");
}

TEST(SidecarErrors, TheMemoryLimitHoldsForAll) {
  const TempFolder folder;
  const auto path = folder / "a.npz";
  const DistanceField field = odd_field({{64, 64, 64}, {}, {1, 1, 1}});
  const auto sidecars = sidecars_of(field);
  write_field(path, field, {.sidecars = sidecars});
  const std::int64_t limit = std::int64_t{2} << 20;  // 1 MiB for the field, 3.25 MiB for sidecars
  EXPECT_NO_THROW(read_field(path, {.memory_limit = limit}));
  expect_error([&] { read_field_file(path, {.memory_limit = limit}); }, ErrorCode::limit,
               "its tiles and sidecars need ");
}

}  // namespace
}  // namespace standoff
