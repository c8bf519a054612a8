// SPDX-License-Identifier: Apache-2.0
// Filled triangles with a depth test.
#pragma once

#include <vector>

#include "render/camera.h"
#include "render/image.h"

namespace standoff {

/// An image with a depth per pixel; the nearest triangle wins, the first drawn on ties.
class Raster {
 public:
  Raster(int width, int height, Color background);

  /// Draws a triangle in one color, either winding. Pixels count as inside when their centre is, edges included: exact
  /// in integers, so that neighbours leave no gap. Corners must lie within 2^30 subpixels.
  void draw(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, Color color);

  const Image& image() const { return image_; }
  /// Depths as ScreenPoint counts them, row by row; -infinity where nothing was drawn.
  const std::vector<float>& depths() const { return depths_; }

 private:
  Image image_;
  std::vector<float> depths_;
};

/// Half the width and height, each pixel the mean of four. Requires even sizes.
Image halved(const Image& image);

}  // namespace standoff
