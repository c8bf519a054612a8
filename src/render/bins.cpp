// SPDX-License-Identifier: Apache-2.0
#include "render/bins.h"

#include <tbb/parallel_for.h>

namespace standoff {
namespace {

constexpr std::uint32_t kChunk = 1 << 15;  // triangles: some hundred microseconds

struct Entry {
  std::uint32_t tile, triangle;
};

// Whether all of a tile lies on the outer side of one of the triangle's edges.
bool misses(const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c, std::int64_t area, std::int32_t left,
            std::int32_t top) {
  constexpr std::int32_t kSide = kTilePixels * kSubpixels;
  const auto outside = [&](const ScreenPoint& from, const ScreenPoint& to) {
    const std::int64_t dx = std::int64_t{to.x} - from.x, dy = std::int64_t{to.y} - from.y;
    const auto at = [&](std::int64_t x, std::int64_t y) {
      const std::int64_t value = dx * (y - from.y) - dy * (x - from.x);
      return area > 0 ? value < 0 : value > 0;
    };
    return at(left, top) && at(left + kSide, top) && at(left, top + kSide) && at(left + kSide, top + kSide);
  };
  return outside(a, b) || outside(b, c) || outside(c, a);
}

}  // namespace

Bins::Bins(int width, int height)
    : width_(width),
      height_(height),
      across_((width + kTilePixels - 1) / kTilePixels),
      down_((height + kTilePixels - 1) / kTilePixels) {}

PixelRange Bins::pixels(int tile) const {
  const int left = tile % across_ * kTilePixels, top = tile / across_ * kTilePixels;
  return {left, top, std::min(left + kTilePixels, width_) - 1, std::min(top + kTilePixels, height_) - 1};
}

void Bins::add_chunks(const SeenPart& part) {
  const auto count = static_cast<std::uint32_t>(part.part->triangles.size());
  for (std::uint32_t begin = 0; begin < count; begin += std::min(kChunk, count - begin))
    chunks_.push_back({&part, begin, begin + std::min(kChunk, count - begin), {}, {}});
}

void Bins::fill(const PixelRange& places) {
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t n) { sort(chunks_[n], places); });
}

void Bins::sort(Chunk& chunk, const PixelRange& places) const {
  const PixelRange picture{0, 0, width_ - 1, height_ - 1};
  std::vector<Entry> entries;
  entries.reserve(chunk.end - chunk.begin);
  chunk.starts.assign(static_cast<std::size_t>(tiles()) + 1, 0);
  const auto add = [&](int tile, std::uint32_t triangle) {
    entries.push_back({static_cast<std::uint32_t>(tile), triangle});
    ++chunk.starts[static_cast<std::size_t>(tile) + 1];
  };
  for (std::uint32_t t = chunk.begin; t < chunk.end; ++t) {
    const Triangle v = chunk.part->part->triangles[t];
    const ScreenPoint &a = chunk.part->points[v[0]], &b = chunk.part->points[v[1]], &c = chunk.part->points[v[2]];
    const PixelRange range = pixels_of(a, b, c, places).within(picture);
    if (range.empty()) continue;
    const std::int64_t area = twice_area(a, b, c);
    if (area == 0) continue;
    const PixelRange in_tiles{range.left / kTilePixels, range.top / kTilePixels, range.right / kTilePixels,
                              range.bottom / kTilePixels};
    const bool large = in_tiles.left < in_tiles.right && in_tiles.top < in_tiles.bottom;
    for (int y = in_tiles.top; y <= in_tiles.bottom; ++y)
      for (int x = in_tiles.left; x <= in_tiles.right; ++x) {
        constexpr std::int32_t kSide = kTilePixels * kSubpixels;
        if (!large || !misses(a, b, c, area, x * kSide, y * kSide)) add(y * across_ + x, t);
      }
  }
  for (std::size_t n = 1; n < chunk.starts.size(); ++n) chunk.starts[n] += chunk.starts[n - 1];
  chunk.triangles.resize(entries.size());
  std::vector<std::uint32_t> next(chunk.starts.begin(), chunk.starts.end() - 1);
  for (const Entry& entry : entries) chunk.triangles[next[entry.tile]++] = entry.triangle;
}

}  // namespace standoff
