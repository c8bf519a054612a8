// SPDX-License-Identifier: Apache-2.0
// Holds what a reader says of a file against what is known of it.
#pragma once

#include <filesystem>
#include <string>

#include "tests/grammar/file.h"

namespace standoff::grammar {

struct Verdict {
  bool read = false;      ///< or refused, with Error
  bool compared = false;  ///< what was read is what the file holds
  std::string fault;      ///< what is wrong with the answer; empty: nothing
};

/// Reads the file that lies at `path` through the public functions. Of any file: what is read is valid, and an error is
/// of the kinds input and limit, names the file and says what to do. Where no trick was played, it must be read, and be
/// what the grammar wrote. Bodies are asked a few questions too, whatever they hold.
Verdict judge(const Grammar& grammar, const File& file, bool good, const std::filesystem::path& path);

/// What fills the file that no other one may lead to (kOutside), so that its bytes are known in a mesh.
inline constexpr char kOutsideByte = 0x7a;

}  // namespace standoff::grammar
