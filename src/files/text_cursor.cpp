// SPDX-License-Identifier: Apache-2.0
#include "files/text_cursor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace standoff {

bool equals_ignoring_case(std::string_view text, std::string_view lower) {
  return std::equal(text.begin(), text.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

double beyond_range(std::string_view text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  const std::string_view digits = text.substr(0, e);
  const auto point = static_cast<std::int64_t>(std::min(digits.find('.'), digits.size()));
  const auto first = static_cast<std::int64_t>(std::min(digits.find_first_of("123456789"), digits.size()));
  const std::int64_t power = first < point ? point - first - 1 : point - first;  // of ten, of the first digit but 0
  std::string_view written = text.substr(std::min(e + 1, text.size()));
  if (written.starts_with('+')) written.remove_prefix(1);
  std::int64_t exponent = 0;
  const auto error = std::from_chars(written.data(), written.data() + written.size(), exponent).ec;
  const bool small = error == std::errc::result_out_of_range ? written[0] == '-' : exponent < -power;
  return small ? 0 : std::numeric_limits<double>::infinity();
}

bool TextCursor::continues(const char* place) const {
  return end_ - place >= 2 && place[0] == '\\' && is_line_end(place[1]);
}

std::string_view TextCursor::statement_word() {
  skip_blanks();
  const char* begin = at_;
  skip_word();
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

void TextCursor::skip_blanks() {
  for (;;) {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (!continues(at_)) return;
    ++at_;
    skip_line();
  }
}

void TextCursor::skip_line() {
  step();
  while (at_ != end_ && !is_line_end(*at_)) ++at_;
  take('\r');
  take('\n');
}

void TextCursor::skip_statement() {
  for (;;) {
    const char* begin = at_;
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    const bool continued = at_ != end_ && at_ != begin && at_[-1] == '\\';
    skip_line();
    if (!continued) return;
  }
}

template <class Number>
Number TextCursor::number() {
  step();
  constexpr bool integral = std::is_integral_v<Number>;
  const char* wanted = integral ? "a whole number" : "a number";
  // std::from_chars knows no plus.
  const bool plus = end_ - at_ > 1 && at_[0] == '+' && at_[1] != '-';
  Number value{};
  const auto [stop, error] = std::from_chars(at_ + plus, end_, value);
  if (error == std::errc::invalid_argument || !ends_word(stop)) fail_number(at_, wanted);
  if (error == std::errc::result_out_of_range) {
    if constexpr (integral) {
      fail_number(at_, "a smaller number");
    } else {
      // What is infinite is left to the check of all vertices.
      value = static_cast<Number>(beyond_range({at_, static_cast<std::size_t>(stop - at_)}));
    }
  }
  at_ = stop;
  return value;
}

template double TextCursor::number<double>();
template float TextCursor::number<float>();
template std::int64_t TextCursor::number<std::int64_t>();

std::int64_t TextCursor::integer_prefix() {
  step();
  std::int64_t value = 0;
  const auto [stop, error] = std::from_chars(at_, end_, value);
  if (error != std::errc{}) fail_number(at_, "a whole number");
  at_ = stop;
  return value;
}

void TextCursor::fail_number(const char* begin, const char* wanted) const {
  const char* stop = std::find_if(begin, end_, is_space);
  if (begin == stop) fail_at(begin, std::string(wanted) + " is missing; the file is cut off or damaged, get all of it");
  fail_at(begin, "expected " + std::string(wanted) + ", found " +
                     in_quotes({begin, static_cast<std::size_t>(stop - begin)}) +
                     "; write numbers like 12 or -1.5e3, decimals with a point");
}

std::uint64_t TextCursor::line_at(const char* place) const {
  std::uint64_t line = 1;
  for (const char* c = file_.bytes().data(); c != place; ++c)
    line += *c == '\n' || (*c == '\r' && (c + 1 == end_ || c[1] != '\n'));
  return line;
}

void TextCursor::fail_at(const char* place, const std::string& message) const {
  file_.fail("line " + std::to_string(line_at(place)), message);
}

}  // namespace standoff
