// SPDX-License-Identifier: Apache-2.0
#include "sign/flat_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace standoff {
namespace {

using Cell = std::vector<Flat>;  // convex, corners in a circle

Flat between(const Flat& a, const Flat& b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

// How far points are from the line through a segment, positive on its left.
struct Line {
  Flat from;
  double x, y, length;  // a unit vector along it

  explicit Line(const FlatSegment& s) : from(s[0]), x(s[1].x - s[0].x), y(s[1].y - s[0].y), length(std::hypot(x, y)) {
    if (length > 0) x /= length, y /= length;
  }
  double left(const Flat& p) const { return x * (p.y - from.y) - y * (p.x - from.x); }
  double along(const Flat& p) const { return x * (p.x - from.x) + y * (p.y - from.y); }
};

// The two parts of a cell, if the segment is in it for more than `thin`, with as much room on both sides. Splits along
// the whole line.
std::optional<std::pair<Cell, Cell>> split(const Cell& cell, const Line& line, double thin) {
  std::pair<Cell, Cell> parts;
  double left = 0, right = 0, first = line.length, last = 0;
  const auto on_line = [&](const Flat& p) {
    parts.first.push_back(p);
    parts.second.push_back(p);
    first = std::min(first, line.along(p));
    last = std::max(last, line.along(p));
  };
  for (std::size_t n = 0; n < cell.size(); ++n) {
    const Flat &a = cell[n], &b = cell[(n + 1) % cell.size()];
    const double from = line.left(a), to = line.left(b);
    left = std::max(left, from);
    right = std::max(right, -from);
    if (from == 0) on_line(a);
    if (from > 0) parts.first.push_back(a);
    if (from < 0) parts.second.push_back(a);
    if ((from > 0 && to < 0) || (from < 0 && to > 0)) on_line(between(a, b, from / (from - to)));
  }
  // The line's part in the cell and the segment have no more than that in common.
  const bool passes = std::min(last, line.length) - std::max(first, 0.0) > thin;
  if (!(left > thin && right > thin && passes)) return std::nullopt;
  return parts;
}

Flat centre(const Cell& cell) {
  Flat sum{0, 0};
  for (const Flat& p : cell) sum = {sum.x + p.x / double(cell.size()), sum.y + p.y / double(cell.size())};
  return sum;
}

}  // namespace

std::optional<std::vector<Flat>> cell_centres(const std::array<Flat, 3>& triangle,
                                              std::span<const FlatSegment> segments, double thin, std::size_t most) {
  std::vector<Cell> cells{{triangle[0], triangle[1], triangle[2]}};
  for (const FlatSegment& segment : segments) {
    const Line line(segment);
    for (std::size_t n = 0, before = cells.size(); n < before; ++n)
      if (auto parts = split(cells[n], line, thin)) {
        cells[n] = std::move(parts->first);
        cells.push_back(std::move(parts->second));
      }
    if (cells.size() > most) return std::nullopt;
  }
  std::vector<Flat> centres(cells.size());
  std::ranges::transform(cells, centres.begin(), centre);
  return centres;
}

}  // namespace standoff
