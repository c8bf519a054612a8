// SPDX-License-Identifier: Apache-2.0
// Zarr stores: fields on disk that are written and read window by window (docs/zarr.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "standoff/existing.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/io.h"

namespace standoff {

/// How a new store is laid out.
struct ZarrLayout {
  /// Samples of a shard, which is one file, and of a chunk, which is compressed for itself; per axis. Chunks are
  /// multiples of 8, shards multiples of chunks; a chunk has at most 2^24 samples, a shard at most 2^20 chunks.
  Size3 shard{128, 128, 128};
  Size3 chunk{32, 32, 32};
  bool nearest = false;  ///< whether the store also has nearest triangles
  /// Whether chunks are compressed (blosc: zstd, level 3, bytes shuffled), for which this build must have blosc.
  bool compress = true;
};

struct ZarrWriteOptions {
  int threads = 0;  ///< that compress; 0: as many as the machine has. The files have the same bytes for any number
  ProgressCallback progress = {};
};

/// A field in a folder, NAME.zarr: one Zarr array of version 3, sharded, whose samples that are not stored have the
/// thickness as their value. write_field() and read_field() of standoff/io.h do whole ones; this does parts, so that
/// many processes can write one store, and nobody needs to hold all of it. An object knows the store's metadata alone,
/// and may be used by many threads. Copies are cheap.
class STANDOFF_API ZarrStore {
 public:
  /// Makes a store without samples: every value is the thickness. It appears whole or not at all. Existing::replace
  /// takes the place of a store that standoff wrote and of an empty folder, never of anything else. Errors: usage
  /// (grid, thickness, layout; a build without blosc), output.
  static ZarrStore create(const std::filesystem::path& path, const Grid& grid, double thickness,
                          const Provenance& provenance = {}, const ZarrLayout& layout = {},
                          Existing existing = Existing::keep);
  /// Opens a store, or a single array of floats. Reads metadata alone. Errors: input, also for what is no store, and
  /// for arrays of kinds that are not read: the message names those that are.
  static ZarrStore open(const std::filesystem::path& path);

  const std::filesystem::path& path() const;
  /// Of the whole field.
  const Grid& grid() const;
  /// Half-width of the band, world units; infinite where the store does not say.
  double thickness() const;
  const Provenance& provenance() const;
  bool has_nearest() const;
  /// Of the array of distances. A store that is not sharded has shards of one chunk.
  Size3 shard() const;
  Size3 chunk() const;

  /// Writes the samples of `window`, the first of which is sample `first` of grid(). On each axis `first` is a multiple
  /// of the shard, and the window ends at one or at the grid's end: else it would share a shard with another writer,
  /// and one of both would be lost without a word. Each shard's file appears whole or not at all; a shard without any
  /// value below the thickness has none, also where it had one before. Other processes may write other shards
  /// meanwhile. Errors: usage (a window of other samples, spacing or thickness; nearest triangles in one of both alone;
  /// a store of a layout that standoff does not write), output, interrupted: shards that were written stay.
  void write(Size3 first, const DistanceField& window, const ZarrWriteOptions& options = {}) const;

  /// How many levels the store lists. Level 0 is the field; each other one has every second sample of the one before,
  /// along each axis, so that its values are exact distances, too: sample (i,j,k) of level n is sample 2^n (i,j,k) of
  /// the field. They have no nearest triangles.
  int levels() const;
  /// A level that is listed; 0 is this. Errors: usage (no such level), input.
  ZarrStore level(int number) const;
  /// Makes levels 1 to `levels` - 1 out of this one, and lists them when all are complete; returns the store with them.
  /// Memory: a few shards. Errors: usage (this is no level 0; more levels than the grid has), input, output,
  /// interrupted.
  ZarrStore write_levels(int levels, const ZarrWriteOptions& options = {}) const;

  /// The same by many processes. First begin_levels(), which makes the arrays; then write_level() for all parts of
  /// level 1, of level 2 and so on, each of whole shards of that level, as for write(); at last end_levels(), which
  /// lists them. write() of a store that lists levels ends their list, for they are the old field's. Errors: as above.
  void begin_levels(int levels) const;
  void write_level(int number, Size3 first, Size3 size, const ZarrWriteOptions& options = {}) const;
  void end_levels(int levels) const;

  /// The field of a part: `size` samples from sample `first` on; its grid is grid().window(first, size). Reads the
  /// chunks of that part alone. Tiles whose
  /// samples are all clamped are not stored in the field. Memory: the field, and a few chunks for each thread. Errors:
  /// usage (samples outside of the grid), input (shards that are damaged: the message names the file), limit,
  /// interrupted.
  DistanceField read(Size3 first, Size3 size, const FieldReadOptions& options = {}) const;
  /// The whole field. Errors: as above.
  DistanceField read(const FieldReadOptions& options = {}) const;

 private:
  struct Contents;
  explicit ZarrStore(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}
  std::shared_ptr<const Contents> contents_;
};

}  // namespace standoff
