// The header of NumPy's array files (.npy). https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/field/input.h"

namespace standoff {

struct NpyHeader {
  std::string type;                 ///< as numpy spells it: "<f4"
  std::vector<std::int64_t> shape;  ///< empty for a single value
  bool fortran_order = false;       ///< the first axis varies fastest; the last one otherwise
};

/// The header with its padding, a multiple of 64 bytes.
std::string npy_header(const NpyHeader& header);

struct NpyArray : NpyHeader {
  std::string name;          ///< for messages
  std::uint64_t offset = 0;  ///< of the first value
  std::uint64_t bytes = 0;   ///< from there to the end of the array's file
};

/// Reads the header of the array file that lies in `bytes` bytes from `offset` on. Errors: input.
NpyArray read_npy(const FieldInput& file, const std::string& name, std::uint64_t offset, std::uint64_t bytes);

}  // namespace standoff
