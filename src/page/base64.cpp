// SPDX-License-Identifier: Apache-2.0
#include "page/base64.h"

#include <cstdint>

namespace standoff::page {

void append_base64(std::string& out, std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  out.reserve(out.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::string_view three = bytes.substr(at, 3);
    std::uint32_t bits = 0;
    for (std::size_t n = 0; n < 3; ++n)
      bits = bits << 8 | (n < three.size() ? static_cast<unsigned char>(three[n]) : 0u);
    for (std::size_t n = 0; n < 4; ++n) out += n <= three.size() ? kDigits[bits >> (18 - 6 * n) & 63] : '=';
  }
}

}  // namespace standoff::page
