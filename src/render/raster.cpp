// SPDX-License-Identifier: Apache-2.0
#include "render/raster.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace standoff {
namespace {

using Wide = std::int64_t;

constexpr int floor_div(std::int32_t a, std::int32_t b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

// Twice the signed area of (a, b, p), as a plane over the picture: value at the first pixel centre and steps.
struct Edge {
  Edge(const ScreenPoint& a, const ScreenPoint& b, Wide px, Wide py)
      : value((Wide{b.x} - a.x) * (py - a.y) - (Wide{b.y} - a.y) * (px - a.x)),
        per_x(-(Wide{b.y} - a.y) * kSubpixels),
        per_y((Wide{b.x} - a.x) * kSubpixels) {}
  Wide value, per_x, per_y;
};

}  // namespace

Raster::Raster(int width, int height, Color background)
    : image_(width, height, background), depths_(image_.pixels.size(), -std::numeric_limits<float>::infinity()) {}

void Raster::draw(const ScreenPoint& a, const ScreenPoint& b0, const ScreenPoint& c0, Color color) {
  const ScreenPoint *b = &b0, *c = &c0;
  constexpr std::int32_t kHalf = kSubpixels / 2;
  // The pixels whose centres lie within the triangle's box.
  const int left = std::max(0, floor_div(std::min({a.x, b->x, c->x}) + kHalf - 1, kSubpixels));
  const int right = std::min(image_.width - 1, floor_div(std::max({a.x, b->x, c->x}) - kHalf, kSubpixels));
  const int top = std::max(0, floor_div(std::min({a.y, b->y, c->y}) + kHalf - 1, kSubpixels));
  const int bottom = std::min(image_.height - 1, floor_div(std::max({a.y, b->y, c->y}) - kHalf, kSubpixels));
  if (left > right || top > bottom) return;

  const Wide px = Wide{left} * kSubpixels + kHalf, py = Wide{top} * kSubpixels + kHalf;
  Wide area = Edge(a, *b, c->x, c->y).value;
  if (area == 0) return;
  if (area < 0) {
    std::swap(b, c);
    area = -area;
  }
  Edge wa(*b, *c, px, py), wb(*c, a, px, py), wc(a, *b, px, py);
  const double share = 1 / static_cast<double>(area);
  const double to_b = (static_cast<double>(b->depth) - a.depth) * share;
  const double to_c = (static_cast<double>(c->depth) - a.depth) * share;
  for (int y = top; y <= bottom; ++y) {
    Wide va = wa.value, vb = wb.value, vc = wc.value;
    float* depth = depths_.data() + static_cast<std::size_t>(y) * image_.width;
    for (int x = left; x <= right; ++x) {
      // One sign bit tells whether any of the three is negative.
      if ((va | vb | vc) >= 0) {
        const auto d = static_cast<float>(a.depth + to_b * static_cast<double>(vb) + to_c * static_cast<double>(vc));
        if (d > depth[x]) {
          depth[x] = d;
          image_.at(x, y) = color;
        }
      }
      va += wa.per_x, vb += wb.per_x, vc += wc.per_x;
    }
    wa.value += wa.per_y, wb.value += wb.per_y, wc.value += wc.per_y;
  }
}

Image halved(const Image& image) {
  Image half(image.width / 2, image.height / 2, {});
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        half.at(x, y)[c] =
            static_cast<std::uint8_t>((image.at(2 * x, 2 * y)[c] + image.at(2 * x + 1, 2 * y)[c] +
                                       image.at(2 * x, 2 * y + 1)[c] + image.at(2 * x + 1, 2 * y + 1)[c] + 2) /
                                      4);
  return half;
}

}  // namespace standoff
