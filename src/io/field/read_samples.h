// SPDX-License-Identifier: Apache-2.0
// What the header of a field file says, the words it is written in, and the field that its arrays make.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "io/field/format.h"
#include "io/field/write_samples.h"
#include "standoff/field.h"

namespace standoff {

/// Bytes of one 4-byte number per sample.
std::uint64_t sample_bytes(const Grid& grid);

/// A number, or a few, per sample, somewhere in a file.
struct StoredArray {
  /// Where it begins in the file, or in what `open` gives.
  std::uint64_t offset = 0;
  bool big_endian = false;
  bool z_fastest = false;  ///< C order of a[i,j,k]; x varies fastest otherwise
  /// Opens the part of the file that holds it, where that is packed or checked. There must be enough of it.
  std::function<std::unique_ptr<ByteStream>()> open;
  bool packed = false;  ///< memory is taken for what `open` gives
  NumberType type = NumberType::float32;
  int components = 1;
  bool planar = false;  ///< all numbers of the first component, then those of the next; those of a sample otherwise
  /// `open` from a byte on, in formats with FieldFormat::header.
  std::function<std::unique_ptr<ByteStream>(std::uint64_t)> open_at = {};

  /// The array without so many bytes at its beginning.
  StoredArray from(std::uint64_t bytes) const {
    StoredArray rest = *this;
    if (open_at)
      rest.open = [open = open_at, bytes] { return open(bytes); };
    else
      rest.offset += bytes;
    return rest;
  }
};

/// An array that is no distance.
struct StoredSidecar {
  std::string name;
  StoredArray array;
};

/// What the header of a field file says.
struct StoredField {
  Grid grid;
  double thickness = std::numeric_limits<double>::infinity();
  Provenance provenance;
  StoredArray distance;
  std::optional<StoredArray> nearest;
  std::vector<StoredSidecar> sidecars;
};

/// Throws Error{input} unless the grid is valid.
void require_valid(const FileView& file, const Grid& grid);

/// Builds the field, tile by tile, without holding all samples densely: of packed arrays, as many as a layer of tiles
/// has. Errors: input when the grid or thickness is invalid, the file is too short, or a value is not a number or
/// exceeds the thickness; limit as DistanceField, and for more than the memory limit.
FieldFile load_field(const FileView& file, const StoredField& stored, const FieldRequest& request);

/// Characters of a method or version that are read: far more than any has.
constexpr std::uint64_t kMaxText = 4096;

}  // namespace standoff
