// SPDX-License-Identifier: Apache-2.0
// Pixels, the colors that they take, and the PNG file that they end in.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "render/float3.h"
#include "standoff/color.h"
#include "standoff/colormap.h"
#include "standoff/existing.h"

namespace standoff {

/// Rows from the top, pixels from the left, without gaps.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Color> pixels;
  std::vector<std::uint8_t> alpha = {};  ///< of each pixel; empty: all are opaque

  Image(int w, int h, Color background)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), background) {}
  Color& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  const Color& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
  /// Colors a pixel, if it lies in the picture.
  void set(int x, int y, Color color) {
    if (x >= 0 && x < width && y >= 0 && y < height) at(x, y) = color;
  }
  /// Mixes a share of a color, 0 to 1, into a pixel, if it lies in the picture.
  void blend(int x, int y, Color color, double share) {
    if (x < 0 || x >= width || y < 0 || y >= height) return;
    Color& pixel = at(x, y);
    for (std::size_t c = 0; c < 3; ++c)
      pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] * (1 - share) + color[c] * share));
  }
  /// Colors a rectangle, as much of it as lies in the picture.
  void fill(int x, int y, int w, int h, Color color) {
    for (int row = y; row < y + h; ++row)
      for (int column = x; column < x + w; ++column) set(column, row, color);
  }
};

/// The picture that lies on white and on black paper, without paper: what differs between both shines through.
Image without_paper(const Image& on_white, const Image& on_black);

/// Throws Error{usage} when this build cannot write pictures; call it before drawing one.
void require_png();

/// The bytes of a PNG file. Errors: usage (built without libpng).
std::vector<std::uint8_t> png_of(const Image& image);
/// Writes a PNG file, whole or not at all. Errors: as above; output.
void write_png(const std::filesystem::path& path, const Image& image, Existing existing);

/// The colors of a picture besides those of its subject.
struct Theme {
  Color paper;    ///< the background
  Color ink;      ///< words and lines
  Color faint;    ///< words and lines of less weight
  Color outside;  ///< samples beyond the band
  Color inside;   ///< samples beyond the band, inside
  Color nothing;  ///< values that are no numbers
};

/// The colors on white or dark.
constexpr Theme theme_of(Background background) {
  if (background == Background::dark)
    return {{17, 19, 24}, {228, 231, 237}, {146, 153, 166}, {52, 56, 64}, {34, 37, 43}, {128, 60, 96}};
  return {{255, 255, 255}, {40, 44, 52}, {110, 116, 126}, {222, 225, 230}, {186, 191, 199}, {214, 160, 186}};
}

/// The color of `t` in [0, 1]; values outside count as the nearer end. `automatic` counts as viridis: a number has no
/// sign.
Color color_of(Colormap map, double t);

/// A color of a file in linear light, in which colors are added, and back. Components outside [0, 1] count as the
/// nearer end.
Float3 linear_of(Color color);
Color color_of_light(Float3 linear);

}  // namespace standoff
