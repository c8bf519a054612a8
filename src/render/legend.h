// SPDX-License-Identifier: Apache-2.0
// A bar of colors with numbers beside it.
#pragma once

#include <string>
#include <vector>

#include "render/image.h"
#include "render/theme.h"
#include "render/ticks.h"
#include "standoff/colormap.h"

namespace standoff {

/// What the colors of a picture's numbers mean.
class Legend {
 public:
  /// From the least to the greatest value. Those of magnitude `thickness` stand for themselves and all beyond: they are
  /// grey, at the ends of the bar. Colors of Colormap::diverging have their middle at 0, and reach equally far to both
  /// sides. `heading` says above the bar what the numbers are.
  Legend(double least, double greatest, double thickness, Colormap map, const Theme& theme, std::string heading);

  /// A value's color.
  Color color(double value) const;
  /// The same, for values in the band: those beyond it have the color of its end.
  Color band_color(double value) const;
  /// The round numbers beside the bar that lie between its ends.
  const std::vector<Tick>& ticks() const { return ticks_; }
  /// Pixels from the bar's left edge to the end of the longest words, if all is drawn at `scale`.
  int width(double scale) const;
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

}  // namespace standoff
