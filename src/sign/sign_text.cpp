// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_text.h"

#include <algorithm>
#include <cmath>

#include "core/number_text.h"

namespace standoff {
namespace {

// Takes the first word from `text`.
std::string_view next_word(std::string_view& text) {
  const std::string_view word = text.substr(0, text.find(' '));
  text.remove_prefix(std::min(word.size() + 1, text.size()));
  return word;
}

}  // namespace

SignText sign_text_of(const SignOptions& options, const SignReport& report) {
  SignText text;
  text.method = report.method;
  if (text.method == SignMethod::none) return text;
  if (text.method == SignMethod::winding) text.rule = options.rule;
  if (text.method == SignMethod::shell) text.shell = options.shell;
  text.invert = options.invert;
  text.oriented = report.flipped > 0 || report.left_out > 0;
  text.outer = options.outer;
  return text;
}

std::string written(const SignText& text) {
  std::string words = name_of(text.method);
  if (words.empty()) return words;
  if (text.method == SignMethod::shell) words.append(1, ' ').append(exact_text(text.shell));
  if (text.rule == WindingRule::nonzero) words += " nonzero";
  if (text.rule == WindingRule::odd) words += " odd";
  if (text.oriented) words += " oriented";
  if (text.outer) words += " outer";
  if (text.invert) words += " inverted";
  return words;
}

std::optional<SignText> sign_text_in(std::string_view text) {
  SignText found;
  std::string_view rest = text;
  const std::string_view method = next_word(rest);
  for (const SignMethodInfo& info : kSignMethods)
    if (method == info.name && info.method != SignMethod::automatic) found.method = info.method;
  while (!rest.empty()) {
    const std::string_view word = next_word(rest);
    if (word == "nonzero") found.rule = WindingRule::nonzero;
    if (word == "odd") found.rule = WindingRule::odd;
    if (word == "oriented") found.oriented = true;
    if (word == "outer") found.outer = true;
    if (word == "inverted") found.invert = true;
    if (const auto number = number_in<double>(word)) found.shell = *number;
  }
  // Reject words that were passed over, repeated or in another order.
  if (found.method == SignMethod::none || written(found) != text) return std::nullopt;
  if (found.method == SignMethod::shell && !(found.shell > 0 && std::isfinite(found.shell))) return std::nullopt;
  if (found.outer && found.method != SignMethod::winding) return std::nullopt;
  return found;
}

}  // namespace standoff
