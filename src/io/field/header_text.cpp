#include "io/field/header_text.h"

#include <array>

namespace standoff {
namespace {
constexpr std::string_view kSpace = " \t\r\n\v\f";
}

std::string text_of(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

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

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) + 1 - first);
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (!(text = trimmed(text)).empty()) {
    const auto end = std::min(text.find_first_of(kSpace), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return words;
}

}  // namespace standoff
