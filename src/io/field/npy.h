// SPDX-License-Identifier: Apache-2.0
// The header of NumPy's array files (.npy). https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"

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

}  // namespace standoff
