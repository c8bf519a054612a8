// SPDX-License-Identifier: Apache-2.0
// What zarr.json says: of an array, and of the group that is a store. The subset that standoff writes, and what other
// programs write with the same codecs.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "files/file_view.h"
#include "standoff/field.h"
#include "standoff/grid.h"

namespace standoff::zarr {

/// The names in a store: of the array of distances, as OME-Zarr calls its first level (others are called by their
/// numbers), and of nearest triangles.
inline constexpr const char *kDistanceName = "0", *kNearestName = "nearest", *kMetadataName = "zarr.json";

/// Of the attributes that standoff writes.
inline constexpr std::uint64_t kFormat = 1;
inline constexpr const char *kOwnAttributes = "standoff", *kSum = "metadata_crc32c";
inline constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
inline constexpr const char *kInfinity = "Infinity", *kMinusInfinity = "-Infinity", *kNotANumber = "NaN";

/// The most levels: those of 2^40 samples would end before.
inline constexpr int kMostLevels = 32;

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
  bool checked = true;         ///< chunks end with their CRC-32C
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

/// A store, or one level of it.
struct StoreMetadata {
  std::filesystem::path path;
  Grid grid;
  double thickness = 0;
  Provenance provenance;
  StoredLayout distance;
  std::optional<StoredLayout> nearest;
  bool own = true;  ///< standoff wrote it
  int levels = 1;   ///< that the store lists: 0 is the field, each other one every second sample of the one before
};

/// Level `number` of a store, as standoff writes it: every 2^number-th sample along each axis, without nearest
/// triangles.
StoreMetadata level_of(const StoreMetadata& store, int number);

/// The texts of zarr.json: of the array of distances, with grid, thickness and provenance; of nearest triangles, which
/// the store must have; and of the store itself, which lists its levels.
std::string distance_text(const StoreMetadata& store);
std::string nearest_text(const StoreMetadata& store);
std::string group_text(const StoreMetadata& store);

/// The text of an array's zarr.json. `attributes`: JSON.
std::string array_text(const ArrayLayout& layout, const std::string& attributes);
/// The members of our attributes, but for the checksum.
std::string own_members(const StoreMetadata& store, bool nearest);
/// What the checksum of an array's metadata is of: all that its samples depend on, however it is written down.
std::uint32_t sum_of(const ArrayLayout& layout, const std::string& members);

/// The most bytes of a zarr.json that is read.
inline constexpr std::uint64_t kMostMetadataBytes = std::uint64_t{16} << 20;

/// Opens a file of a store, without waiting for what is no regular file. A number below zero: there is none. `what` it
/// is stands in messages. Errors: input.
Descriptor open_stored(const std::filesystem::path& path, const char* what);

/// Reads an array's zarr.json. Errors: input, as `FILE:WHERE: what; what to do`.
ArrayLayout read_array(const FileView& file);

/// Reads the metadata of a level of a store, or of one array alone. Errors: input; usage (a level that it does not
/// list).
StoreMetadata read_store(const std::filesystem::path& path, int level = 0);

/// What is_own_store() looks for, in messages.
inline constexpr const char* kOwnStore = "a Zarr store of standoff";

/// Whether a folder is a store that standoff wrote, and holds nothing else: it may be replaced. Errors: limit.
bool is_own_store(const std::filesystem::path& path);

}  // namespace standoff::zarr
