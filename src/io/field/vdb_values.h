// SPDX-License-Identifier: Apache-2.0
// The values of a node of an OpenVDB file: those that are active, packed or not, and what says the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/field/vdb_cursor.h"
#include "io/field/vdb_format.h"
#include "io/field/vdb_tree.h"

namespace standoff::vdb {

class ValueReader {
 public:
  ValueReader(std::uint32_t compression, bool half, float background)
      : compression_(compression), half_(half), background_(background) {}

  /// The values of a node in its order, until the next call.
  template <int log>
  const float* read(Cursor& from, const Mask<log>& active) {
    return read(from, active.words.data(), Mask<log>::kBits);
  }

 private:
  const float* read(Cursor& from, const std::uint64_t* active, std::size_t count);
  void read_data(Cursor& from, std::size_t count);
  std::string_view unpacked(Cursor& from, std::size_t bytes);

  std::uint32_t compression_;
  bool half_;
  float background_;
  std::vector<float> stored_, values_;
  std::vector<char> unpacked_;
};

}  // namespace standoff::vdb
