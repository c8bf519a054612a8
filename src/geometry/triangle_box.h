// SPDX-License-Identifier: Apache-2.0
// Boxes of triangles, the samples of a grid in a box, and Morton numbers of cells.
#pragma once

#include <algorithm>
#include <cstdint>

#include "geometry/host_device.h"
#include "geometry/triple.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// The lowest and the highest coordinates of three points.
template <class F>
struct BoxOf {
  Triple<F> low, high;
};

template <class F>
STANDOFF_INLINE BoxOf<F> box_of(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c) {
  return {{min(a.x, min(b.x, c.x)), min(a.y, min(b.y, c.y)), min(a.z, min(b.z, c.z))},
          {max(a.x, max(b.x, c.x)), max(a.y, max(b.y, c.y)), max(a.z, max(b.z, c.z))}};
}

template <class F>
STANDOFF_INLINE Triple<F> middle_of(const BoxOf<F>& box) {
  return (box.low + box.high) * F(0.5f);
}

template <class F>
STANDOFF_INLINE F longest_side(const BoxOf<F>& box) {
  return max(box.high.x - box.low.x, max(box.high.y - box.low.y, box.high.z - box.low.z));
}

/// The box of a triangle of a mesh. Requires a valid triangle.
inline Box triangle_box(const MeshView& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return {min(a, min(b, c)), max(a, max(b, c))};
}

/// Samples begin <= i < end on each axis.
struct SampleRange {
  Size3 begin, end;

  STANDOFF_HD bool empty() const { return begin.x >= end.x || begin.y >= end.y || begin.z >= end.z; }
  STANDOFF_HD std::int64_t count() const {
    return empty() ? 0 : (end.x - begin.x) * (end.y - begin.y) * (end.z - begin.z);
  }
};

STANDOFF_HD inline SampleRange intersection(const SampleRange& a, const SampleRange& b) {
  return {{std::max(a.begin.x, b.begin.x), std::max(a.begin.y, b.begin.y), std::max(a.begin.z, b.begin.z)},
          {std::min(a.end.x, b.end.x), std::min(a.end.y, b.end.y), std::min(a.end.z, b.end.z)}};
}

/// The samples of the grid in the box, its faces included. The box may be infinite, and empty on some axis.
STANDOFF_HD inline SampleRange samples_in(const Box& box, const Grid& grid) {
  // Avoid ceil and floor: without SSE4.1 they are calls of the C library, and every triangle of every brick comes here.
  // Samples are counted from the first one of the whole grid, so that rounding is the same in all windows.
  const auto begin = [](double low, double origin, double spacing, std::int64_t first, std::int64_t size) {
    const double sample =
        std::clamp((low - origin) / spacing, static_cast<double>(first), static_cast<double>(first + size));
    const auto below = static_cast<std::int64_t>(sample);
    return below + (static_cast<double>(below) < sample) - first;
  };
  const auto end = [](double high, double origin, double spacing, std::int64_t first, std::int64_t size) {
    const double sample = (high - origin) / spacing;
    if (!(sample >= static_cast<double>(first))) return std::int64_t{0};
    return static_cast<std::int64_t>(std::min(sample, static_cast<double>(first + size - 1))) + 1 - first;
  };
  const auto& [size, origin, spacing, first] = grid;
  return {
      {begin(box.min.x, origin.x, spacing.x, first.x, size.x), begin(box.min.y, origin.y, spacing.y, first.y, size.y),
       begin(box.min.z, origin.z, spacing.z, first.z, size.z)},
      {end(box.max.x, origin.x, spacing.x, first.x, size.x), end(box.max.y, origin.y, spacing.y, first.y, size.y),
       end(box.max.z, origin.z, spacing.z, first.z, size.z)}};
}

// A Morton number interleaves the bits of a cell's three coordinates: near numbers are near cells.

namespace detail {

// Moves the bits of v, which is below 2^21, to the places 0, 3, 6, ...
constexpr std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

}  // namespace detail

/// The number of cell (x, y, z): below 2^(3n) if each coordinate is below 2^n. Requires n <= 21.
constexpr std::uint64_t morton(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return detail::spread(x) | detail::spread(y) << 1 | detail::spread(z) << 2;
}

}  // namespace standoff
