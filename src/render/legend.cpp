// SPDX-License-Identifier: Apache-2.0
#include "render/legend.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "render/colormap.h"
#include "render/text.h"

namespace standoff {
namespace {

constexpr Color kInk{40, 44, 52}, kGrey{178, 178, 178};
constexpr int kBarWidth = 24, kTickLength = 6, kTickGap = 5;
constexpr double kTextSize = 15;
constexpr int kSteps = 6;  // between the ends, at most

// 1, 2 or 5 times a power of ten, so that at most kSteps of them fit.
double even_step(double range) {
  const double least = range / kSteps, power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least) return factor * power;
  return 10 * power;
}

}  // namespace

std::string short_text(double number, int digits) {
  // Not printf, which writes a comma where the program that draws has set such a locale.
  std::array<char, 40> text;
  const auto end =
      std::to_chars(text.begin(), text.end(), number == 0 ? 0.0 : number, std::chars_format::general, digits).ptr;
  return {text.begin(), end};
}

Legend::Legend(double least, double greatest, double thickness, Colormap map)
    : least_(least), greatest_(greatest), map_(map) {
  const double range = greatest - least;
  // So many digits that neighbouring numbers differ.
  const double step = range > 0 ? even_step(range) : 1;
  const double largest = std::max(std::abs(least), std::abs(greatest));
  const int digits = range > 0 ? std::clamp(static_cast<int>(std::ceil(std::log10(largest / step))) + 2, 4, 9) : 6;
  // A distance of rounding errors is shown as the zero it stands for.
  const double fine = range > 0 ? step * 1e-3 : 0;
  const auto rounded = [fine](double number) { return fine > 0 ? std::round(number / fine) * fine : number; };
  ticks_.push_back({1, (greatest >= thickness ? "≥ " : "") + short_text(rounded(greatest), digits)});
  if (!(range > 0)) return;
  for (double n = std::floor(greatest / step); n * step > least && ticks_.size() < 2 * kSteps; --n)
    if (n * step < greatest) ticks_.push_back({(n * step - least) / range, short_text(n * step, digits)});
  ticks_.push_back({0, (least <= -thickness ? "≤ " : "") + short_text(rounded(least), digits)});
}

Color Legend::color(double value) const {
  if (!std::isfinite(value)) return kGrey;
  if (map_ == Colormap::diverging) {
    const double most = std::max(std::abs(least_), std::abs(greatest_));
    return color_of(map_, most > 0 ? 0.5 + 0.5 * (value / most) : 0.5);
  }
  return color_of(map_, greatest_ > least_ ? (value - least_) / (greatest_ - least_) : 0);
}

int Legend::width() const {
  int widest = 0;
  for (const Tick& tick : ticks_)
    widest = std::max(widest, static_cast<int>(std::ceil(text_width(tick.label, kTextSize))));
  return kBarWidth + kTickLength + kTickGap + widest;
}

void Legend::draw(Image& image, int x, int y, int height) const {
  image.fill(x - 1, y - 1, kBarWidth + 2, height + 2, kInk);
  for (int row = 0; row < height; ++row)
    image.fill(x, y + row, kBarWidth, 1, color_at(greatest_ > least_ ? 1 - (row + 0.5) / height : 0));
  const int letters = static_cast<int>(std::lround(cap_height(kTextSize))), room = letters + letters / 2;
  for (const Tick& tick : ticks_) {
    const int row = static_cast<int>(std::lround((1 - tick.share) * (height - 1)));
    const bool end = &tick == &ticks_.front() || &tick == &ticks_.back();
    if (!end && (row < room || row > height - 1 - room)) continue;
    image.fill(x + kBarWidth, y + row, kTickLength, 1, kInk);
    // The outermost numbers stay within the bar's height.
    const int baseline = std::clamp(row + letters / 2 + 1, letters, height);
    draw_text(image, x + kBarWidth + kTickLength + kTickGap, y + baseline, tick.label, kTextSize, kInk);
  }
}

}  // namespace standoff
