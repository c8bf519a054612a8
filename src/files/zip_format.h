// SPDX-License-Identifier: Apache-2.0
// Signatures and sizes of the records of a zip archive. PKWARE APPNOTE 6.3, section 4.3.
#pragma once

#include <cstdint>

namespace standoff {

/// Signatures and sizes of the records of an archive: section 4.3.
namespace zip {

inline constexpr std::uint32_t kLocalHeader = 0x04034b50;
inline constexpr std::uint32_t kDirectoryHeader = 0x02014b50;
inline constexpr std::uint32_t kDirectoryEnd = 0x06054b50;
inline constexpr std::uint32_t kDirectoryEnd64 = 0x06064b50;
inline constexpr std::uint32_t kLocator64 = 0x07064b50;

inline constexpr std::uint64_t kLocalHeaderBytes = 30;
inline constexpr std::uint64_t kDirectoryHeaderBytes = 46;
inline constexpr std::uint64_t kDirectoryEndBytes = 22;
inline constexpr std::uint64_t kDirectoryEnd64Bytes = 56;
inline constexpr std::uint64_t kLocator64Bytes = 20;

inline constexpr std::uint64_t kLocalCrcOffset = 14;  ///< of the checksum within a local header

inline constexpr std::uint16_t kExtra64 = 1;        ///< the extra field that holds 64-bit sizes and offsets
inline constexpr std::uint32_t kIn64 = 0xFFFFFFFF;  ///< stands for a value given there
inline constexpr std::uint16_t kCountIn64 = 0xFFFF;

}  // namespace zip

}  // namespace standoff
