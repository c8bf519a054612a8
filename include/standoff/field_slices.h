// SPDX-License-Identifier: Apache-2.0
// Fields in files that are read some slices at a time, so that they may be larger than memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/io.h"
#include "standoff/slabs.h"
#include "standoff/slice_reader.h"
#include "standoff/zarr.h"

namespace standoff {

/// A .vti file, or a Zarr store, of which some slices are read at a time. surface() and verify() take reader():
///
///     const auto slices = FieldSlices::open("large.vti");
///     surface(slices.grid(), slices.thickness(), slices.reader());
///
/// An object knows the header alone; a file must not be shortened while there is one. Copies are cheap.
class STANDOFF_API FieldSlices {
 public:
  /// Whether the file's format can be read so.
  static bool can_open(const std::filesystem::path& path);
  /// Errors: input; usage (a format that cannot).
  static FieldSlices open(const std::filesystem::path& path);
  explicit FieldSlices(const ZarrStore& store);

  /// Of the whole field.
  const Grid& grid() const;
  double thickness() const;
  const Provenance& provenance() const;
  bool has_nearest() const;
  /// The names of the arrays beside it, which are not read.
  std::vector<std::string> sidecars() const;

  /// `count` slices from slice `first` on: the field of that window of grid(). Errors: usage (slices that there are
  /// not), input, limit, interrupted.
  DistanceField read(std::int64_t first, std::int64_t count, const FieldReadOptions& options = {}) const;
  SliceReader reader(const FieldReadOptions& options = {}) const;
  /// For write_field(), slabs of about `slab_samples` samples. Errors of its next(): as read().
  std::unique_ptr<FieldSlabs> slabs(const FieldReadOptions& options = {},
                                    std::int64_t slab_samples = kSlabSamples) const;

 private:
  struct Contents;
  explicit FieldSlices(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}
  std::shared_ptr<const Contents> contents_;
};

}  // namespace standoff
