// SPDX-License-Identifier: Apache-2.0
// One tile of a picture: which triangle each sample shows, and the colors that come of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/bins.h"
#include "render/image.h"
#include "render/light.h"

namespace standoff {

/// Draws tiles, one after the other, in memory that it keeps.
class TileDrawer {
 public:
  TileDrawer(std::span<const SeenPart> parts, std::span<const SamplePlace> places);

  /// Draws what the bins hold for a tile, over the image's colors there.
  void draw(const Bins& opaque, const Bins& clear, int tile, const Scenery& scenery, Image& image);

 private:
  static constexpr std::uint32_t kNothing = 0xFFFFFFFF;
  // What a see-through triangle covers of a pixel.
  struct Fragment {
    std::uint32_t pixel, triangle;
    std::uint32_t mask;
    float depth;
  };

  template <class Covered>
  void for_pixels_of(const SeenPart& part, std::uint32_t triangle, const Covered& covered) const;
  bool hides(const PixelRange& pixels, float nearest) const;
  void find_nearest(const Bins& opaque, int tile);
  void find_fragments(const Bins& clear, int tile);
  void color_pixels(const Scenery& scenery, Image& image);
  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y - range_.top) * kTilePixels + static_cast<std::size_t>(x - range_.left);
  }
  Shader::Seen seen(Shader& shader, std::uint32_t triangle, int x, int y, std::uint32_t mask) const;
  const SeenPart& part_of(std::uint32_t triangle) const;

  std::span<const SeenPart> parts_;
  std::span<const SamplePlace> places_;
  PixelRange places_box_;
  PixelRange range_;
  std::vector<float> depths_;             // of each pixel's samples; 0: nothing
  std::vector<std::uint32_t> triangles_;  // which is nearest there, by its number among those of all parts
  std::vector<Fragment> fragments_;
};

}  // namespace standoff
