// SPDX-License-Identifier: Apache-2.0
// Algorithm 1, what the CPU and the GPU share: the samples that a triangle visits, brick by brick, and the triangle as
// a brick sees it.
#pragma once

#include "field/lattice.h"
#include "geometry/triangle_box.h"
#include "thesis/thesis_distance.h"

namespace standoff {

/// The samples in a triangle's box grown by the thickness. Corners in world units.
STANDOFF_HD inline SampleRange visited_samples(const Triple<double> (&corner)[3], const Grid& grid, double thickness) {
  const BoxOf<double> box = box_of(corner[0], corner[1], corner[2]);
  return samples_in(Box{{box.low.x, box.low.y, box.low.z}, {box.high.x, box.high.y, box.high.z}}.grown(thickness),
                    grid);
}

/// The bricks, begin <= b < end, that hold samples of a range. Requires one sample at least.
STANDOFF_HD inline SampleRange bricks_of(const SampleRange& range) {
  constexpr std::int64_t side = kBrickSide;
  return {{range.begin.x / side, range.begin.y / side, range.begin.z / side},
          {(range.end.x - 1) / side + 1, (range.end.y - 1) / side + 1, (range.end.z - 1) / side + 1}};
}

/// The samples of a brick, also those past the grid.
STANDOFF_HD inline SampleRange samples_of_brick(const Size3& brick) {
  constexpr std::int64_t side = kBrickSide;
  const Size3 first{brick.x * side, brick.y * side, brick.z * side};
  return {first, {first.x + side, first.y + side, first.z + side}};
}

/// The triangle relative to the centre of a brick, grid units. Corners in world units.
template <class F>
STANDOFF_INLINE ThesisTriangle<F> thesis_triangle(const Lattice& l, const Triple<double> (&corner)[3],
                                                  const Triple<double>& center) {
  return make_thesis_triangle<F>(vec_of(local(l, corner[0], center)), vec_of(local(l, corner[1], center)),
                                 vec_of(local(l, corner[2], center)));
}

}  // namespace standoff
