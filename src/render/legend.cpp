// SPDX-License-Identifier: Apache-2.0
#include "render/legend.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/colormap.h"
#include "render/srgb.h"
#include "render/text.h"

namespace standoff {
namespace {

// Pixels at scale 1.
constexpr double kTextSize = 14, kBarWidth = 22, kTickLength = 5, kTickGap = 6, kHeading = 24, kCap = 14, kCapGap = 3;
constexpr int kLegendSteps = 8;  // between the ends, at most

int scaled(double length, double scale) { return static_cast<int>(std::lround(length * scale)); }

// In so many digits that it differs from its neighbours on the scale.
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

// Beside a height of the bar.
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

}  // namespace standoff
