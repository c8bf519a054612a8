// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstddef>

#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

double turn(Point2 a, Point2 b, Point2 c) { return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u); }

bool inside(Point2 p, Point2 a, Point2 b, Point2 c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

// Ear clipping: corners of triangles that fill a simple counterclockwise outline.
std::vector<std::array<int, 3>> fill(const std::vector<Point2>& outline) {
  std::vector<int> left(outline.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  std::vector<std::array<int, 3>> triangles;
  while (left.size() > 3) {
    std::size_t ear = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const int a = left[(i + left.size() - 1) % left.size()], b = left[i], c = left[(i + 1) % left.size()];
      if (!(turn(outline[a], outline[b], outline[c]) > 0)) continue;
      bool empty = true;
      for (const int p : left)
        empty = empty && (p == a || p == b || p == c || !inside(outline[p], outline[a], outline[b], outline[c]));
      if (empty) {
        ear = i;
        break;
      }
    }
    const std::size_t n = left.size();
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace

void extrude(Builder& b, const Frame& f, const std::vector<Point2>& outline, double height) {
  Point2 low = outline[0], high = low;
  for (const Point2 p : outline) {
    low = {std::min(low.u, p.u), std::min(low.v, p.v)};
    high = {std::max(high.u, p.u), std::max(high.v, p.v)};
  }
  const double longer = std::max(high.u - low.u, high.v - low.v), shorter = std::min(high.u - low.u, high.v - low.v);
  if (b.hides(std::max(longer, height), std::max(shorter, std::min(longer, height)))) return;
  const int corners = static_cast<int>(outline.size());
  const int rows = b.segments(height);
  const auto ring = [&](int row) {
    const double y = height * row / rows;
    return b.ring(corners, true, [&](int i) { return f({outline[i].u, y, -outline[i].v}); });
  };
  const Ring bottom = ring(0);
  Ring top = bottom;
  for (int row = 1; row <= rows; ++row) {
    const Ring below = top;
    top = ring(row);
    b.stitch(below, top);
  }
  if (b.counting()) {
    b.count_only(2 * (corners - 2));
  } else {
    for (const auto& [i, j, k] : fill(outline)) {
      b.triangle(bottom.first + k, bottom.first + j, bottom.first + i);
      b.triangle(top.first + i, top.first + j, top.first + k);
    }
  }
  b.end_part();
}

void gear(Builder& b, const Frame& f, double radius, double height, int teeth) {
  if (b.hides(2 * radius, 2 * radius)) return;
  const int n = 4 * teeth;
  const auto ring = [&](double y) {
    return b.ring(n, true, [&](int i) {
      const auto [c, s] = circle(double(i) / n);
      const double r = radius * (i % 4 < 2 ? 1.0 : 0.85);
      return f({r * s, y, r * c});
    });
  };
  const Ring below_centre = b.point(f({0, 0, 0}));
  const Ring bottom = ring(0);
  b.stitch(below_centre, bottom);
  const int rows = b.segments(height);
  Ring top = bottom;
  for (int row = 1; row <= rows; ++row) {
    const Ring below = top;
    top = ring(height * row / rows);
    b.stitch(below, top);
  }
  b.stitch(top, b.point(f({0, height, 0})));
  b.end_part();
}

}  // namespace standoff::scenes
