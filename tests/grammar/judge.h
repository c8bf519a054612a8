// SPDX-License-Identifier: Apache-2.0
// The folder in which files lie when they are read, and what a reader says of one held against what is known of it.
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

/// Makes beside the files to come what they may refer to and no reader may open: file.h. Errors: filesystem_error.
void set_traps(const std::filesystem::path& folder);

/// Writes the file, and those beside it, into the folder; returns its path.
std::filesystem::path put(const Grammar& grammar, const File& file, const std::filesystem::path& folder);

}  // namespace standoff::grammar
