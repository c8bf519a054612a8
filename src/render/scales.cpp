// SPDX-License-Identifier: Apache-2.0
#include "render/scales.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "render/image.h"
#include "render/text.h"

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
      // An end that misses a multiple by a rounding error counts.
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

namespace {

// Pixels at scale 1.
constexpr double kScaleText = 13, kTick = 5, kScaleGap = 5, kApart = 18, kNameLine = 20;
constexpr int kMostSteps = 8;  // steps

}  // namespace

AxisScale::AxisScale(std::string name, double first, double step, std::int64_t count, int pixels, double scale)
    : name_(std::move(name)),
      first_(first),
      step_(step),
      count_(static_cast<double>(count)),
      pixels_(pixels),
      scale_(scale) {
  // Half a sample lies beyond the outermost ones.
  const double least = first - step / 2, greatest = first + step * (count_ - 0.5);
  // Take as many ticks as have room beside one another: they have room below one another then.
  for (int most = kMostSteps; most >= 1; --most) {
    ticks_ = even_ticks(least, greatest, most);
    if (ticks_.size() < 2) continue;
    const double apart = std::abs(place_of(ticks_[1].value) - place_of(ticks_[0].value));
    if (widest_label() + kApart * scale_ <= apart) return;
  }
  if (widest_label() > pixels_) ticks_.clear();
}

double AxisScale::place_of(double value) const { return ((value - first_) / step_ + 0.5) * (pixels_ / count_); }

double AxisScale::widest_label() const {
  double widest = 0;
  for (const Tick& tick : ticks_) widest = std::max(widest, text_width(tick.label, kScaleText * scale_));
  return widest;
}

double AxisScale::widest() const {
  const double ticks = widest_label() + (kTick + kScaleGap) * scale_;
  return std::max(ticks, text_width(name_, kScaleText * scale_));
}

int AxisScale::height() const {
  return static_cast<int>(std::ceil((kTick + kScaleGap + kNameLine) * scale_ + cap_height(kScaleText * scale_)));
}

void AxisScale::draw_below(Image& image, int x, int y, const Theme& theme) const {
  const double size = kScaleText * scale_, baseline = y + (kTick + kScaleGap) * scale_ + cap_height(size);
  const int line = std::max(1, static_cast<int>(std::lround(scale_)));
  for (const Tick& tick : ticks_) {
    const double place = x + place_of(tick.value), width = text_width(tick.label, size);
    image.fill(static_cast<int>(std::floor(place - (line - 1) / 2.0)), y, line,
               static_cast<int>(std::lround(kTick * scale_)), theme.faint);
    // The outermost numbers stay in the picture.
    const double left = std::clamp(place - width / 2, 0.0, std::max(0.0, image.width - width));
    draw_text(image, left, baseline, tick.label, size, theme.faint);
  }
  const double middle = x + pixels_ / 2.0 - text_width(name_, size) / 2;
  draw_text(image, std::max(0.0, middle), baseline + kNameLine * scale_, name_, size, theme.ink);
}

void AxisScale::draw_beside(Image& image, int x, int y, const Theme& theme) const {
  const double size = kScaleText * scale_;
  const int line = std::max(1, static_cast<int>(std::lround(scale_))),
            length = static_cast<int>(std::lround(kTick * scale_));
  for (const Tick& tick : ticks_) {
    const double place = y - place_of(tick.value);
    image.fill(x - length, static_cast<int>(std::floor(place - (line - 1) / 2.0)), length, line, theme.faint);
    const double right = x - (kTick + kScaleGap) * scale_;
    draw_text(image, right - text_width(tick.label, size), place + cap_height(size) / 2, tick.label, size, theme.faint);
  }
  const double baseline = y - pixels_ - 12 * scale_;
  draw_text(image, x - text_width(name_, size), baseline, name_, size, theme.ink);
}

namespace {

// Pixels at scale 1.
constexpr double kTextSize = 14, kBarWidth = 22, kTickLength = 5, kTickGap = 6, kHeading = 24, kCap = 14, kCapGap = 3;
constexpr int kLegendSteps = 8;  // between the ends, at most

int scaled(double length, double scale) { return static_cast<int>(std::lround(length * scale)); }

// The label of an end, in so many digits that it differs from its neighbours on the scale.
std::string end_label(double value, double range) {
  const double size = std::abs(value);
  // On the scale, the least distance to a surface is the zero it stands for.
  if (range > 0 && size < range * 2e-3) return "0";
  const int digits = range > 0 ? static_cast<int>(std::log10(size / range)) + 3 : 6;
  return short_text(value, std::clamp(digits, 3, 9));
}

}  // namespace

Legend::Legend(double least, double greatest, double thickness, Colormap map, const Theme& theme, std::string heading)
    : least_(least),
      greatest_(greatest),
      map_(map),
      theme_(theme),
      beyond_outside_(greatest >= thickness),
      beyond_inside_(least <= -thickness),
      clamped_(thickness),
      heading_(std::move(heading)) {
  const double range = greatest - least;
  least_label_ = (beyond_inside_ ? "≤ " : "") + end_label(least, range);
  greatest_label_ = (beyond_outside_ ? "≥ " : "") + end_label(greatest, range);
  for (Tick& tick : even_ticks(least, greatest, kLegendSteps))
    if (tick.value > least && tick.value < greatest) ticks_.push_back(std::move(tick));
}

Color Legend::color(double value) const {
  if (std::isnan(value)) return theme_.nothing;
  if (value >= clamped_ || (std::isinf(value) && value > 0)) return theme_.outside;
  if (value <= -clamped_ || std::isinf(value)) return theme_.inside;
  return band_color(value);
}

Color Legend::band_color(double value) const {
  if (map_ == Colormap::diverging) {
    const double most = std::max(std::abs(least_), std::abs(greatest_));
    return color_of(map_, most > 0 ? 0.5 + 0.5 * (value / most) : 0.5);
  }
  return color_of(map_, greatest_ > least_ ? (value - least_) / (greatest_ - least_) : 0);
}

int Legend::width(double scale) const {
  double widest = 0;
  for (const Tick& tick : ticks_) widest = std::max(widest, text_width(tick.label, kTextSize * scale));
  for (const std::string* label : {&least_label_, &greatest_label_})
    widest = std::max(widest, text_width(*label, kTextSize * scale));
  const double bar = (kBarWidth + kTickLength + kTickGap) * scale + widest;
  return static_cast<int>(std::ceil(std::max(bar, text_width(heading_, kTextSize * scale))));
}

Color Legend::over_paper(Color color) const {
  if (outside_opacity_ >= 1) return color;
  return color_of_light(linear_of(theme_.paper) * (1 - outside_opacity_) + linear_of(color) * outside_opacity_);
}

// Writes a label to the right of the bar.
void Legend::draw_label(Image& image, double x, double y, const std::string& label, double scale) const {
  const double size = kTextSize * scale;
  draw_text(image, x + (kBarWidth + kTickLength + kTickGap) * scale, y + cap_height(size) / 2, label, size, theme_.ink);
}

void Legend::draw(Image& image, int x, int y, int height, double scale) const {
  const double size = kTextSize * scale;
  draw_text(image, x, y + cap_height(size), heading_, size, theme_.ink);
  const int cap = scaled(kCap, scale), gap = scaled(kCapGap, scale), width = scaled(kBarWidth, scale);
  int top = y + scaled(kHeading, scale), bottom = y + height;
  if (beyond_outside_) {
    image.fill(x, top, width, cap, over_paper(theme_.outside));
    draw_label(image, x, top + cap / 2.0, greatest_label_, scale);
    top += cap + gap;
  }
  if (beyond_inside_) {
    bottom -= cap + gap;
    image.fill(x, bottom + gap, width, cap, theme_.inside);
    draw_label(image, x, bottom + gap + cap / 2.0, least_label_, scale);
  }
  const int length = bottom - top, line = std::max(1, scaled(1, scale));
  for (int row = 0; row < length; ++row) {
    const double value = greatest_ > least_ ? greatest_ - (greatest_ - least_) * ((row + 0.5) / length) : greatest_;
    image.fill(x, top + row, width, 1, value < 0 ? band_color(value) : over_paper(band_color(value)));
  }
  const auto mark = [&](double value, const std::string& label, double room) {
    const double share = greatest_ > least_ ? (greatest_ - value) / (greatest_ - least_) : 0.5;
    const double row = top + share * length;
    if (row < top + room || row > bottom - room) return;
    image.fill(x + width, static_cast<int>(std::lround(row - line / 2.0)), scaled(kTickLength, scale), line,
               theme_.ink);
    draw_label(image, x, row, label, scale);
  };
  for (const Tick& tick : ticks_) mark(tick.value, tick.label, 1.1 * size);
  if (!beyond_outside_) mark(greatest_, greatest_label_, 0);
  if (!beyond_inside_ && greatest_ > least_) mark(least_, least_label_, 0);
}

namespace {

constexpr int kSteps = 1024;  // finer than colors of 8 bits differ
constexpr Color kGrey{178, 178, 178};

}  // namespace

Ramp::Ramp() : colors_{linear_of(kGrey), linear_of(kGrey)} {}

Ramp::Ramp(const Legend& legend, double least, double greatest, const Theme& theme) : least_(least) {
  for (int n = 0; n <= kSteps; ++n)
    colors_.push_back(linear_of(legend.band_color(least + (greatest - least) * n / kSteps)));
  colors_.push_back(linear_of(theme.nothing));
  per_unit_ = greatest > least ? kSteps / (greatest - least) : 0;
}

Float3 Ramp::color(float value) const {
  if (!std::isfinite(value)) return colors_.back();
  const double at = (value - least_) * per_unit_;
  if (!(at > 0)) return colors_.front();
  return colors_[static_cast<std::size_t>(std::min(at, static_cast<double>(kSteps)) + 0.5)];
}

}  // namespace standoff
