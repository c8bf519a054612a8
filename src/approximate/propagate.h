// SPDX-License-Identifier: Apache-2.0
// Vector propagation: eight sweeps over the grid, one along each diagonal, twice. In a sweep each sample takes the
// triangles of its seven neighbours behind it, which the sweep has visited before. Not exact (docs/methods.md).
//
// Sources: R. Satherley, M. W. Jones, Vector-city vector distance transform, 2001 (eight passes through exact distances
// at the surface); P.-E. Danielsson, Euclidean distance mapping, 1980 (vectors handed on). R. Bridson's SDFGen does the
// same with triangles in place of vectors, as here, and sweeps twice.
//
// Bound. A sweep never makes a value larger, and a sample that takes the triangle of a neighbour at distance s has at
// most the neighbour's value plus s. A seed and any sample are joined by a path along one of the eight diagonals, whose
// length is at most 1.1281 times their distance (the square root of 1 + (sqrt 2 - 1)^2 + (sqrt 3 - sqrt 2)^2). Let h be
// the diagonal of a cell. A seed is within h of the point nearest to the sample, and has a value of at most h. So a
// value is at most 1.1281 (d + h) + h where the exact distance is d and the point lies in the grid. This holds for
// equal spacings; for others the path is longer, at most 1.7321 times the distance.
#pragma once

#include <cstdint>

#include "approximate/spread.h"

namespace standoff {

inline constexpr int kPropagationSweeps = 16;

/// The direction of sweep n along an axis: 1 or -1.
STANDOFF_HD inline int sweep_direction(int n, int axis) { return n >> axis & 1 ? -1 : 1; }

/// Rows with the same sum of steps along y and z do not depend on each other; the sums are 0 to this, exclusive.
inline std::int64_t row_fronts(const Lattice& l) { return l.size[1] + l.size[2] - 1; }

/// The steps along z of a front's rows: first to past, exclusive.
struct FrontSteps {
  std::int64_t first, past;
};
inline FrontSteps steps_of_front(const Lattice& l, std::int64_t front) {
  const std::int64_t first = front - l.size[1] + 1, past = front + 1;
  return {first > 0 ? first : 0, past < l.size[2] ? past : l.size[2]};
}

/// The row of a front with so many steps along z.
struct SweptRow {
  std::int64_t y, z;
};
STANDOFF_HD inline SweptRow swept_row(const Lattice& l, int sweep, std::int64_t front, std::int64_t step) {
  const std::int64_t y = front - step;
  return {sweep_direction(sweep, 1) > 0 ? y : l.size[1] - 1 - y,
          sweep_direction(sweep, 2) > 0 ? step : l.size[2] - 1 - step};
}

/// Visits the samples of a row in the order of a sweep. `found` has one number per sample of the grid. Returns how many
/// distances were measured.
template <class Corners>
STANDOFF_HD std::int64_t sweep_row(const SpreadSpace<Corners>& space, int sweep, std::int64_t y, std::int64_t z,
                                   Found* found) {
  const std::int64_t* const size = space.lattice.size;
  const int along = sweep_direction(sweep, 0);
  const auto row_behind = [&](int back_y, int back_z) -> Found* {
    const std::int64_t from_y = y - back_y * sweep_direction(sweep, 1), from_z = z - back_z * sweep_direction(sweep, 2);
    const bool in_grid = from_y >= 0 && from_y < size[1] && from_z >= 0 && from_z < size[2];
    return in_grid ? found + size[0] * (from_y + size[1] * from_z) : nullptr;
  };
  Found* const row = row_behind(0, 0);
  const Found* const behind[] = {row_behind(1, 0), row_behind(0, 1), row_behind(1, 1)};
  std::int64_t measured = 0;
  for (std::int64_t n = 0; n < size[0]; ++n) {
    const std::int64_t x = along > 0 ? n : size[0] - 1 - n;
    SpreadSample<Corners> sample{space, x, y, z, row[x]};
    if (n > 0) sample.take(row[x - along]);
    for (const Found* const other : behind) {
      if (!other) continue;
      sample.take(other[x]);
      if (n > 0) sample.take(other[x - along]);
    }
    row[x] = sample.best;
    measured += sample.measured;
  }
  return measured;
}

}  // namespace standoff
