// SPDX-License-Identifier: Apache-2.0
// The folder in which files that were written by grammar lie when they are read.
#pragma once

#include <filesystem>

#include "tests/grammar/file.h"

namespace standoff::grammar {

/// Makes beside the files to come what they may refer to and no reader may open: file.h. Errors: filesystem_error.
void set_traps(const std::filesystem::path& folder);

/// Writes the file, and those beside it, into the folder; returns its path.
std::filesystem::path put(const Grammar& grammar, const File& file, const std::filesystem::path& folder);

}  // namespace standoff::grammar
