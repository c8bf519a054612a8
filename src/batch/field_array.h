// SPDX-License-Identifier: Apache-2.0
// The fields of many meshes as one Zarr array of version 3, a row for each (docs/batch_files.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "standoff/field.h"
#include "standoff/vec.h"

namespace standoff {

/// How the rows of an array lie in files.
struct FieldArrayLayout {
  Size3 shape;           ///< samples of every field
  bool compress = true;  ///< blosc, as in Zarr stores

  /// Samples of a chunk, which is a file: all of a row, unless an axis has more than 256; then equal parts of it.
  Size3 chunk() const;
  /// Chunks of a row along each axis.
  Size3 chunks() const;
};

/// The group `fields.zarr`: `distance` (n, X, Y, Z) in float32, and for each row `origin` (n, 3), `spacing` (n, 3) and
/// `thickness` (n) in float64 and `code` (n), uint8. A row without a field is NaN. Chunks are not gathered in shards:
/// so no two rows share a file, and any number of processes may write rows.
class FieldArray {
 public:
  /// Rows and bytes are known to no object: any number of them may work on one folder. Errors: usage, where chunks are
  /// to be compressed and this build cannot.
  FieldArray(const std::filesystem::path& folder, const FieldArrayLayout& layout);

  /// The files that a row has, or would have.
  std::vector<std::filesystem::path> files_of(std::int64_t row) const;
  /// Writes a row, after begin(). Each file appears whole or not at all; those of an earlier field are
  /// removed first. Errors: usage (a field of another shape), output.
  void put(std::int64_t row, const DistanceField& field) const;
  /// Takes a row away: it reads as NaN. Errors: output.
  void remove(std::int64_t row) const;

  static constexpr std::uint8_t kUnknown = 255;  ///< a row's code where nothing is known; exit codes are smaller

  /// What the rows' fields are on, and how each ended.
  struct Table {
    explicit Table(std::int64_t rows);
    void set(std::int64_t row, const Vec3& first, const Vec3& step, double half_width);

    std::int64_t rows;
    std::vector<double> origin, spacing, thickness;  // NaN where there is no field
    std::vector<std::uint8_t> code;                  // or kUnknown
  };
  /// Makes the folder, and removes what makes it an array: nobody opens it before
  /// end(). A store of somebody else stays. Errors: output.
  void begin() const;
  /// Makes it an array of so many rows. Files of rows behind them are removed, and of those whose code is not 0.
  /// Errors: output.
  void end(const Table& table) const;

 private:
  std::vector<std::byte> packed(const DistanceField& field, const Size3& part) const;
  void write_zarr_json(const char* name, const std::string& text) const;
  template <class Number>
  void write_table(const char* name, const char* type, const std::vector<Number>& values, std::int64_t columns) const;
  void remove_strangers(const Table& table) const;

  std::filesystem::path folder_;
  FieldArrayLayout layout_;
};

}  // namespace standoff
