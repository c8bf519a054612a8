// SPDX-License-Identifier: Apache-2.0
#include "cli/text.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace standoff::cli {
namespace {

template <class... Args>
std::string formatted(const char* format, Args... args) {
  char text[96];
  std::snprintf(text, sizeof text, format, args...);
  return text;
}

}  // namespace

std::string grouped(std::int64_t n) {
  std::string digits = std::to_string(n);
  const std::size_t sign = n < 0;
  for (std::size_t at = digits.size(); at > sign + 3;) digits.insert(at -= 3, ",");
  return digits;
}

std::string counted(std::int64_t n, const std::string& noun) {
  if (n == 1) return "1 " + noun;
  if (noun.ends_with("ex")) return grouped(n) + " " + noun.substr(0, noun.size() - 2) + "ices";
  return grouped(n) + " " + noun + (noun.ends_with("sh") ? "es" : "s");
}

std::string number(double value) { return formatted("%.6g", value); }

std::string exact_number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string spacing_text(Vec3 s) {
  if (s.x == s.y && s.y == s.z) return number(s.x);
  return number(s.x) + " x " + number(s.y) + " x " + number(s.z);
}

std::string size_text(Size3 size) {
  return std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z);
}

std::string point_text(Vec3 p) { return "(" + number(p.x) + ", " + number(p.y) + ", " + number(p.z) + ")"; }

std::string bytes_text(std::int64_t bytes) {
  if (bytes < 1024) return formatted("%d B", static_cast<int>(bytes));
  auto value = static_cast<double>(bytes);
  const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  int unit = 0;
  for (; value >= 1023.95 && unit < 6; ++unit) value /= 1024;
  return formatted("%.*f %s", value < 99.95 ? 1 : 0, value, units[unit]);
}

std::string seconds_text(double seconds) {
  if (seconds < 9.995) return formatted("%.2f s", seconds);
  if (seconds < 99.95) return formatted("%.1f s", seconds);
  const auto whole = static_cast<long>(std::lround(seconds));
  return formatted("%ld min %02ld s", whole / 60, whole % 60);
}

std::string hash_text(std::uint64_t hash) { return formatted("%016llx", static_cast<unsigned long long>(hash)); }

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n)
    text += (n == 0 ? "" : n + 1 == names.size() ? " or " : ", ") + names[n];
  return text;
}

std::string wrapped(std::string text, std::size_t columns) {
  std::size_t begin = 0, blank = std::string::npos;
  for (std::size_t n = 0; n < text.size(); ++n) {
    if (text[n] == ' ') blank = n;
    if (n - begin < columns || blank == std::string::npos || blank < begin) continue;
    text[blank] = '\n';
    begin = blank + 1;
  }
  return text;
}

std::string one_line(std::string text) {
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n' || c == '\r' || c == '\t')
      c = ' ';
    else if (byte < 0x20 || byte == 0x7f)
      c = '?';
  }
  return text;
}

std::string message_line(const std::string& text) {
  constexpr std::size_t kLongest = 6000, kEnd = 1000, kLongestWord = 400, kWordEnd = 100;
  const auto shortened = [](const std::string& whole, std::size_t longest, std::size_t end) {
    if (whole.size() <= longest) return whole;
    const auto character = [&](std::size_t at) {  // that begins there or next
      while (at < whole.size() && (whole[at] & 0xC0) == 0x80) ++at;
      return at;
    };
    return whole.substr(0, character(longest - end)) + "..." + whole.substr(character(whole.size() - end));
  };
  std::string line;
  for (std::size_t start = 0, end = 0; start < text.size(); start = end) {
    end = std::min(text.find(' ', start + 1), text.size());
    line += shortened(text.substr(start, end - start), kLongestWord, kWordEnd);
  }
  return one_line(shortened(line, kLongest, kEnd));
}

std::string beginning(std::string_view text, std::size_t longest) {
  std::string shown;
  for (const char c : text.substr(0, longest)) shown += c >= 0x20 && c < 0x7f ? c : '?';
  return text.size() > longest ? shown + "..." : shown;
}

}  // namespace standoff::cli
