// SPDX-License-Identifier: Apache-2.0
// What vector propagation (propagate.h) and jump flooding (jumpflood.h) share, on the CPU and on a GPU: the seeds, and
// the number per sample that they spread (docs/methods.md).
//
// Both begin with the samples near the surface, the seeds, whose nearest triangles Algorithm 1 finds, and hand
// triangles on from sample to sample: each sample measures its distance from the triangles of others and keeps the
// nearest one. So a value is the distance from some triangle of the mesh, and never too small; it is too large where no
// neighbour of the sample has kept the triangle that is nearest to the sample.
#pragma once

#include <cstdint>

#include "field/lattice.h"
#include "geometry/closest_part.h"
#include "standoff/field.h"
#include "standoff/grid.h"

namespace standoff {

/// A sample's nearest triangle so far, low half, and the bits of the squared distance from it in float, high half. So
/// the less of two is the nearer one, and the lowest index wins ties.
using Found = unsigned long long;

/// No triangle, at an infinite distance.
inline constexpr Found kNothingFound = 0x7f800000'ffffffffull;
static_assert((kNothingFound & 0xffffffffu) == kNoTriangle);

STANDOFF_HD inline std::uint32_t triangle_of(Found found) { return static_cast<std::uint32_t>(found); }
STANDOFF_HD inline float distance_sq_of(Found found) {
  const auto bits = static_cast<std::uint32_t>(found >> 32);
  float distance_sq;
  __builtin_memcpy(&distance_sq, &bits, sizeof bits);
  return distance_sq;
}
STANDOFF_HD inline Found found_of(float distance_sq, std::uint32_t triangle) {
  std::uint32_t bits;
  __builtin_memcpy(&bits, &distance_sq, sizeof bits);
  return Found{bits} << 32 | triangle;
}

/// Seeds are the samples this near to the surface, world units: all corners of the cells that it passes through.
/// Algorithm 1 computes in float, with an error of some 2^-22 of the triangle's extent: of triangles larger than a
/// million spacings it may miss seeds, or take the wrong one of two.
inline double seed_thickness(const Grid& grid) { return length(grid.spacing); }

/// The samples of a grid and the triangles that they measure. `Corners` is called with a triangle's index and an array
/// of three corners, which it fills, world units.
template <class Corners>
struct SpreadSpace {
  Lattice lattice;
  Corners corners;

  /// Measured in double, as a triangle that is handed on may be far away and large. The squared distance is in grid
  /// units.
  STANDOFF_HD Found measured(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t triangle) const {
    Triple<double> corner[3];
    corners(triangle, corner);
    const Triple<double> at = position(lattice, static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    const auto part = closest_part(relative(corner[0], at), relative(corner[1], at), relative(corner[2], at));
    return found_of(static_cast<float>(part.distance_sq), triangle);
  }
  /// As local() of the lattice, whose fused multiplication is a call on the oldest processors. The product is exact.
  STANDOFF_HD Triple<double> relative(const Triple<double>& corner, const Triple<double>& at) const {
    return corner * lattice.scale - at;
  }
};

/// One sample, to which others hand their triangles. Counts the distances that it measures.
template <class Corners>
struct SpreadSample {
  const SpreadSpace<Corners>& space;
  std::int64_t x, y, z;
  Found best;
  std::int64_t measured = 0;
  /// The triangles that were measured last: many neighbours have the same.
  std::uint32_t last[4] = {kNoTriangle, kNoTriangle, kNoTriangle, kNoTriangle};

  STANDOFF_HD void take(Found offered) {
    const std::uint32_t triangle = triangle_of(offered);
    if (triangle == kNoTriangle || triangle == triangle_of(best) || triangle == last[0] || triangle == last[1] ||
        triangle == last[2] || triangle == last[3])
      return;
    last[3] = last[2], last[2] = last[1], last[1] = last[0], last[0] = triangle;
    ++measured;
    const Found mine = space.measured(x, y, z, triangle);
    best = mine < best ? mine : best;
  }
};

}  // namespace standoff
