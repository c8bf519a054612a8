// SPDX-License-Identifier: Apache-2.0
// NumPy's array files (.npy) and archives of them (.npz).
// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "files/zip.h"
#include "standoff/vec.h"

namespace standoff {

struct NpyHeader {
  std::string type;                 ///< as numpy spells it: "<f4"; a list in brackets for records, which are not read
  std::vector<std::int64_t> shape;  ///< empty for a single value
  bool fortran_order = false;       ///< the first axis varies fastest; the last one otherwise
};

/// The header with its padding, a multiple of 64 bytes; of `room` bytes, such a multiple, where it has no more without.
std::string npy_header(const NpyHeader& header, std::uint64_t room = 0);

/// The longest header that is read; longer ones describe records.
inline constexpr std::uint64_t kMaxNpyHeader = 12 + (std::uint64_t{1} << 16);

struct NpyArray : NpyHeader {
  std::uint64_t offset = 0;  ///< of the first value in the array's file
  std::uint64_t bytes = 0;   ///< from there to the end of the array's file
};

/// Reads the header of an array file of `bytes` bytes, of which `start` is the beginning: all of it, or at least
/// kMaxNpyHeader. Errors: input; `name` stands in messages.
NpyArray read_npy(const FileView& file, const std::string& name, std::string_view start, std::uint64_t bytes);

/// Writes arrays into an .npz file, one after the other.
class NpzArrays {
 public:
  explicit NpzArrays(AtomicFile& file) : zip_(file) {}

  /// Starts an array of exactly `bytes` bytes: write() them, then end().
  void begin(const std::string& name, const NpyHeader& header, std::uint64_t bytes);
  void write(std::span<const std::byte> bytes) { zip_.write(bytes); }
  void end() { zip_.end(); }
  /// An array whose bytes are there.
  void small(const std::string& name, const NpyHeader& header, std::span<const std::byte> bytes);
  /// Three numbers, one per axis.
  void vector(const std::string& name, const Vec3& v);
  void size(const std::string& name, const Size3& v);
  /// The file is complete, but not committed.
  void finish() { zip_.finish(); }

 protected:
  ZipWriter zip_;
};

}  // namespace standoff
