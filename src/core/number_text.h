// SPDX-License-Identifier: Apache-2.0
// Numbers as text and back, with a point in every locale.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "standoff/axis.h"

namespace standoff {

/// Text for people, with six digits: "0.02", "1e+21".
std::string number_text(double value);
/// The shortest text that reads back as the same number; "inf" for infinity.
std::string exact_text(double value);
std::string exact_text(float value);
/// The number rounded to a whole one, without exponent: "300000000000000000000000".
std::string whole_text(double value);
/// "0x" and 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);
std::optional<std::uint64_t> hash_in(std::string_view text);
/// "x", "y" or "z"; empty: none.
std::string axis_text(std::optional<Axis> axis);
std::optional<Axis> axis_in(std::string_view text);

/// Reads a number; nothing unless it is the whole text. Doubles may be "inf" and "nan".
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace standoff
