// Numbers and hashes as the text headers of field files spell them.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace standoff {

/// Characters of a method or version that are read: far more than any has.
constexpr std::uint64_t kMaxText = 4096;

/// The shortest text that reads back as the same number; "inf" for infinity.
std::string text_of(double number);
/// "0x" and 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);
std::optional<std::uint64_t> hash_in(std::string_view text);

std::string_view trimmed(std::string_view text);
/// The parts between spaces and the like.
std::vector<std::string_view> words_of(std::string_view text);

/// The number that is the whole text, or nothing. Doubles may be "inf" and "nan".
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace standoff
