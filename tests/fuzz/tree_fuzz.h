// SPDX-License-Identifier: Apache-2.0
// Fuzzers of trees. Their files have long tables that say nothing, so a fuzzer's bytes are also taken as changes to a
// good file: where, and what stands there then.
#pragma once

#include <cstring>
#include <string>

#include "field_fuzz.h"
#include "standoff/io.h"
#include "tests/support/temp_folder.h"

namespace standoff {

inline std::string good_tree(const std::string& extension) {
  const TempFolder folder;
  DistanceField field({{20, 17, 9}, {1, 2, 3}, {0.5, 1, 2}}, 1);
  const auto values = field.store_tile(1, 1, 0);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(n) / 256 - 1;
  field.mark_inside(0, 1, 1);
  write_field(folder / ("a." + extension), field);
  return read_bytes(folder / ("a." + extension));
}

inline int fuzz_tree(const char* extension, FieldFile (*read)(const FileView&, const FieldRequest&),
                     const std::uint8_t* data, std::size_t size) {
  static const std::string good = good_tree(extension);
  std::string bytes = good;
  for (std::size_t at = 0; at + 4 <= size; at += 4) {
    std::uint32_t change;
    std::memcpy(&change, data + at, sizeof change);
    bytes[(change >> 8) % bytes.size()] = static_cast<char>(change & 0xFF);
  }
  fuzz_field(read, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  return fuzz_field(read, data, size);
}

}  // namespace standoff
