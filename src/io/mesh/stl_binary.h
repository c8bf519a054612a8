// SPDX-License-Identifier: Apache-2.0
// The layout of binary STL.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

namespace standoff {

/// 80 bytes of free text, a 32-bit count, then 50 bytes per triangle: normal and three corners as 32-bit floats, and
/// two bytes that mean nothing here. Little endian.
inline constexpr std::size_t kStlHeader = 84;
inline constexpr std::size_t kStlRecord = 50;
inline constexpr std::size_t kStlCount = 80;
inline constexpr std::size_t kStlCorners = 12;  ///< in a record

inline std::uint64_t stl_binary_size(std::uint32_t triangles) {
  return kStlHeader + std::uint64_t{kStlRecord} * triangles;
}

/// The count of triangles in the header. Requires content.size() >= kStlHeader.
inline std::uint32_t stl_count(std::string_view content) {
  std::uint32_t count;
  std::memcpy(&count, content.data() + kStlCount, sizeof count);
  return count;
}

}  // namespace standoff
