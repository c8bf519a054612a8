// SPDX-License-Identifier: Apache-2.0
// Fields into the shards of a store, window by window or in layers of chunks, and windows of fields out of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "io/zarr/metadata.h"
#include "io/zarr/parts.h"
#include "io/zarr/shard.h"
#include "standoff/field.h"
#include "standoff/zarr.h"

namespace standoff {
class ProgressMeter;
}

namespace standoff::zarr {

/// Throws Error{usage} unless a store of this grid, thickness and layout can be written here.
void check_writable(const Grid& grid, double thickness, const ZarrLayout& layout);

/// The metadata of a new store.
StoreMetadata metadata_of(const std::filesystem::path& path, const Grid& grid, double thickness,
                          const Provenance& provenance, const ZarrLayout& layout);

/// Writes the files zarr.json into a folder. `shown` stands in messages. Errors: output.
void write_metadata(const StoreMetadata& store, const std::filesystem::path& folder,
                    const std::filesystem::path& shown);

/// Throws Error{usage} unless a part of the grid is whole shards.
void check_shards(const StoreMetadata& store, const Size3& first, const Size3& part);

/// Throws Error{usage} unless the store is laid out as standoff writes stores, and the window is a part of its field
/// that begins at `first`, in whole shards.
void check_window(const StoreMetadata& store, const Size3& first, const DistanceField& window);

/// Makes a folder and those it is in. `shown` stands in messages. Errors: output.
void make_folder(const std::filesystem::path& folder, const std::filesystem::path& shown);

/// Writes the shards of a window whose first sample is `first`: see ZarrStore::write. `sync`: each waits for the disk.
void write_window(const StoreMetadata& store, const Size3& first, const DistanceField& window, bool sync, int threads,
                  ProgressMeter& meter);

/// Throws Error{usage} unless a store, level 0 of it, may have so many levels.
void check_levels(const StoreMetadata& store, int levels);
/// Makes the arrays of levels 1 to `levels` - 1 without samples; shards that they have stay. The store lists level 0
/// alone until end_levels(). Errors: output.
void begin_levels(const StoreMetadata& store, int levels);
/// Writes the shards of a part of level `number`, at least 1, out of the one before. Errors: as read_window,
/// write_window.
void write_level(const StoreMetadata& store, int number, const Window& part, bool sync, int threads,
                 ProgressMeter& meter);
/// Lists so many levels. Errors: output.
void end_levels(const StoreMetadata& store, int levels);

/// Writes all shards of a store in ascending z, a layer of chunks after the other, into a folder that nobody else
/// knows: chunks are appended to the files of their shards, so that no more than the chunks of some shards' layers is
/// held. The files are those that write_window makes.
class LayeredWriter {
 public:
  /// `shown` stands in messages. Store and meter must outlive it. `threads`: that pack; 0 for all.
  LayeredWriter(const StoreMetadata& store, const std::filesystem::path& folder, const std::filesystem::path& shown,
                int threads, ProgressMeter& meter);

  /// Slices of a layer of chunks.
  std::int64_t slices() const { return store_.distance.chunk.z; }
  /// Writes the next layer: the slices of `field` from `first` on, slices() of them or what is left of the grid.
  /// `first` is a multiple of 8. Errors: output, interrupted.
  void write_layer(const DistanceField& field, std::int64_t first);

 private:
  struct Shard {
    ShardIndex index;
    std::uint64_t size = 0;
  };
  struct Array {
    const StoredLayout* layout;
    std::vector<Shard> shards;  // of a layer of shards, x fastest
  };

  void write_chunks(Array& array, std::size_t shard, const DistanceField& field, std::int64_t first);
  void append_to(const Array& array, std::size_t shard, const std::vector<std::byte>& bytes) const;
  Size3 shard_at(const Array& array, std::size_t shard) const;
  void end_shards(Array& array);

  const StoreMetadata& store_;
  std::filesystem::path folder_, shown_;
  const int threads_;
  ProgressMeter& meter_;
  std::vector<Array> arrays_;
  std::int64_t layer_ = 0;
};

/// The field of `size` samples from `first` on: see ZarrStore::read. `memory_limit`: bytes, 0 for none.
DistanceField read_window(const StoreMetadata& store, const Size3& first, const Size3& size, std::int64_t memory_limit,
                          ProgressMeter& meter);

}  // namespace standoff::zarr
