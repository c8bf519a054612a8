// SPDX-License-Identifier: Apache-2.0
// The prefix codes of deflate (RFC 1951, section 3.2.2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace standoff {

struct HuffmanCode {
  std::uint16_t bits = 0;   ///< as they are written: the first one lowest
  std::uint8_t length = 0;  ///< 0: the symbol does not occur
};

/// The codes of symbols that occur so often, none longer than `longest` bits. A single symbol gets one bit. Requires
/// fewer than 2^longest symbols.
void make_huffman_codes(std::span<const std::uint32_t> counts, int longest, std::span<HuffmanCode> codes);

}  // namespace standoff
