// SPDX-License-Identifier: Apache-2.0
#include "render/ramp.h"

#include "render/srgb.h"

namespace standoff {
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
