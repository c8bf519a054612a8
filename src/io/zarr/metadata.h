// SPDX-License-Identifier: Apache-2.0
// What zarr.json says: of an array, and of the group that is a store. The subset that standoff writes, and what other
// programs write with the same codecs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "files/file_view.h"
#include "standoff/field.h"
#include "standoff/grid.h"

namespace standoff::zarr {

/// The names in a store: of the array of distances, as OME-Zarr calls its first level, and of nearest triangles.
inline constexpr const char *kDistanceName = "0", *kNearestName = "nearest", *kMetadataName = "zarr.json";

/// The most bytes of a chunk, and the most chunks of a shard, that are read: what a thread holds, and an index.
inline constexpr std::int64_t kMostChunkBytes = std::int64_t{1} << 28, kMostChunks = std::int64_t{1} << 20;

/// An array of numbers of 4 bytes.
struct ArrayLayout {
  Size3 shape;
  bool whole_numbers = false;  ///< uint32; float32 otherwise
  std::uint32_t fill = 0;      ///< the bits of the value of samples that are not stored
  Size3 shard;                 ///< samples of a file
  Size3 chunk;                 ///< samples of a chunk; those of the file where there are no shards
  bool sharded = true;         ///< a file has chunks and an index of them, else it is one chunk
  bool index_first = false;    ///< the index is at the file's beginning, else at its end
  bool x_fastest = true;       ///< within a chunk; z varies fastest otherwise
  bool blosc = true;           ///< chunks are compressed
  char separator = '/';        ///< between the numbers in a file's name

  std::int64_t chunk_bytes() const { return 4 * chunk.count(); }
  /// Chunks of a file, per axis.
  Size3 chunks() const { return {shard.x / chunk.x, shard.y / chunk.y, shard.z / chunk.z}; }
  /// The name of a file in the array's folder.
  std::filesystem::path file_name(const Size3& shard_index) const;
};

/// An array and where it is.
struct StoredLayout : ArrayLayout {
  std::filesystem::path folder;
};

/// A store.
struct StoreMetadata {
  std::filesystem::path path;
  Grid grid;
  double thickness = 0;
  Provenance provenance;
  StoredLayout distance;
  std::optional<StoredLayout> nearest;
};

/// The text of an array's zarr.json. `attributes`: more of it, JSON, or empty.
std::string array_text(const ArrayLayout& layout, const std::string& attributes);
/// The attributes of the array of distances: grid, thickness, provenance.
std::string field_attributes(const StoreMetadata& store);
/// The text of a store's own zarr.json.
std::string group_text(const StoreMetadata& store);

/// Reads an array's zarr.json. Errors: input, as `FILE:WHERE: what; what to do`.
ArrayLayout read_array(const FileView& file);

/// Reads the metadata of a store, or of one array alone. Errors: input.
StoreMetadata read_store(const std::filesystem::path& path);

/// What is_own_store() looks for, in messages.
inline constexpr const char* kOwnStore = "a Zarr store of standoff";

/// Whether a folder is a store that standoff wrote, and holds nothing else: it may be replaced. Errors: limit.
bool is_own_store(const std::filesystem::path& path);

}  // namespace standoff::zarr
