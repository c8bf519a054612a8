// SPDX-License-Identifier: Apache-2.0
// The levels of a store: each has every second sample of the one before, along each axis. So its values are exact
// distances at its samples; means of neighbours would be distances of nothing.
#include <algorithm>
#include <array>
#include <string>

#include "core/progress.h"
#include "core/tile_count.h"
#include "files/atomic_file.h"
#include "io/zarr/metadata.h"
#include "io/zarr/parts.h"
#include "io/zarr/windows.h"
#include "standoff/error.h"

namespace standoff::zarr {
namespace {

constexpr std::int64_t kHalf = kTileSide / 2;

// Every second sample of the stored tile `fine`, into the eighth of a tile that begins at `first`.
void thin(std::span<const float, kTileSamples> fine, const Size3& first, std::array<float, kTileSamples>& tile) {
  for (std::int64_t z = 0; z < kHalf; ++z)
    for (std::int64_t y = 0; y < kHalf; ++y)
      for (std::int64_t x = 0; x < kHalf; ++x)
        tile[static_cast<std::size_t>(first.x + x + kTileSide * (first.y + y + kTileSide * (first.z + z)))] =
            fine[static_cast<std::size_t>(2 * (x + kTileSide * (y + kTileSide * z)))];
}

// The field on `grid` of every second sample of `fine`, from its first one on.
DistanceField every_second(const DistanceField& fine, const Grid& grid) {
  DistanceField field(grid, fine.thickness());
  const Size3 tiles = field.tile_count(), fine_tiles = fine.tile_count();
  const auto far = static_cast<float>(fine.thickness());
  for (std::size_t n = 0; n < static_cast<std::size_t>(tiles.count()); ++n) {
    const Size3 at = part_at(n, tiles), begin = times(at, {2, 2, 2}), end = least(plus(begin, {2, 2, 2}), fine_tiles);
    std::array<float, kTileSamples> tile;
    tile.fill(far);
    bool any = false;
    const Size3 parts = minus(end, begin);
    for (std::size_t part = 0; part < static_cast<std::size_t>(parts.count()); ++part) {
      const Size3 from = plus(begin, part_at(part, parts)), place = times(part_at(part, parts), {kHalf, kHalf, kHalf});
      if (const auto stored = fine.tile(from.x, from.y, from.z)) {
        thin(*stored, place, tile);
      } else if (const float value = fine.background(from.x, from.y, from.z); value != far) {
        std::array<float, kTileSamples> inside;
        inside.fill(value);
        thin(inside, place, tile);
      } else {
        continue;
      }
      any = true;
    }
    if (any) std::ranges::copy(tile, field.store_tile(at.x, at.y, at.z).begin());
  }
  return field;
}

void put(const std::filesystem::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

}  // namespace

void check_levels(const StoreMetadata& store, int levels) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::usage, store.path.string() + ": " + what);
  };
  if (!store.own || store.distance.folder != store.path / kDistanceName)
    refuse("levels are made of level 0 of a store that standoff wrote; open that");
  int most = 1;
  for (Size3 size = store.grid.size; most < kMostLevels && std::max({size.x, size.y, size.z}) > 1; ++most)
    size = parts_of(size, Size3{2, 2, 2});
  if (levels < 1 || levels > most)
    refuse(std::to_string(levels) + " levels; of this grid give 1 to " + std::to_string(most));
}

void begin_levels(const StoreMetadata& store, int levels) {
  end_levels(store, 1);
  for (int number = 1; number < levels; ++number) {
    const StoreMetadata level = level_of(store, number);
    make_folder(level.distance.folder, level.distance.folder);
    put(level.distance.folder / kMetadataName, distance_text(level));
  }
}

void write_level(const StoreMetadata& store, int number, const Window& part, bool sync, int threads,
                 ProgressMeter& meter) {
  StoreMetadata fine = level_of(store, number - 1);
  fine.nearest.reset();
  const StoreMetadata level = level_of(store, number);
  const Window shards = parts_in(part, level.distance.shard);
  // Reading and writing have stages of their own, which are of no interest here; they can be stopped all the same.
  const ProgressCallback quiet = [&meter](const Progress&) { return meter.check(), true; };
  meter.stage("levels", shards.size().count(), 0, 1);
  for (std::size_t n = 0; n < static_cast<std::size_t>(shards.size().count()); ++n) {
    const Size3 first = times(plus(shards.first, part_at(n, shards.size())), level.distance.shard);
    const Size3 size = minus(least(plus(first, level.distance.shard), level.grid.size), first);
    const Size3 from = times(first, {2, 2, 2}), of = least(times(size, {2, 2, 2}), minus(fine.grid.size, from));
    ProgressMeter hidden(quiet);
    const DistanceField thinned = every_second(read_window(fine, from, of, 0, hidden), level.grid.window(first, size));
    write_window(level, first, thinned, sync, threads, hidden);
    meter.advance();
  }
}

void end_levels(const StoreMetadata& store, int levels) {
  StoreMetadata listed = store;
  listed.levels = levels;
  const std::filesystem::path group = store.path / kMetadataName;
  put(group, group_text(listed));
}

}  // namespace standoff::zarr
