// SPDX-License-Identifier: Apache-2.0
// The positions of vertices, and limits of their number.
//
// A vertex on an edge of the grid keeps a small distance from both ends, the *clearance*. Vertices on different edges
// then differ by the clearance along some axis, and vertices inside a cell keep the same distance from its faces. The
// clearance is so large that the coordinates of the result, floats or doubles, resolve it: so no two vertices coincide.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/grid_axis.h"
#include "core/memory.h"
#include "standoff/grid.h"
#include "standoff/surface.h"

namespace standoff {

/// Rounds to the 24 bits of a float by Veltkamp's splitting. Exact for all numbers in the range of normal floats.
inline double rounded_to_float(double value) {
  constexpr double kSplit = 536870913;  // 2^29 + 1
  const double scaled = value * kSplit;
  return scaled - (scaled - value);
}

class EdgePoints {
 public:
  /// Throws Error{usage} about the coordinates, and Error{limit} if the grid is too far from the origin for its
  /// spacing.
  EdgePoints(const Grid& grid, double level, Coordinates coordinates) : EdgePoints(grid, grid, level, coordinates) {}
  /// The same for a window of `whole`: its points are those of the whole grid.
  EdgePoints(const Grid& grid, const Grid& whole, double level, Coordinates coordinates);

  double level() const { return level_; }
  /// The clearance, in spacings.
  double clearance() const { return clearance_; }
  bool are_floats() const { return floats_; }

  /// The place between two samples of these values where the interpolation has the level: from the clearance to 1 -
  /// clearance.
  double crossing(float lower, float upper) const {
    const double a = lower - level_, b = upper - level_;
    if (std::isinf(a)) return std::isinf(b) ? 0.5 : 1 - clearance_;
    return kept(a / (a - b));  // 0 if the upper one is infinite
  }
  /// The nearest number that keeps the clearance from 0 and 1.
  double kept(double t) const { return std::clamp(t, clearance_, 1 - clearance_); }

  /// The point that is (x, y, z) spacings from the block's first sample, rounded to the coordinates of the result.
  Vec3 at(const std::array<std::int32_t, 3>& block, Vec3 local) const {
    const auto coordinate = [&](std::size_t n, double step) {
      const GridAxis axis = axis_of(grid_, n);
      const double c = axis.origin + axis.spacing * (static_cast<double>(axis.first) + 8.0 * block[n] + step);
      return floats_ ? rounded_to_float(c) : c;
    };
    return {coordinate(0, local.x), coordinate(1, local.y), coordinate(2, local.z)};
  }

 private:
  Grid grid_;
  double level_;
  double clearance_ = 0;
  bool floats_ = false;
};

/// The counts of a thread.
struct SurfaceCounts {
  std::int64_t ambiguous = 0;  ///< ambiguous faces; both cells of a face count it
  std::int64_t clamped = 0, capped = 0;

  /// Counts a crossed edge between samples of these values, in a field of this thickness.
  void count_edge(float lower, float upper, float thickness, bool leaves_grid) {
    if (leaves_grid)
      ++capped;
    else if (std::isfinite(thickness) && (std::abs(lower) >= thickness || std::abs(upper) >= thickness))
      ++clamped;
  }
  void add_to(SurfaceReport& report) const {
    report.clamped += clamped;
    report.capped += capped;
  }
};

/// Throws Error{limit} if this number of vertices exceeds 32-bit indices.
void expect_countable(std::uint64_t vertices);

/// Makes room for this total number of vertices and triangles. Throws Error{limit}.
void grow(Mesh& mesh, std::uint64_t vertices, std::uint64_t triangles, MemoryBudget& budget);

}  // namespace standoff
