// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: what its body holds, in which order and types.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "files/file_view.h"

namespace standoff {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of a value in a binary body.
std::size_t ply_size(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type;
  bool list = false;
  PlyType count_type = PlyType::uint8;  ///< lists only; an integer
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The property of that name, or -1.
  int find(const char* property) const;
  /// The least bytes that one row can take in the body.
  std::uint64_t least_bytes(bool ascii) const;
};

struct PlyHeader {
  enum class Encoding { ascii, little_endian, big_endian };
  Encoding encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;  ///< offset of the first byte after the header
};

/// Which properties of the vertices are x, y and z. Errors: input, if one is missing or a list.
std::array<int, 3> position_axes(const FileView& file, const PlyElement& vertices);

/// Errors: input, with the line.
PlyHeader read_ply_header(const FileView& file);

}  // namespace standoff
