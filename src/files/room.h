// SPDX-License-Identifier: Apache-2.0
// Whether a disk has room for a file, before it is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace standoff {

/// The bytes that the file system still takes where this file is, or is to be; nothing where it does not tell, and for
/// pipes and devices. An older file of the name counts as what is taken: it stays until the new one is complete.
std::optional<std::uint64_t> room_for(const std::filesystem::path& file);

/// Throws Error{output} where a file of so many bytes would not fit into `room`, of room_for().
void expect_room(const std::filesystem::path& file, double bytes, std::optional<std::uint64_t> room);

}  // namespace standoff
