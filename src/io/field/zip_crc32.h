// The checksum of zip archives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace standoff {

/// CRC-32 (polynomial 0xEDB88320, as zip, gzip and PNG) of bytes that follow others whose checksum was `before`.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace standoff
