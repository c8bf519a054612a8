// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/uri.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "files/text_cursor.h"

namespace standoff {
namespace {

constexpr std::string_view kData = "data:";

constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// The value of a hexadecimal digit, or -1.
constexpr int hexadecimal(char c) {
  if (is_digit(c)) return c - '0';
  const char lower = static_cast<char>(c | 0x20);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

constexpr std::int8_t kNoDigit = -1;
constexpr std::array<std::int8_t, 256> kBase64 = [] {
  std::array<std::int8_t, 256> digits{};
  digits.fill(kNoDigit);
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t n = 0; n < kDigits.size(); ++n)
    digits[static_cast<unsigned char>(kDigits[n])] = static_cast<std::int8_t>(n);
  return digits;
}();

// The padding at the end may be missing; nothing else may.
std::optional<std::string> base64_decoded(std::string_view text) {
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return {};
  std::string data;
  data.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int held = 0;
  for (const unsigned char c : text) {
    if (kBase64[c] == kNoDigit) return {};
    bits = bits << 6 | static_cast<std::uint32_t>(kBase64[c]);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    data += static_cast<char>(bits >> held);
  }
  return data;
}

}  // namespace

bool has_scheme(std::string_view uri) {
  const auto end = std::ranges::find_if_not(
      uri, [](char c) { return is_letter(c) || is_digit(c) || c == '+' || c == '-' || c == '.'; });
  return !uri.empty() && is_letter(uri[0]) && end != uri.end() && *end == ':';
}

std::string percent_decoded(std::string_view uri) {
  std::string decoded;
  for (std::size_t at = 0; at < uri.size(); ++at) {
    const bool escape = uri[at] == '%' && uri.size() - at > 2;
    const int high = escape ? hexadecimal(uri[at + 1]) : -1, low = escape ? hexadecimal(uri[at + 2]) : -1;
    if (high < 0 || low < 0) {
      decoded += uri[at];
      continue;
    }
    decoded += static_cast<char>(16 * high + low);
    at += 2;
  }
  return decoded;
}

bool is_data_uri(std::string_view uri) { return equals_ignoring_case(uri.substr(0, kData.size()), kData); }

std::optional<std::string> data_of_uri(std::string_view uri) {
  constexpr std::string_view kBase64Mark = ";base64";
  const auto comma = uri.find(',');
  if (!is_data_uri(uri) || comma == uri.npos) return {};
  const std::string_view head = uri.substr(0, comma), data = uri.substr(comma + 1);
  const std::string_view last = head.substr(head.size() - std::min(head.size(), kBase64Mark.size()));
  if (equals_ignoring_case(last, kBase64Mark)) return base64_decoded(data);
  return percent_decoded(data);
}

}  // namespace standoff
