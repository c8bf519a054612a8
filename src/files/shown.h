// SPDX-License-Identifier: Apache-2.0
// Text of a file as messages show it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace standoff {

/// The text's first characters, `longest` at the most; bytes that are not printable as '?'. A file can hold anything,
/// also a megabyte without a space or what a terminal takes for a command.
std::string shown(std::string_view text, std::size_t longest = 40);

/// Its first 40 characters between quotes.
std::string in_quotes(std::string_view text);

}  // namespace standoff
