// Text from outside as it may go to a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace standoff::cli {

/// Line ends become blanks and other control bytes '?': whatever a file is called or holds, a message stays one line,
/// whole, and moves no cursor.
inline std::string one_line(std::string text) {
  for (char& c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n' || c == '\r' || c == '\t')
      c = ' ';
    else if (byte < 0x20 || byte == 0x7f)
      c = '?';
  }
  return text;
}

/// A message's line: what stands in the middle of a very long one, such as an argument, is left out.
inline std::string message_line(const std::string& text) {
  constexpr std::size_t kLongest = 6000, kEnd = 1000;  // names of files have up to 4,095 bytes
  if (text.size() <= kLongest) return one_line(text);
  return one_line(text.substr(0, kLongest - kEnd) + "..." + text.substr(text.size() - kEnd));
}

/// The text's first characters, `longest` at the most; bytes that are not printable as '?'. For what a file holds.
inline std::string beginning(std::string_view text, std::size_t longest) {
  std::string shown;
  for (const char c : text.substr(0, longest)) shown += c >= 0x20 && c < 0x7f ? c : '?';
  return text.size() > longest ? shown + "..." : shown;
}

}  // namespace standoff::cli
