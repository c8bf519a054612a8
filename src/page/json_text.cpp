// SPDX-License-Identifier: Apache-2.0
#include "page/json_text.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/number_text.h"

namespace standoff::page {
namespace {

constexpr std::string_view kReplacementBytes = "\xEF\xBF\xBD";  // U+FFFD

// How many bytes the UTF-8 character at the beginning has; 0: there is none.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t n) { return n < text.size() ? static_cast<unsigned char>(text[n]) : 0u; };
  const auto follows = [&](std::size_t n, unsigned least = 0x80, unsigned most = 0xBF) {
    return byte(n) >= least && byte(n) <= most;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  // Not the longer forms of shorter characters, not the surrogates, nothing past U+10FFFF.
  if (first >= 0xE0 && first <= 0xEF)
    return follows(1, first == 0xE0 ? 0xA0 : 0x80, first == 0xED ? 0x9F : 0xBF) && follows(2) ? 3 : 0;
  if (first >= 0xF0 && first <= 0xF4)
    return follows(1, first == 0xF0 ? 0x90 : 0x80, first == 0xF4 ? 0x8F : 0xBF) && follows(2) && follows(3) ? 4 : 0;
  return 0;
}

std::string escaped(unsigned code) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "\\u%04x", code);
  return text.data();
}

}  // namespace

std::string json_string(std::string_view text) {
  std::string json = "\"";
  while (!text.empty()) {
    const std::size_t bytes = character(text);
    const std::string_view one = bytes == 0 ? kReplacementBytes : text.substr(0, bytes);
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
    const auto first = static_cast<unsigned char>(one[0]);
    if (one == "\xE2\x80\xA8" || one == "\xE2\x80\xA9")
      json += escaped(one[2] == '\xA8' ? 0x2028 : 0x2029);
    else if (first < 0x20 || first == 0x7F || std::string_view("\"\\<>&").find(one[0]) != std::string_view::npos)
      json += escaped(first);
    else
      json += one;
  }
  return json + '"';
}

namespace {
template <class Triple>
std::string triple_text(const Triple& v) {
  std::string text = "[";
  text += json_number(v.x) + ',' + json_number(v.y) + ',' + json_number(v.z) + ']';
  return text;
}
}  // namespace

std::string json_number(double value) { return std::isfinite(value) ? exact_text(value) : "null"; }
std::string json_number(std::int64_t value) { return std::to_string(value); }

std::string json_triple(Vec3 v) { return triple_text(v); }
std::string json_triple(Size3 v) { return triple_text(v); }

}  // namespace standoff::page
