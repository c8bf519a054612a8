// SPDX-License-Identifier: Apache-2.0
// A picture is drawn in tiles: which triangles fall on which tile, and the colors of a tile's pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/image.h"
#include "render/light.h"
#include "render/part.h"
#include "render/screen_triangle.h"

namespace standoff {

/// Each tile is a square with so many pixels on each side. One thread draws it: its samples stay in a core's cache.
inline constexpr int kTilePixels = 64;

/// The picture's tiles, and for each tile the triangles that may show in it, in ascending order of their numbers.
class Bins {
 public:
  /// Sorts all triangles of the parts that `wanted` accepts.
  template <class Wanted>
  Bins(std::span<const SeenPart> parts, int width, int height, std::span<const SamplePlace> places,
       const Wanted& wanted)
      : Bins(width, height) {
    for (const SeenPart& part : parts)
      if (wanted(*part.part)) add_chunks(part);
    fill(box_of(places));
  }

  int tiles() const { return across_ * down_; }
  /// The pixels of a tile.
  PixelRange pixels(int tile) const;
  bool empty() const { return chunks_.empty(); }
  /// Calls visit(part, triangle) for each triangle of a tile; `triangle` is its index in the part.
  template <class Visit>
  void for_each(int tile, const Visit& visit) const {
    for (const Chunk& chunk : chunks_)
      for (std::uint32_t n = chunk.starts[tile]; n < chunk.starts[tile + 1]; ++n)
        visit(*chunk.part, chunk.triangles[n]);
  }

 private:
  // Neighbouring triangles of a part, sorted by one thread.
  struct Chunk {
    const SeenPart* part;
    std::uint32_t begin, end;
    std::vector<std::uint32_t> starts;  // of each tile in `triangles`, and the end
    std::vector<std::uint32_t> triangles;
  };

  Bins(int width, int height);
  void add_chunks(const SeenPart& part);
  void fill(const PixelRange& places);
  void sort(Chunk& chunk, const PixelRange& places) const;

  int width_, height_, across_, down_;
  std::vector<Chunk> chunks_;
};

/// Draws tiles, one after the other, in memory that it keeps.
class TileDrawer {
 public:
  TileDrawer(std::span<const SeenPart> parts, std::span<const SamplePlace> places);

  /// Draws what the bins hold for a tile, over the image's colors there.
  void draw(const Bins& opaque, const Bins& clear, int tile, const Scenery& scenery, Image& image);

 private:
  static constexpr std::uint32_t kNothing = 0xFFFFFFFF;
  // The samples of a pixel that a see-through triangle covers.
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
