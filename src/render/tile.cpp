// SPDX-License-Identifier: Apache-2.0
#include "render/tile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <tuple>

#include "render/srgb.h"

namespace standoff {

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
  // In the middle of what is covered, which is within the triangle.
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
      // Of most pixels all samples show the same: the paper.
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
