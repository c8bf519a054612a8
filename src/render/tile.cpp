// SPDX-License-Identifier: Apache-2.0
#include "render/tile.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <tuple>

#include "render/image.h"

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

TileDrawer::TileDrawer(std::span<const SeenPart> parts, std::span<const SamplePlace> places)
    : parts_(parts),
      places_(places),
      places_box_(box_of(places)),
      depths_(std::size_t{kTilePixels} * kTilePixels * places.size()),
      triangles_(depths_.size()) {}

const SeenPart& TileDrawer::part_of(std::uint32_t triangle) const {
  return *(std::ranges::upper_bound(parts_, triangle, {}, &SeenPart::first) - 1);
}

// Whether all samples of some pixels show something nearer already. Looks at a few pixels only: small triangles are
// many, and of large ones something is usually seen.
bool TileDrawer::hides(const PixelRange& pixels, float nearest) const {
  constexpr int kFew = 3;
  if (pixels.right - pixels.left >= kFew || pixels.bottom - pixels.top >= kFew) return false;
  for (int y = pixels.top; y <= pixels.bottom; ++y) {
    const float* depth = depths_.data() + pixel(pixels.left, y) * places_.size();
    const float* const end = depths_.data() + (pixel(pixels.right, y) + 1) * places_.size();
    for (; depth != end; ++depth)
      if (nearest > *depth) return false;
  }
  return true;
}

// Calls covered(x, y, mask, plane) for each pixel of the tile of which a triangle covers samples that may show it.
template <class Covered>
void TileDrawer::for_pixels_of(const SeenPart& part, std::uint32_t triangle, const Covered& covered) const {
  const Triangle v = part.part->triangles[triangle];
  const ScreenPoint &a = part.points[v[0]], &b = part.points[v[1]], &c = part.points[v[2]];
  const PixelRange pixels = pixels_of(a, b, c, places_box_).within(range_);
  if (hides(pixels, std::max({a.depth, b.depth, c.depth}))) return;
  const std::int64_t area = twice_area(a, b, c);
  std::optional<DepthPlane> plane;  // most small triangles cover no sample
  for_covered_pixels(a, b, c, area, pixels, places_, [&](int x, int y, std::uint32_t mask) {
    if (!plane) plane.emplace(a, b, c, area);
    covered(x, y, mask, *plane);
  });
}

void TileDrawer::find_nearest(const Bins& opaque, int tile) {
  std::ranges::fill(depths_, 0.0F);
  std::ranges::fill(triangles_, kNothing);
  const std::size_t samples = places_.size();
  opaque.for_each(tile, [&](const SeenPart& part, std::uint32_t triangle) {
    for_pixels_of(part, triangle, [&](int x, int y, std::uint32_t mask, const DepthPlane& plane) {
      const std::size_t first = pixel(x, y) * samples;
      for (; mask != 0; mask &= mask - 1) {
        const auto s = static_cast<std::size_t>(std::countr_zero(mask));
        const float depth = plane.at(x * kSubpixels + places_[s].x, y * kSubpixels + places_[s].y);
        // Triangles come in ascending order: the first wins ties.
        if (!(depth > depths_[first + s])) continue;
        depths_[first + s] = depth;
        triangles_[first + s] = part.first + triangle;
      }
    });
  });
}

void TileDrawer::find_fragments(const Bins& clear, int tile) {
  fragments_.clear();
  const std::size_t samples = places_.size();
  clear.for_each(tile, [&](const SeenPart& part, std::uint32_t triangle) {
    for_pixels_of(part, triangle, [&](int x, int y, std::uint32_t mask, const DepthPlane& plane) {
      const std::size_t at = pixel(x, y);
      float nearest = 0;
      for (std::size_t s = 0; s < samples; ++s) {
        if (!(mask >> s & 1)) continue;
        const float depth = plane.at(x * kSubpixels + places_[s].x, y * kSubpixels + places_[s].y);
        if (depth > depths_[at * samples + s])
          nearest = std::max(nearest, depth);
        else
          mask &= ~(1U << s);
      }
      if (mask != 0) fragments_.push_back({static_cast<std::uint32_t>(at), part.first + triangle, mask, nearest});
    });
  });
  // From the back to the front; of equally deep ones the first is in front, as among opaque ones.
  std::ranges::sort(fragments_, [](const Fragment& f, const Fragment& g) {
    return std::tuple(f.pixel, f.depth, g.triangle) < std::tuple(g.pixel, g.depth, f.triangle);
  });
}

Shader::Seen TileDrawer::seen(Shader& shader, std::uint32_t triangle, int x, int y, std::uint32_t mask) const {
  // Looks at the middle of the covered samples, which lies within the triangle.
  std::int32_t sum_x = 0, sum_y = 0;
  const int count = std::popcount(mask);
  for (; mask != 0; mask &= mask - 1) {
    const SamplePlace& place = places_[static_cast<std::size_t>(std::countr_zero(mask))];
    sum_x += place.x, sum_y += place.y;
  }
  const SeenPart& part = part_of(triangle);
  return shader.seen(part, triangle - part.first,
                     static_cast<float>(x * kSubpixels) + static_cast<float>(sum_x) / static_cast<float>(count),
                     static_cast<float>(y * kSubpixels) + static_cast<float>(sum_y) / static_cast<float>(count));
}

void TileDrawer::color_pixels(const Scenery& scenery, Image& image) {
  Shader shader(scenery);
  const std::size_t samples = places_.size();
  const std::uint32_t all = static_cast<std::uint32_t>((1ULL << samples) - 1);
  auto fragment = fragments_.cbegin();
  for (int y = range_.top; y <= range_.bottom; ++y) {
    shader.forget();
    for (int x = range_.left; x <= range_.right; ++x) {
      const std::size_t at = pixel(x, y);
      const std::uint32_t* const shown = triangles_.data() + at * samples;
      const bool clear = fragment != fragments_.cend() && fragment->pixel == at;
      // All samples of most pixels show the paper.
      std::uint32_t paper = 0;
      for (std::size_t s = 0; s < samples; ++s) paper |= static_cast<std::uint32_t>(shown[s] == kNothing) << s;
      if (paper == all && !clear) continue;

      std::array<Float3, kMostSamples> colors;
      const Float3 behind = linear_of(image.at(x, y));
      for (std::uint32_t left = all; left != 0;) {
        const std::uint32_t triangle = shown[std::countr_zero(left)];
        std::uint32_t mask = 0;
        for (std::size_t s = 0; s < samples; ++s) mask |= static_cast<std::uint32_t>(shown[s] == triangle) << s;
        const Float3 color = triangle == kNothing ? behind : seen(shader, triangle, x, y, mask).color;
        for (std::size_t s = 0; s < samples; ++s)
          if (mask >> s & 1) colors[s] = color;
        left &= ~mask;
      }
      for (; fragment != fragments_.cend() && fragment->pixel == at; ++fragment) {
        const auto [color, opacity] = seen(shader, fragment->triangle, x, y, fragment->mask);
        for (std::size_t s = 0; s < samples; ++s)
          if (fragment->mask >> s & 1) colors[s] = colors[s] * (1 - opacity) + color * opacity;
      }
      Float3 sum;
      // Clipped before they are added: else the brightest of an edge's samples would hide its others.
      for (std::size_t s = 0; s < samples; ++s)
        sum = sum + Float3{std::min(colors[s].x, 1.0F), std::min(colors[s].y, 1.0F), std::min(colors[s].z, 1.0F)};
      image.at(x, y) = color_of_light(sum * (1 / static_cast<float>(samples)));
    }
  }
}

void TileDrawer::draw(const Bins& opaque, const Bins& clear, int tile, const Scenery& scenery, Image& image) {
  range_ = opaque.pixels(tile);
  find_nearest(opaque, tile);
  find_fragments(clear, tile);
  color_pixels(scenery, image);
}

}  // namespace standoff
