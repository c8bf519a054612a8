// SPDX-License-Identifier: Apache-2.0
#include "files/shown.h"

namespace standoff {

std::string shown(std::string_view text, std::size_t longest) {
  std::string shown;
  for (const char c : text.substr(0, longest)) shown += c >= 0x20 && c < 0x7f ? c : '?';
  return text.size() > longest ? shown + "..." : shown;
}

std::string in_quotes(std::string_view text) {
  std::string quoted = "'";
  quoted += shown(text);
  return quoted += '\'';
}

}  // namespace standoff
