// SPDX-License-Identifier: Apache-2.0
// Numbers beside pictures: ticks at round numbers, scales along the edges of a slice, the legend of colors.
#pragma once

#include <string>
#include <vector>

#include "render/float3.h"
#include "render/image.h"
#include "standoff/colormap.h"

namespace standoff {

/// A mark on a scale, and the number beside it.
struct Tick {
  double value = 0;
  std::string label;
};

/// Multiples of 1, 2 or 5 times a power of ten from `least` to `greatest`, rising: as many as possible, but no more
/// than fit `most` steps. All labels have the same number of decimals, or all are multiples of one power of ten. None
/// where doubles are too coarse for them, or the range is empty or not finite.
std::vector<Tick> even_ticks(double least, double greatest, int most);

/// A number in at most so many significant digits: "0.3", "−12.5", "1.235×10⁶".
std::string short_text(double number, int digits);

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

/// A bar of colors with numbers beside it: what the colors of a picture mean.
class Legend {
 public:
  /// From the least to the greatest value. Values of magnitude `thickness` stand for themselves and all beyond: they
  /// are grey, at the ends of the bar. Colors of Colormap::diverging have their middle at 0, and reach equally far to
  /// both sides. `heading` says above the bar what the numbers are.
  Legend(double least, double greatest, double thickness, Colormap map, const Theme& theme, std::string heading);

  /// A value's color.
  Color color(double value) const;
  /// The same, for values in the band: those beyond it have the color of its end.
  Color band_color(double value) const;
  /// The round numbers beside the bar that lie between its ends.
  const std::vector<Tick>& ticks() const { return ticks_; }
  /// Pixels from the bar's left edge to the end of the longest words, if all is drawn at `scale`.
  int width(double scale) const;
  /// The greatest value stands for greater ones too.
  void end_early() {
    if (!beyond_outside_) greatest_label_ = "\u2265 " + greatest_label_;
  }
  /// Draws colors of values that are not negative as they look over paper with an opacity, 0 to 1.
  void show_through(double opacity) { outside_opacity_ = static_cast<float>(opacity); }
  /// Draws the bar and its words, `height` pixels high in all, the top left corner at (x, y). At scale 1 words have 14
  /// pixels.
  void draw(Image& image, int x, int y, int height, double scale) const;

 private:
  Color over_paper(Color color) const;
  void draw_label(Image& image, double x, double y, const std::string& label, double scale) const;

  double least_, greatest_;
  Colormap map_;
  Theme theme_;
  bool beyond_outside_, beyond_inside_;  // values at the ends stand for all beyond
  double clamped_;                       // the magnitude from which on they do
  std::string heading_, least_label_, greatest_label_;
  float outside_opacity_ = 1;
  std::vector<Tick> ticks_;
};

/// The colors of numbers in linear light, looked up in a table.
class Ramp {
 public:
  /// For pictures without numbers: all colors are grey.
  Ramp();
  Ramp(const Legend& legend, double least, double greatest, const Theme& theme);

  /// Numbers that are not finite have a color of their own.
  Float3 color(float value) const;

 private:
  std::vector<Float3> colors_;  // in even steps; the last is for what is no number
  double least_ = 0, per_unit_ = 0;
};

}  // namespace standoff
