// SPDX-License-Identifier: Apache-2.0
// Hashes of bytes: they tell whether a file, or what was asked for, is what it was.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace standoff {

/// 64 bits that depend on every byte, the same on every machine. Files that differ by chance have different hashes; no
/// protection against those that are made to have the same.
std::uint64_t content_hash(std::string_view bytes);

/// The same of a regular file's bytes; 0 for anything else, such as a pipe, whose bytes are there once. Errors: input
/// (it cannot be read), limit (memory).
std::uint64_t file_hash(const std::filesystem::path& path);

}  // namespace standoff
