// SPDX-License-Identifier: Apache-2.0
#include "render/ticks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace standoff {
namespace {

constexpr std::string_view kMinus = "\u2212", kTimesTen = "\u00D710";
// Beyond these exponents of the largest number, numbers are written with a power of ten.
constexpr int kLeastPlain = -3, kMostPlain = 5;
constexpr double kLeastStep = 1e-300, kMostStep = 1e307;
constexpr double kExact = 0x1p53;  // whole numbers up to this are doubles

std::string raised(int exponent) {
  static constexpr std::array<std::string_view, 10> kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text(kTimesTen);
  if (exponent < 0) text += "⁻";
  for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[static_cast<std::size_t>(digit - '0')];
  return text;
}

// whole * 10^exponent, rounded once: the C library's pow may differ from machine to machine.
double decimal(std::int64_t whole, int exponent) {
  const std::string text = std::to_string(whole) + "e" + std::to_string(exponent);
  double value = 0;
  // Out of range means too small here: all that is asked for lies within a range of doubles.
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// whole / 10^decimals in digits.
std::string fixed(std::int64_t whole, int decimals) {
  const auto places = static_cast<std::size_t>(std::max(0, decimals));
  std::string digits =
      std::to_string(std::abs(whole)) + std::string(static_cast<std::size_t>(std::max(0, -decimals)), '0');
  if (digits.size() <= places) digits = std::string(places + 1 - digits.size(), '0') + digits;
  std::string text(whole < 0 ? kMinus : "");
  text += digits.substr(0, digits.size() - places);
  if (places > 0) text.append(1, '.').append(digits, digits.size() - places);
  return text;
}

struct Step {
  int factor, exponent;
  double first, last;  // the range in steps
};

// The least step of which at most so many fit into the range.
Step step_for(double least, double greatest, int most) {
  const double wanted = greatest / most - least / most;
  // From a little below, so that a logarithm that is rounded the wrong way makes no difference.
  for (int exponent = static_cast<int>(std::floor(std::log10(wanted))) - 1;; ++exponent)
    for (const int factor : {1, 2, 5}) {
      const double step = decimal(factor, exponent);
      if (step < wanted * (1 - 1e-12)) continue;
      // Ends that are multiples but for rounding errors count.
      return {factor, exponent, std::ceil(least / step - 1e-9), std::floor(greatest / step + 1e-9)};
    }
}

}  // namespace

std::vector<Tick> even_ticks(double least, double greatest, int most) {
  if (!(least < greatest) || !std::isfinite(least) || !std::isfinite(greatest) || most < 1) return {};
  // Outside these bounds no step is a double: looking for one would not end.
  const double wanted = greatest / most - least / most;
  if (!(wanted > kLeastStep && wanted < kMostStep)) return {};
  const auto [factor, exponent, first, last] = step_for(least, greatest, most);
  if (std::max(std::abs(first), std::abs(last)) * factor > kExact) return {};
  const auto from = static_cast<std::int64_t>(first), to = static_cast<std::int64_t>(last);
  const std::int64_t largest = std::max(std::abs(from), std::abs(to)) * factor;
  const int size = exponent + static_cast<int>(std::to_string(largest).size()) - 1;
  const bool plain = largest == 0 || (size >= kLeastPlain && size <= kMostPlain);
  std::vector<Tick> ticks;
  for (std::int64_t n = from; n <= to; ++n) {
    const std::int64_t whole = n * factor;
    const std::string label = whole == 0 ? "0"
                              : plain    ? fixed(whole, -exponent)
                                         : fixed(whole, size - exponent) + raised(size);
    ticks.push_back({decimal(whole, exponent), label});
  }
  return ticks;
}

std::string short_text(double number, int digits) {
  // Not printf, which writes a comma where the program that draws has set such a locale.
  std::array<char, 40> buffer;
  const auto written = [&](std::chars_format format, int precision) {
    const double value = number == 0 ? 0.0 : number;
    return std::string(buffer.begin(), std::to_chars(buffer.begin(), buffer.end(), value, format, precision).ptr);
  };
  std::string text = written(std::chars_format::general, digits);
  if (const auto e = text.find('e'); e != std::string::npos) {
    const int exponent = std::atoi(text.c_str() + e + 1);
    // As ticks are written beside it.
    text = exponent >= kLeastPlain && exponent <= kMostPlain
               ? written(std::chars_format::fixed, std::max(0, digits - 1 - exponent))
               : text.substr(0, e) + raised(exponent);
  }
  if (text.starts_with('-')) text.replace(0, 1, kMinus);
  return text;
}

}  // namespace standoff
