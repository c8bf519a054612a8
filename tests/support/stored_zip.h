// SPDX-License-Identifier: Apache-2.0
// Small zip archives in memory, nothing in them packed.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "files/zip.h"

namespace standoff {

/// The archive of these members, each a name and its bytes.
inline std::string stored_zip(const std::vector<std::pair<std::string, std::string>>& members) {
  const auto u16 = [](std::size_t n) {
    const auto value = static_cast<std::uint16_t>(n);
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  const auto u32 = [](std::size_t n) {
    const auto value = static_cast<std::uint32_t>(n);
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::string archive, directory;
  for (const auto& [name, bytes] : members) {
    const auto crc = ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    // Version, flags, method, time and date; checksum; sizes; lengths of the name and the extra field.
    const std::string common =
        u16(20) + std::string(8, '\0') + u32(crc) + u32(bytes.size()) + u32(bytes.size()) + u16(name.size()) + u16(0);
    directory += u32(zip::kDirectoryHeader) + u16(20) + common + std::string(10, '\0') + u32(archive.size()) + name;
    archive += u32(zip::kLocalHeader) + common + name + bytes;
  }
  return archive + directory + u32(zip::kDirectoryEnd) + u32(0) + u16(members.size()) + u16(members.size()) +
         u32(directory.size()) + u32(archive.size()) + u16(0);
}

}  // namespace standoff
