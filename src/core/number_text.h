// Numbers in messages: of any size, in a few digits, with a point in every locale.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace standoff::collision {

/// "0.02", "1e+21".
inline std::string number_text(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 6).ptr;
  return {text.begin(), end};
}

}  // namespace standoff::collision
