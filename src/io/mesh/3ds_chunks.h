// SPDX-License-Identifier: Apache-2.0
// The chunks of a 3DS file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "files/file_view.h"

namespace standoff {

/// The number whose bytes begin at `at`; they must be there.
template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// Calls see(id, begin, end of the content) for each chunk as assimp goes through them: one without content is no more
/// than its header, and one longer than what holds it takes what follows along.
template <class See>
void each_chunk(const FileView& file, std::size_t begin, std::size_t end, const See& see) {
  constexpr std::size_t kHeader = 6;  // what it is, and its length with this header
  for (std::size_t at = begin; at < end && end - at >= kHeader;) {
    const auto id = number_at<std::uint16_t>(file.bytes(), at);
    const std::size_t size = number_at<std::uint32_t>(file.bytes(), at + 2);
    at += kHeader;
    if (size <= kHeader) continue;
    const std::size_t stop = at + std::min(size - kHeader, file.size() - at);
    see(id, at, stop);
    if (stop > end) end = file.size();
    at = stop;
  }
}

}  // namespace standoff
