// SPDX-License-Identifier: Apache-2.0
// How much of each pixel an outline covers.
#pragma once

#include <vector>

namespace standoff {

/// A window of pixels that closed outlines are drawn into, line by line. What they wind around once, either way, counts
/// as covered. Exact but for rounding: a pixel's share is the area of its square inside the outline.
class Coverage {
 public:
  Coverage(int width, int height);

  /// A line of an outline, in pixels from the window's top left corner. All of an outline's lines must be added, also
  /// those outside the window; any finite numbers are fine.
  void add_line(double x0, double y0, double x1, double y1);
  /// The shares of all pixels from 0 to 1, row by row.
  std::vector<float> shares() const;

 private:
  void add_in_row(int row, double x0, double x1, double height);

  int width_, height_;
  // The change of the covered share from the pixel before; one more in a row than pixels.
  std::vector<double> changes_;
};

}  // namespace standoff
