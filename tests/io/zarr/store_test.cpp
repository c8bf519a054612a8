// SPDX-License-Identifier: Apache-2.0
// Zarr stores, window by window: what is written in any order is the whole, parts are what the whole has there, and
// what would tear a shard is refused.
// labels: memory threads
#include "standoff/zarr.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "standoff/io.h"
#include "tests/io/field/odd_field.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// Small shards, so that a small field has many: 3 x 2 x 2 of the ball's.
constexpr ZarrLayout kSmall{.shard = {24, 32, 32}, .chunk = {8, 16, 32}};
ZarrLayout small(bool nearest) {
  ZarrLayout layout = kSmall;
  layout.nearest = nearest;
  return layout;
}

// The part of a field as a field of its own, made sample by sample.
DistanceField part_of(const DistanceField& field, const Size3& first, const Size3& size) {
  const Grid grid = field.grid().window(first, size);
  std::vector<float> values;
  std::vector<std::uint32_t> nearest;
  for (std::int64_t k = first.z; k < first.z + size.z; ++k)
    for (std::int64_t j = first.y; j < first.y + size.y; ++j)
      for (std::int64_t i = first.x; i < first.x + size.x; ++i) {
        values.push_back(field.value(i, j, k));
        if (field.has_nearest()) nearest.push_back(field.nearest(i, j, k));
      }
  DistanceField part = DistanceField::from_dense(grid, field.thickness(), values, nearest);
  part.set_provenance(field.provenance());
  return part;
}

std::vector<std::uint32_t> nearest_of(const DistanceField& field) {
  std::vector<std::uint32_t> nearest(static_cast<std::size_t>(field.grid().sample_count()));
  field.copy_nearest_slices(0, field.grid().size.z, nearest);
  return nearest;
}

// The same samples, and the same tiles stored or not.
void expect_same(const DistanceField& found, const DistanceField& wanted) {
  EXPECT_EQ(found.grid(), wanted.grid());
  EXPECT_EQ(found.thickness(), wanted.thickness());
  EXPECT_EQ(found.provenance().method, wanted.provenance().method);
  EXPECT_TRUE(found.to_dense() == wanted.to_dense());
  ASSERT_EQ(found.has_nearest(), wanted.has_nearest());
  if (wanted.has_nearest()) {
    EXPECT_TRUE(nearest_of(found) == nearest_of(wanted));
  }
  EXPECT_TRUE(std::ranges::equal(
      found.slots(), wanted.slots(), {}, [](std::int32_t slot) { return std::min(slot, 0); },
      [](std::int32_t slot) { return std::min(slot, 0); }));
}

ZarrStore store_for(const std::filesystem::path& path, const DistanceField& field, const ZarrLayout& layout) {
  return ZarrStore::create(path, field.grid(), field.thickness(), field.provenance(), layout);
}

// The windows of one shard each.
std::vector<std::pair<Size3, Size3>> windows_of(const Grid& grid, const Size3& shard) {
  std::vector<std::pair<Size3, Size3>> windows;
  for (std::int64_t z = 0; z < grid.size.z; z += shard.z)
    for (std::int64_t y = 0; y < grid.size.y; y += shard.y)
      for (std::int64_t x = 0; x < grid.size.x; x += shard.x)
        windows.push_back({{x, y, z},
                           {std::min(shard.x, grid.size.x - x), std::min(shard.y, grid.size.y - y),
                            std::min(shard.z, grid.size.z - z)}});
  return windows;
}

DistanceField ball(bool nearest) {
  DistanceField field = ball_field(nearest);
  field.set_provenance({"tiles", 7, "1.2.3", "winding"});
  return field;
}

TEST(ZarrStore, WindowsInAnyOrderAreTheWhole) {
  std::mt19937 random(5);
  for (const bool nearest : {false, true})
    for (const bool compress : {false, true}) {
      const TempFolder folder;
      const DistanceField field = ball(nearest);
      ZarrLayout layout = small(nearest);
      layout.compress = compress;
      const ZarrStore whole = store_for(folder / "whole.zarr", field, layout);
      whole.write({}, field);
      const ZarrStore parts = store_for(folder / "parts.zarr", field, layout);
      auto windows = windows_of(field.grid(), layout.shard);
      ASSERT_EQ(windows.size(), 12u);
      std::ranges::shuffle(windows, random);
      for (const auto& [first, size] : windows) parts.write(first, part_of(field, first, size));
      EXPECT_TRUE(read_bytes(folder / "parts.zarr") == read_bytes(folder / "whole.zarr"));
      expect_same(parts.read(), field);
      expect_same(ZarrStore::open(folder / "parts.zarr").read(), field);
    }
}

// A window may also have an origin of its own, as from a file that keeps no more; and a window of a larger grid that is
// written as a store of its own is whole there.
TEST(ZarrStore, WindowsAreKnownByWhereTheyAre) {
  const TempFolder folder;
  const DistanceField field = ball(false);
  const ZarrStore store = store_for(folder / "a.zarr", field, kSmall);
  const DistanceField window = part_of(field, {24, 32, 0}, {24, 11, 32});
  const Grid moved{window.grid().size, window.grid().corner(), window.grid().spacing};
  store.write({24, 32, 0}, DistanceField::from_dense(moved, 2, window.to_dense()));
  expect_same(store.read({24, 32, 0}, {24, 11, 32}), window);
  write_field(folder / "b.zarr", window);
  EXPECT_EQ(read_field(folder / "b.zarr").grid(), moved);
  EXPECT_TRUE(read_field(folder / "b.zarr").to_dense() == window.to_dense());
}

// As many processes do, each with a store of its own.
TEST(ZarrStore, WindowsOfManyWritersAtOnce) {
  const TempFolder folder;
  const DistanceField field = ball(true);
  store_for(folder / "a.zarr", field, small(true));
  const auto windows = windows_of(field.grid(), kSmall.shard);
  std::vector<std::thread> writers;
  for (std::size_t writer = 0; writer < 3; ++writer)
    writers.emplace_back([&, writer] {
      const ZarrStore store = ZarrStore::open(folder / "a.zarr");
      for (std::size_t n = writer; n < windows.size(); n += 3)
        store.write(windows[n].first, part_of(field, windows[n].first, windows[n].second), {.threads = 2});
    });
  for (std::thread& writer : writers) writer.join();
  expect_same(ZarrStore::open(folder / "a.zarr").read(), field);
}

TEST(ZarrStore, WholeFieldsHaveTheFilesOfWindows) {
  for (const bool nearest : {false, true}) {
    const TempFolder folder;
    const DistanceField field = odd_field({{150, 9, 200}, {1, 2, 3}, {1, 2, 3}}, 90'000.5, nearest);
    store_for(folder / "windows.zarr", field, {.nearest = nearest}).write({}, field);
    write_field(folder / "whole.zarr", field);
    EXPECT_TRUE(read_bytes(folder / "windows.zarr") == read_bytes(folder / "whole.zarr"));
  }
}

TEST(ZarrStore, PartsAreWhatTheWholeHasThere) {
  const TempFolder folder;
  for (const bool nearest : {false, true}) {
    const DistanceField field = ball(nearest);
    const ZarrStore store = store_for(folder / (nearest ? "nearest.zarr" : "a.zarr"), field, small(nearest));
    store.write({}, field);
    const Size3 all = field.grid().size;
    std::vector<std::pair<Size3, Size3>> parts{{{}, all},
                                               {{8, 16, 0}, {16, 16, 32}},
                                               {{0, 0, 22}, {61, 43, 1}},
                                               {{20, 0, 0}, {1, 43, 45}},
                                               {{60, 42, 44}, {1, 1, 1}},
                                               {{3, 5, 7}, {50, 30, 30}}};
    std::mt19937 random(3);
    for (int n = 0; n < 20; ++n) {
      Size3 first, size;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        first[axis] = static_cast<std::int64_t>(random()) % all[axis];
        size[axis] = 1 + static_cast<std::int64_t>(random()) % (all[axis] - first[axis]);
      }
      parts.push_back({first, size});
    }
    for (const auto& [first, size] : parts) {
      SCOPED_TRACE(std::to_string(first.x) + "," + std::to_string(first.y) + "," + std::to_string(first.z));
      expect_same(store.read(first, size), part_of(field, first, size));
    }
  }
}

TEST(ZarrStore, GridsOfAnyShape) {
  const TempFolder folder;
  int n = 0;
  for (const Size3 size : {Size3{1, 1, 1}, {1, 1, 40}, {65, 1, 3}, {8, 8, 8}, {128, 33, 1}, {129, 31, 40}})
    for (const double thickness : {kInfinite, 300.5}) {
      const DistanceField field = odd_field({size, {1, 2, 3}, {1, 2, 3}}, thickness);
      const ZarrStore store = store_for(folder / (std::to_string(n++) + ".zarr"), field, {});
      store.write({}, field);
      expect_same(store.read(), part_of(field, {}, size));
    }
}

// What zarr-python and TensorStore wrote; python/tests/zarr_test.py asks them for more.
TEST(ZarrStore, OfOthersIsRead) {
  const std::filesystem::path corpus = std::filesystem::path(kSourceFolder) / "tests" / "corpus" / "zarr";
  const DistanceField field = odd_field(odd_grid(), 4200.5);
  expect_same(read_field(corpus / "zarr_python.zarr"), field);
  EXPECT_EQ(ZarrStore::open(corpus / "zarr_python.zarr").provenance().mesh_hash, field.provenance().mesh_hash);
  // No attributes of ours, chunks that are no tiles, z fastest, an index at the beginning.
  const ZarrStore other = ZarrStore::open(corpus / "tensorstore.zarr");
  EXPECT_EQ(other.grid(), field.grid());
  EXPECT_EQ(other.thickness(), kInfinite);
  EXPECT_EQ(other.shard(), (Size3{5, 18, 20}));
  EXPECT_TRUE(other.read().to_dense() == field.to_dense());
  EXPECT_TRUE(other.read({3, 4, 5}, {7, 5, 9}).to_dense() == part_of(field, {3, 4, 5}, {7, 5, 9}).to_dense());
  expect_error([&] { other.write({}, field); }, ErrorCode::usage, "not laid out as standoff writes stores");
  // The array alone.
  EXPECT_TRUE(ZarrStore::open(corpus / "zarr_python.zarr" / "0").read().to_dense() == field.to_dense());
}

// Files of the array of distances.
std::size_t shards_in(const std::filesystem::path& store) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(store / "0"))
    files += entry.is_regular_file() && entry.path().filename() != "zarr.json";
  return files;
}

TEST(ZarrStore, WhatIsAllOutsideHasNoFile) {
  const TempFolder folder;
  const auto path = folder / "a.zarr";
  const DistanceField field = ball(false);
  const ZarrStore store = store_for(path, field, kSmall);
  EXPECT_EQ(shards_in(path), 0u);
  EXPECT_TRUE(store.read().to_dense() == DistanceField(field.grid(), 2).to_dense());
  EXPECT_EQ(store.read().stored_tiles(), 0);
  store.write({}, field);
  const std::size_t shards = shards_in(path);
  EXPECT_GT(shards, 4u);
  EXPECT_LT(shards, 12u);
  // What was there before goes away.
  store.write({}, DistanceField(field.grid(), 2));
  EXPECT_EQ(shards_in(path), 0u);
}

TEST(ZarrStore, KnowsItsMetadata) {
  const TempFolder folder;
  const DistanceField field = ball(true);
  store_for(folder / "a.zarr", field, small(true));
  const ZarrStore store = ZarrStore::open(folder / "a.zarr");
  EXPECT_EQ(store.grid(), field.grid());
  EXPECT_EQ(store.thickness(), 2);
  EXPECT_EQ(store.provenance().sign, "winding");
  EXPECT_EQ(store.provenance().mesh_hash, 7u);
  EXPECT_TRUE(store.has_nearest());
  EXPECT_EQ(store.shard(), kSmall.shard);
  EXPECT_EQ(store.chunk(), kSmall.chunk);
  EXPECT_EQ(store.path(), folder / "a.zarr");
}

TEST(ZarrStore, WindowsThatShareAShardAreRefused) {
  const TempFolder folder;
  const DistanceField field = ball(false);
  const ZarrStore store = store_for(folder / "a.zarr", field, kSmall);
  const auto refused = [&](const Size3& first, const Size3& size, const std::string& words) {
    expect_error([&] { store.write(first, part_of(field, first, size)); }, ErrorCode::usage, words);
  };
  refused({8, 0, 0}, {16, 32, 32},
          "along x the window is from sample 8 to 24, and would write a part of a shard, of 24");
  refused({0, 0, 0}, {24, 16, 32}, "along y the window is from sample 0 to 16");
  refused({0, 0, 0}, {24, 32, 44}, "along z the window is from sample 0 to 44");
  refused({24, 32, 32}, {24, 11, 12}, "along z the window is from sample 32 to 44");
  store.write({24, 32, 32}, part_of(field, {24, 32, 32}, {24, 11, 13}));  // ends with the grid
  const auto refuse = [&](const Size3& first, const DistanceField& window, const std::string& words) {
    expect_error([&] { store.write(first, window); }, ErrorCode::usage, words);
  };
  const DistanceField window = part_of(field, {}, {24, 32, 32});
  refuse({-24, 0, 0}, window, "is not within the grid's 61");
  refuse({48, 0, 0}, window, "along x the window from sample 48 on, of 24 samples, is not within the grid's 61");
  refuse({24, 0, 0}, window, "the window's origin is not at sample (24,0,0)");
  refuse({}, DistanceField({{24, 32, 32}, field.grid().origin, {1, 1, 2}}, 2), "spacing is not that of the store");
  refuse({}, DistanceField({{24, 32, 32}, field.grid().origin, {1, 1, 1}}, 3), "thickness is not that of the store");
  refuse({}, part_of(ball(true), {}, {24, 32, 32}), "has nearest triangles, and the store has none");
  expect_error([&] { store.write({}, window, {.threads = -1}); }, ErrorCode::usage, "threads must be zero or more");
  expect_error([&] { store.write({}, {}); }, ErrorCode::usage, "would write a part of a shard");
}

TEST(ZarrStore, PartsBeyondTheGridAreRefused) {
  const TempFolder folder;
  const DistanceField field = ball(false);
  const ZarrStore store = store_for(folder / "a.zarr", field, kSmall);
  constexpr std::int64_t kHuge = std::numeric_limits<std::int64_t>::max();
  for (const auto& [first, size] : std::vector<std::pair<Size3, Size3>>{{{-1, 0, 0}, {1, 1, 1}},
                                                                        {{61, 0, 0}, {1, 1, 1}},
                                                                        {{0, 43, 0}, {1, 1, 1}},
                                                                        {{0, 0, 40}, {1, 1, 6}},
                                                                        {{0, 0, 0}, {0, 1, 1}},
                                                                        {{0, 0, 0}, {1, 1, -1}},
                                                                        {{1, 0, 0}, {kHuge, 1, 1}},
                                                                        {{kHuge, 0, 0}, {kHuge, 1, 1}}})
    expect_error([&] { store.read(first, size); }, ErrorCode::usage, "are not within the ");
}

TEST(ZarrStore, LayoutsThatCannotBeAreRefused) {
  const TempFolder folder;
  const Grid grid = ball_grid();
  const auto refused = [&](ZarrLayout layout, const std::string& words) {
    expect_error([&] { ZarrStore::create(folder / "a.zarr", grid, 2, {}, layout); }, ErrorCode::usage, words);
  };
  refused({.chunk = {12, 32, 32}}, "a chunk of 12 samples; give a multiple of 8");
  refused({.chunk = {0, 32, 32}}, "a chunk of 0 samples");
  refused({.shard = {128, 80, 128}}, "a shard of 80 samples; give a multiple of the chunk's 32");
  refused({.shard = {128, 128, 16}}, "a shard of 16 samples");
  refused({.shard = {512, 512, 512}, .chunk = {512, 512, 512}}, "a chunk has more than 2^24 samples");
  refused({.shard = {1 << 20, 1 << 20, 1 << 20}}, "a shard has more than 2^20 chunks");
  expect_error([&] { ZarrStore::create(folder / "a.zarr", {{0, 1, 1}, {}}, 2); }, ErrorCode::usage, "grid");
  expect_error([&] { ZarrStore::create(folder / "a.zarr", grid, 0); }, ErrorCode::usage, "the thickness must be");
  expect_error([&] { ZarrStore::create(folder / "no/a.zarr", grid, 1); }, ErrorCode::output, "does not exist; create");
  EXPECT_TRUE(folder.names().empty());
}

// All files of a folder, by name.
std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[entry.path().lexically_relative(folder).string()] = read_bytes(entry.path());
  return files;
}

void expect_levels(const ZarrStore& store, const DistanceField& field, int levels) {
  ASSERT_EQ(store.levels(), levels);
  for (int number = 0; number < levels; ++number) {
    SCOPED_TRACE(number);
    const DistanceField level = store.level(number).read();
    const std::int64_t step = std::int64_t{1} << number;
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_EQ(level.grid().size[axis], (field.grid().size[axis] + step - 1) / step);
    const Size3 size = level.grid().size;
    for (std::int64_t k = 0; k < size.z; ++k)
      for (std::int64_t j = 0; j < size.y; ++j)
        for (std::int64_t i = 0; i < size.x; ++i) {
          ASSERT_EQ(level.value(i, j, k), field.value(step * i, step * j, step * k));
          ASSERT_EQ(level.grid().position(i, j, k), field.grid().position(step * i, step * j, step * k));
        }
    EXPECT_EQ(level.provenance().sign, field.provenance().sign);
    EXPECT_EQ(level.thickness(), field.thickness());
  }
}

// A level has the values that the field has at its samples, and the same bytes however it was written.
TEST(ZarrStore, LevelsAreEverySecondSample) {
  const TempFolder folder;
  const DistanceField field = ball(true);
  ZarrLayout layout = small(true);
  const Size3 shard = layout.shard;
  const ZarrStore whole = store_for(folder / "a.zarr", field, layout);
  whole.write({}, field);
  expect_levels(whole.write_levels(4, {.threads = 1}), field, 4);
  EXPECT_FALSE(ZarrStore::open(folder / "a.zarr").level(1).has_nearest());
  EXPECT_TRUE(ZarrStore::open(folder / "a.zarr").has_nearest());

  // By parts, in another order, one of them twice; read before the end there are none.
  const ZarrStore parts = store_for(folder / "b.zarr", field, layout);
  parts.write({}, field);
  parts.begin_levels(4);
  for (int number = 1; number < 4; ++number) {
    Size3 size = field.grid().size;
    for (int n = 0; n < number; ++n) size = {(size.x + 1) / 2, (size.y + 1) / 2, (size.z + 1) / 2};
    for (std::int64_t z = (size.z - 1) / shard.z; z >= 0; --z)
      for (std::int64_t y = 0; y < size.y; y += shard.y)
        for (std::int64_t x = 0; x < size.x; x += shard.x) {
          const Size3 first{x, y, z * shard.z};
          const Size3 part{std::min(shard.x, size.x - x), std::min(shard.y, size.y - y),
                           std::min(shard.z, size.z - first.z)};
          parts.write_level(number, first, part);
          if (x == 0) parts.write_level(number, first, part);
        }
  }
  EXPECT_EQ(ZarrStore::open(folder / "b.zarr").levels(), 1);
  parts.end_levels(4);
  EXPECT_EQ(files_of(folder / "b.zarr"), files_of(folder / "a.zarr"));

  // write_field makes them, too; and a store with them is replaced.
  for (int turn = 0; turn < 2; ++turn) {
    write_field(folder / "c.zarr", field, {.levels = 3});
    expect_levels(ZarrStore::open(folder / "c.zarr"), field, 3);
  }
  // Other samples: the levels are no longer its levels, also where the writer does not know of them. What is refused
  // changes nothing.
  EXPECT_EQ(parts.levels(), 1);
  expect_error([&] { parts.write({1, 0, 0}, field); }, ErrorCode::usage, "is not within the grid");
  EXPECT_EQ(ZarrStore::open(folder / "b.zarr").levels(), 4);
  parts.write({}, field);
  EXPECT_EQ(ZarrStore::open(folder / "b.zarr").levels(), 1);
}

// Whose metadata would be lost.
TEST(ZarrStore, LevelsOfOthersStay) {
  const TempFolder folder;
  const DistanceField field = odd_field({{20, 3, 9}, {}, {1, 1, 1}}, 9);
  store_for(folder / "a.zarr", field, {}).write({}, field);
  std::string group = read_bytes(folder / "a.zarr/zarr.json");
  group.replace(group.find("\"standoff\""), 10, "\"somebody\"");
  write_bytes(folder / "a.zarr/zarr.json", group);
  const ZarrStore store = ZarrStore::open(folder / "a.zarr");
  expect_error([&] { store.write_levels(2); }, ErrorCode::usage, "of a store that standoff wrote");
  store.write({}, field);
  EXPECT_EQ(read_bytes(folder / "a.zarr/zarr.json"), group);
}

TEST(ZarrStore, LevelsThatThereAreNot) {
  const TempFolder folder;
  const DistanceField field = odd_field({{5, 3, 1}, {}, {1, 1, 1}}, 9);
  const ZarrStore store = store_for(folder / "a.zarr", field, {});
  store.write({}, field);
  expect_error([&] { store.level(1); }, ErrorCode::usage, "there is no level 1; it has level 0 alone");
  expect_error([&] { store.write_levels(5); }, ErrorCode::usage, "5 levels; of this grid give 1 to 4");
  expect_error([&] { store.write_levels(0); }, ErrorCode::usage, "of this grid give 1 to 4");
  const ZarrStore levels = store.write_levels(4);
  EXPECT_EQ(levels.level(3).grid().size, (Size3{1, 1, 1}));
  expect_error([&] { levels.level(-1); }, ErrorCode::usage, "it has levels 0 to 3");
  expect_error([&] { levels.level(1).write_levels(2); }, ErrorCode::usage, "levels are made of level 0");
  expect_error([&] { store.write_level(0, {}, {5, 3, 1}); }, ErrorCode::usage, "level 0 is written by write()");
  expect_error([&] { store.write_level(1, {1, 0, 0}, {2, 2, 1}); }, ErrorCode::usage, "give whole shards");
  expect_error([&] { write_field(folder / "a.vti", field, {.levels = 2}); }, ErrorCode::usage, ".vti has no levels");
}

TEST(ZarrStore, ReplacesStoresOfOursAlone) {
  const TempFolder folder;
  const DistanceField field = ball(false);
  const auto path = folder / "a.zarr";
  store_for(path, field, kSmall);
  expect_error([&] { store_for(path, field, kSmall); }, ErrorCode::output, "somebody has written it");
  expect_error([&] { write_field(path, field, Existing::keep); }, ErrorCode::output, "somebody has written it");
  ZarrStore::create(path, {{3, 3, 3}, {}}, 1, {}, {}, Existing::replace);
  EXPECT_EQ(ZarrStore::open(path).grid().size, (Size3{3, 3, 3}));
  write_field(folder / "a.zarr/", field);  // with a slash, as shells complete it
  expect_same(read_field(path / ""), field);
  // What somebody else has put there is not removed with it.
  for (const char* const name : {"notes.txt", "0/notes.txt", "0/c/notes.txt", "0/c/0/0/0.bak", "1/zarr.json"}) {
    std::filesystem::create_directories((path / name).parent_path());
    write_bytes(path / name, "mine");
    expect_error([&] { write_field(path, field); }, ErrorCode::output, "not a Zarr store of standoff");
    EXPECT_EQ(read_bytes(path / name), "mine");
    std::filesystem::remove(path / name);
    std::filesystem::remove(path / "1");
  }
  write_bytes(path / "0/c/.standoff-1-2-3.part", "of a writer that was killed");
  write_field(path, field);
  std::filesystem::remove(path / "zarr.json");
  expect_error([&] { write_field(path, field); }, ErrorCode::output,
               "a folder is there that is not a Zarr store of standoff");
  EXPECT_TRUE(std::filesystem::exists(path / "0" / "zarr.json"));
  std::filesystem::create_directory(folder / "empty.zarr");
  write_field(folder / "empty.zarr", field);
  write_bytes(folder / "file.zarr", "mine");
  expect_error([&] { write_field(folder / "file.zarr", field); }, ErrorCode::output, "it is a file");
  EXPECT_EQ(folder.names(), (std::set<std::string>{"a.zarr", "empty.zarr", "file.zarr"}));
}

TEST(ZarrStore, AsksForNoMoreMemoryThanAllowed) {
  const TempFolder folder;
  const DistanceField field = ball(false);
  const ZarrStore store = store_for(folder / "a.zarr", field, kSmall);
  store.write({}, field);
  expect_error([&] { store.read({.memory_limit = 1000}); }, ErrorCode::limit, "a.zarr: its tiles need more than");
  expect_error([&] { store.read({.memory_limit = 300'000}); }, ErrorCode::limit, "a.zarr: its tiles need more than");
  EXPECT_NO_THROW(store.read({.memory_limit = std::int64_t{1} << 30}));
}

TEST(ZarrStore, CanBeStopped) {
  const TempFolder folder;
  const DistanceField field = ball(false);
  const ZarrStore store = store_for(folder / "a.zarr", field, kSmall);
  const auto stop = [](const Progress&) { return false; };
  expect_error([&] { store.write({}, field, {.progress = stop}); }, ErrorCode::interrupted, "cancelled");
  expect_error([&] { store.read({.progress = stop}); }, ErrorCode::interrupted, "cancelled");
  store.write({}, field);
  expect_same(store.read(), field);
}

}  // namespace
}  // namespace standoff
