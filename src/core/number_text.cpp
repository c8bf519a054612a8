// SPDX-License-Identifier: Apache-2.0
#include "core/number_text.h"

#include <array>

namespace standoff {
namespace {

// Calls std::to_chars with room for every double without exponent.
template <class... Arguments>
std::string written(Arguments... arguments) {
  std::array<char, 320> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), arguments...).ptr};
}

}  // namespace

std::string number_text(double value) { return written(value, std::chars_format::general, 6); }
std::string exact_text(double value) { return written(value); }
std::string exact_text(float value) { return written(value); }
std::string whole_text(double value) { return written(value, std::chars_format::fixed, 0); }

std::string hash_text(std::uint64_t hash) {
  std::string text = "0x0000000000000000";
  for (std::size_t digit = text.size() - 1; hash != 0; hash >>= 4, --digit) text[digit] = "0123456789abcdef"[hash & 15];
  return text;
}

std::optional<std::uint64_t> hash_in(std::string_view text) {
  if (!text.starts_with("0x")) return std::nullopt;
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data() + 2, text.data() + text.size(), hash, 16);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return hash;
}

std::string axis_text(std::optional<Axis> axis) { return axis ? std::string(1, name_of(*axis)) : ""; }

std::optional<Axis> axis_in(std::string_view text) {
  if (text.size() != 1 || text[0] < 'x' || text[0] > 'z') return std::nullopt;
  return static_cast<Axis>(text[0] - 'x');
}

}  // namespace standoff
