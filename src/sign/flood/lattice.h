// SPDX-License-Identifier: Apache-2.0
// A lattice of samples in whole tiles, a grid's and more around it: the samples between which paths are searched; and
// the edges of it that a triangle crosses.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/grid_axis.h"
#include "sign/rows/ray_crossing.h"
#include "sign/rows/sample_axis.h"
#include "standoff/field.h"
#include "standoff/grid.h"

namespace standoff {

/// The samples of one axis. The grid's samples are where Grid::position says. Samples before and after them have the
/// same spacing, or a spacing that doubles from each sample to the next.
class LatticeAxis {
 public:
  /// The number of samples before the grid's and after them.
  struct Margin {
    std::int64_t before = 0, after = 0;
    bool doubling = false;
  };
  LatticeAxis(const GridAxis& axis, const Margin& margin);

  std::int64_t size() const { return size_; }
  double at(std::int64_t n) const {
    if (n < first_even_) return even(first_even_) - axis_.spacing * doublings(first_even_ - n);
    if (n > last_even_) return even(last_even_) + axis_.spacing * doublings(n - last_even_);
    return even(n);
  }
  /// The first sample for which is_true, which stays true: near `value`, or size().
  template <class Predicate>
  std::int64_t first(double value, const Predicate& is_true) const {
    return first_from_guess(guess(value), size_, is_true);
  }
  /// The first sample at or above `value`, or size().
  std::int64_t first_from(double value) const {
    return first(value, [&](std::int64_t n) { return at(n) >= value; });
  }

 private:
  double even(std::int64_t n) const { return axis_.at(n - before_); }
  static double doublings(std::int64_t samples);  // 1 + 2 + 4 + ..
  std::int64_t guess(double value) const {
    return sample_at_or_above((value - axis_.origin) * per_spacing_ + static_cast<double>(before_ - axis_.first),
                              size_);
  }

  GridAxis axis_;  // of the grid, without margins
  double per_spacing_;
  std::int64_t before_, size_;
  std::int64_t first_even_, last_even_;  // spacings double beyond them
};

struct TileLattice {
  /// The tiles of a grid. Samples of the last tiles that are beyond the grid continue its spacing.
  static TileLattice of(const Grid& grid);
  /// The same, with more tiles wherever the box does not end within the outermost samples. So the outermost samples are
  /// all outside the box. The tiles added continue the grid's spacing if all tiles together are at most eight times the
  /// grid's, or 2^18. Otherwise the spacing doubles from sample to sample, so that a box of any size takes few.
  static TileLattice around(const Grid& grid, const Box& box);

  std::array<LatticeAxis, 3> axes;
  Size3 tiles;   ///< along each axis
  Size3 origin;  ///< the place of the grid's first tile

  std::size_t tile_count() const { return static_cast<std::size_t>(tiles.x * tiles.y * tiles.z); }
  std::size_t index(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return static_cast<std::size_t>(tx + tiles.x * (ty + tiles.y * tz));
  }
  std::array<std::int64_t, 3> tile_at(std::size_t index) const {
    const auto n = static_cast<std::int64_t>(index);
    return {n % tiles.x, n / tiles.x % tiles.y, n / (tiles.x * tiles.y)};
  }
  /// The tile (tx, ty, tz) of the grid.
  std::size_t index_in_grid(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return index(tx + origin.x, ty + origin.y, tz + origin.z);
  }
};

/// The crossing of an edge with a triangle.
struct EdgeHit {
  int crossing;  ///< 1 where the normal points along the axis, -1 where it points against it
  double at;     ///< estimates the coordinate along the axis; any number where rounding hides it
};

/// Calls use(axis, sample, hit) for each edge, from a sample to the next one along an axis, that crosses the triangle.
/// Exact: every sample stands for one point, which is the same for its edges along all axes (ray_crossing.h). So a
/// closed path along edges crosses a closed mesh an even number of times.
template <class Use>
void for_each_edge_hit(const std::array<Vec3, 3>& corners, const std::array<LatticeAxis, 3>& axes, const Use& use) {
  const auto part = [](const Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
  // Make the range half open: samples are displaced upwards, so a line at the largest coordinate passes beside the
  // triangle.
  std::array<std::int64_t, 3> first, past;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto [low, high] = std::minmax({part(corners[0], n), part(corners[1], n), part(corners[2], n)});
    first[n] = axes[n].first_from(low);
    past[n] = axes[n].first_from(high);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    if (first[b] == past[b] || first[c] == past[c]) continue;
    std::array<Vec3, 3> rotated;
    for (std::size_t n = 0; n < 3; ++n) rotated[n] = {part(corners[n], a), part(corners[n], b), part(corners[n], c)};
    // Samples are displaced most along y, which is axis 1, 0 or 2 of the rotated ones.
    const RayTriangle ray(rotated, static_cast<int>((4 - a) % 3));
    for (std::int64_t k = first[c]; k < past[c]; ++k)
      for (std::int64_t j = first[b]; j < past[b]; ++j) {
        const double y = axes[b].at(j), z = axes[c].at(k);
        const int crossing = ray.crossing(y, z);
        if (crossing == 0) continue;
        const double x = ray.crossing_x(y, z);
        const std::int64_t beyond = axes[a].first(x, [&](std::int64_t n) {
          return ray.is_past({axes[a].at(n), y, z}, crossing);
        });
        if (beyond == 0 || beyond == axes[a].size()) continue;
        std::array<std::int64_t, 3> sample;
        sample[a] = beyond - 1;
        sample[b] = j;
        sample[c] = k;
        use(a, sample, EdgeHit{crossing, x});
      }
  }
}

/// The same with use(axis, sample).
template <class Use>
void for_each_crossed_edge(const std::array<Vec3, 3>& corners, const std::array<LatticeAxis, 3>& axes, const Use& use) {
  for_each_edge_hit(corners, axes, [&](std::size_t axis, const auto& sample, const EdgeHit&) { use(axis, sample); });
}

}  // namespace standoff
