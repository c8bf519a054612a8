// SPDX-License-Identifier: Apache-2.0
// Text as it may go to a terminal: numbers as people read them, and what comes from outside made harmless.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "standoff/vec.h"

namespace standoff::cli {

/// 1234567 -> "1,234,567".
std::string grouped(std::int64_t n);
/// "1 triangle", "1,234 triangles".
std::string counted(std::int64_t n, const std::string& noun);
/// Six significant digits: "0.00614", "1e-07", "inf".
std::string number(double value);
/// As many digits as it takes to get the same double back.
std::string exact_number(double value);
/// "0.1", or "0.1 x 0.1 x 0.2" where the components differ.
std::string spacing_text(Vec3 spacing);
/// "256 x 254 x 199".
std::string size_text(Size3 size);
/// "(0, 1, 2.5)".
std::string point_text(Vec3 point);
/// Binary units: "51.2 MiB".
std::string bytes_text(std::int64_t bytes);
/// "0.42 s", "3 min 07 s".
std::string seconds_text(double seconds);
/// Seconds from then until now.
inline double seconds_since(std::chrono::steady_clock::time_point then) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}
/// Sixteen hexadecimal digits.
std::string hash_text(std::uint64_t hash);

/// "a, b or c".
std::string joined(const std::vector<std::string>& names);
/// The text with line ends in place of blanks, so that no line is longer than `columns`, as far as its words allow.
std::string wrapped(std::string text, std::size_t columns);
/// Columns of the texts of options.
inline constexpr std::size_t kHelpColumns = 60;

/// Line ends become blanks and other control bytes '?': whatever a file is called or holds, a message stays one line,
/// whole, and moves no cursor.
std::string one_line(std::string text);
/// A message's line: what stands in the middle of a very long word, such as a name, or of a very long line is left out.
std::string message_line(const std::string& text);
/// The text's first characters, `longest` at the most; bytes that are not printable as '?'. For what a file holds.
std::string beginning(std::string_view text, std::size_t longest);

}  // namespace standoff::cli
