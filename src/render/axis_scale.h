// SPDX-License-Identifier: Apache-2.0
// World units along the edges of a plane.
#pragma once

#include <string>
#include <vector>

#include "render/image.h"
#include "render/theme.h"
#include "render/ticks.h"

namespace standoff {

/// Round numbers and the name of an axis, along one edge of a picture of samples.
class AxisScale {
 public:
  AxisScale() = default;
  /// `count` samples from `first` on, `step` world units apart, over `pixels` pixels: a sample is in the middle of its
  /// square. At scale 1 words have 13 pixels.
  AxisScale(std::string name, double first, double step, std::int64_t count, int pixels, double scale);

  const std::vector<Tick>& ticks() const { return ticks_; }
  /// Pixels from a number to the edge's left end, so many from the edge's first pixel on.
  double place_of(double value) const;
  /// What the scale takes to the left of an upright edge, and below a level one.
  double widest() const;
  int height() const;
  /// Below an edge from (x, y) to the right.
  void draw_below(Image& image, int x, int y, const Theme& theme) const;
  /// Left of an edge from (x, y) upwards, its name above.
  void draw_beside(Image& image, int x, int y, const Theme& theme) const;

 private:
  double widest_label() const;

  std::string name_;
  double first_ = 0, step_ = 1, count_ = 1;
  int pixels_ = 1;
  double scale_ = 1;
  std::vector<Tick> ticks_;
};

}  // namespace standoff
