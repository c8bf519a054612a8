// SPDX-License-Identifier: Apache-2.0
// The colors of numbers in linear light, looked up.
#pragma once

#include <vector>

#include "render/float3.h"
#include "render/legend.h"
#include "render/theme.h"

namespace standoff {

class Ramp {
 public:
  /// Of no numbers: all are grey.
  Ramp();
  Ramp(const Legend& legend, double least, double greatest, const Theme& theme);

  /// Numbers that are not finite have a color of their own.
  Float3 color(float value) const;

 private:
  std::vector<Float3> colors_;  // in even steps; and that of no number
  double least_ = 0, per_unit_ = 0;
};

}  // namespace standoff
