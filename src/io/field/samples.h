// SPDX-License-Identifier: Apache-2.0
// The samples of a field between its tiles and the arrays of a file, a few slices at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "files/byte_stream.h"
#include "files/file_view.h"
#include "standoff/field.h"

namespace standoff {

/// Takes the bytes of an array in order.
using ByteSink = std::function<void(std::span<const std::byte>)>;

/// Passes on all values as little endian floats, x fastest.
void send_values(const DistanceField& field, const ByteSink& sink);
/// Passes on all nearest triangles as little endian 32-bit integers, x fastest.
void send_nearest(const DistanceField& field, const ByteSink& sink);
/// Bytes that either of them passes on.
std::uint64_t sample_bytes(const Grid& grid);

/// One 4-byte number per sample, somewhere in a file.
struct StoredArray {
  /// Where it begins in the file, or in what `open` gives.
  std::uint64_t offset = 0;
  bool big_endian = false;
  bool z_fastest = false;  ///< C order of a[i,j,k]; x varies fastest otherwise
  /// Opens the part of the file that holds it, where that is packed or checked. There must be enough of it.
  std::function<std::unique_ptr<ByteStream>()> open;
  bool packed = false;  ///< memory is taken for what `open` gives
};

/// What the header of a field file says.
struct StoredField {
  Grid grid;
  double thickness = std::numeric_limits<double>::infinity();
  Provenance provenance;
  StoredArray distance;
  std::optional<StoredArray> nearest;
};

/// Throws Error{input} unless the grid is valid.
void require_valid(const FileView& file, const Grid& grid);

/// Builds the field, tile by tile, without holding all samples densely: of packed arrays, as many as a layer of tiles
/// has. Errors: input when the grid or thickness is invalid, the file is too short, or a value is not a number or
/// exceeds the thickness; limit as DistanceField, and for more than `memory_limit` bytes unless that is 0.
DistanceField load_field(const FileView& file, const StoredField& stored, std::int64_t memory_limit);

}  // namespace standoff
