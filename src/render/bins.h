// SPDX-License-Identifier: Apache-2.0
// Which triangles fall on which tile of the picture.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/part.h"
#include "render/screen_triangle.h"

namespace standoff {

/// Pixels on each side of a square of the picture, which one thread draws: its samples stay in a core's cache.
inline constexpr int kTilePixels = 64;

/// A part, projected.
struct SeenPart {
  const DrawnPart* part = nullptr;
  std::vector<ScreenPoint> points;  ///< of the vertices
  std::uint32_t first = 0;          ///< the number of its first triangle among those of all parts
};

/// The picture's tiles, and the triangles of each, in ascending order of their numbers.
class Bins {
 public:
  /// Of all triangles of the parts that `wanted` accepts.
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

}  // namespace standoff
