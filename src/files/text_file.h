// SPDX-License-Identifier: Apache-2.0
// Whole text files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "standoff/existing.h"

namespace standoff {

/// The bytes of a file. Errors: input; limit when memory runs out.
std::string read_text(const std::filesystem::path& path);
/// Writes bytes as they are; the file appears whole or not at all. Errors: output.
void write_text(const std::filesystem::path& path, std::string_view text, Existing existing = Existing::replace);

}  // namespace standoff
