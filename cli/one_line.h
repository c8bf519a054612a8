// Text from outside as it may go to a terminal.
#pragma once

#include <string>

namespace difi::cli {

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

}  // namespace difi::cli
