// SPDX-License-Identifier: Apache-2.0
#include "render/axis_scale.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/text.h"

namespace standoff {
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
  // As many as have room beside one another: so are they below one another.
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

}  // namespace standoff
