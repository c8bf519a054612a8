// SPDX-License-Identifier: Apache-2.0
// Zarr stores as a format of fields: whole ones are read and written. Slabs are gathered until a layer of chunks is
// complete.
#include "io/field/format.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "core/progress.h"
#include "core/tile_count.h"
#include "files/atomic_folder.h"
#include "io/zarr/metadata.h"
#include "io/zarr/windows.h"

namespace standoff::zarr {
namespace {

// Some slices of a field, put together of slabs that end anywhere.
class LayerGatherer {
 public:
  LayerGatherer(const Grid& whole, double thickness, std::int64_t slices)
      : whole_(whole), thickness_(thickness), slices_(slices) {
    begin();
  }

  /// Takes slices of a slab from `first` on; returns how many.
  std::int64_t take(const DistanceField& slab, std::int64_t first) {
    const std::int64_t count = std::min(slab.grid().size.z - first, layer_.grid().size.z - filled_);
    for (std::int64_t slice = 0; slice < count;) {
      const std::int64_t from = first + slice, to = filled_ + slice;
      const bool whole_tiles = from % kTileSide == 0 && to % kTileSide == 0 && ends_tile(from, count - slice, slab) &&
                               ends_tile(to, count - slice, layer_);
      slice += whole_tiles ? take_tiles(slab, from, to) : take_slice(slab, from, to);
    }
    filled_ += count;
    return count;
  }
  bool full() const { return filled_ == layer_.grid().size.z; }
  const DistanceField& layer() const { return layer_; }
  /// Begins the next layer; false at the end of the grid.
  bool next() {
    done_ += filled_;
    return done_ < whole_.size.z && (begin(), true);
  }

 private:
  void begin() {
    Grid grid = whole_;
    grid.size.z = std::min(slices_, whole_.size.z - done_);
    layer_.reset(grid, thickness_);
    filled_ = 0;
  }
  static bool ends_tile(std::int64_t slice, std::int64_t count, const DistanceField& field) {
    return count >= kTileSide || slice + count == field.grid().size.z;
  }

  // A layer of tiles; returns how many slices of it there are.
  std::int64_t take_tiles(const DistanceField& slab, std::int64_t from, std::int64_t to) {
    const Size3 tiles = slab.tile_count();
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
        if (const auto values = slab.tile(tx, ty, from / kTileSide))
          std::ranges::copy(*values, layer_.store_tile(tx, ty, to / kTileSide).begin());
        else if (slab.background(tx, ty, from / kTileSide) < 0)
          layer_.mark_inside(tx, ty, to / kTileSide);
      }
    return std::min({std::int64_t{kTileSide}, slab.grid().size.z - from, layer_.grid().size.z - to});
  }

  // One slice, where the tiles of both do not begin at the same one. Tiles that are all outside are stored too: what
  // is written does not change by it.
  std::int64_t take_slice(const DistanceField& slab, std::int64_t from, std::int64_t to) {
    constexpr std::size_t kSlice = std::size_t{kTileSide} * kTileSide;
    const Size3 tiles = slab.tile_count();
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
        float* const slice = stored(tx, ty, to / kTileSide) + kSlice * static_cast<std::size_t>(to % kTileSide);
        const auto values = slab.tile(tx, ty, from / kTileSide);
        if (values)
          std::ranges::copy(values->subspan(kSlice * static_cast<std::size_t>(from % kTileSide), kSlice), slice);
        else
          std::fill_n(slice, kSlice, slab.background(tx, ty, from / kTileSide));
      }
    return 1;
  }
  float* stored(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
    if (layer_.tile(tx, ty, tz)) return layer_.edit_tile(tx, ty, tz).data();
    const auto values = layer_.store_tile(tx, ty, tz);
    std::ranges::fill(values, static_cast<float>(thickness_));
    return values.data();
  }

  const Grid& whole_;
  const double thickness_;
  const std::int64_t slices_;
  DistanceField layer_;
  std::int64_t done_ = 0, filled_ = 0;  // slices of the layers before, and of this one
};

void write_whole(const DistanceField& field, LayeredWriter& writer, ProgressMeter& meter) {
  const std::int64_t slices = field.grid().size.z;
  meter.stage("writing", slices, 0, 1);
  for (std::int64_t slice = 0; slice < slices; slice += writer.slices()) {
    writer.write_layer(field, slice);
    meter.advance(writer.slices());
  }
}

void write_slabs(const FieldSource& source, LayeredWriter& writer) {
  LayerGatherer gatherer(source.grid(), source.thickness(), writer.slices());
  source.for_each_part(source.arrays()[0], [&](const DistanceField& slab, const SampleArray&, std::int64_t) {
    for (std::int64_t slice = 0; slice < slab.grid().size.z;) {
      slice += gatherer.take(slab, slice);
      if (!gatherer.full()) continue;
      writer.write_layer(gatherer.layer(), 0);
      gatherer.next();
    }
  });
}

// Of the store in an unfinished folder.
void write_all_levels(StoreMetadata store, const std::filesystem::path& folder, const FieldWriteOptions& options,
                      ProgressMeter& meter) {
  store.path = folder;
  store.distance.folder = folder / kDistanceName;
  begin_levels(store, options.levels);
  for (int number = 1; number < options.levels; ++number)
    write_level(store, number, {{}, level_of(store, number).grid.size}, false, options.threads, meter);
  end_levels(store, options.levels);
}

void write_field(const std::filesystem::path& path, const FieldSource& source, const FieldWriteOptions& options,
                 ProgressMeter& meter) {
  const ZarrLayout layout{.nearest = source.is_whole() && source.whole().has_nearest(), .compress = options.compress};
  check_writable(source.grid(), source.thickness(), layout);
  const StoreMetadata store = metadata_of(path, source.grid(), source.thickness(), source.provenance(), layout);
  check_levels(store, options.levels);
  AtomicFolder folder(path, options.existing, is_own_store, kOwnStore);
  write_metadata(store, folder.path(), path);
  LayeredWriter writer(store, folder.path(), path, options.threads, meter);
  source.is_whole() ? write_whole(source.whole(), writer, meter) : write_slabs(source, writer);
  if (options.levels > 1) write_all_levels(store, folder.path(), options, meter);
  meter.stage("done", 1, 1, 1);  // nothing stops what follows
  folder.commit();
}

FieldFile read_field(const std::filesystem::path& path, const FieldRequest& request, ProgressMeter& meter) {
  const StoreMetadata store = read_store(path);
  return {read_window(store, {}, store.grid.size, request.memory_limit, meter), {}};
}

constexpr FolderFormat kFolder{.read = read_field, .write = write_field};

}  // namespace
}  // namespace standoff::zarr

namespace standoff {

constinit const FieldFormat kFieldZarr{.extension = "zarr",
                                       .description = "Zarr stores, chunked and sharded",
                                       .nearest = true,
                                       .slabs = true,
                                       .folder = &zarr::kFolder};

}  // namespace standoff
