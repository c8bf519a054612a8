#include "io/shown.h"

namespace difi {

std::string shown(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown;
  for (const char c : text.substr(0, kLongest)) shown += c >= 0x20 && c < 0x7f ? c : '?';
  return text.size() > kLongest ? shown + "..." : shown;
}

std::string in_quotes(std::string_view text) {
  std::string quoted = "'";
  quoted += shown(text);
  return quoted += '\'';
}

}  // namespace difi
