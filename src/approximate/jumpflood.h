// SPDX-License-Identifier: Apache-2.0
// Jump flooding: passes over the grid with steps of n/2, n/4, ... 1 samples. In a pass each sample takes the triangles
// of the 26 samples that are one step away along some of the axes. "JFA+1" adds a pass with step 1 at the end, which
// mends most errors of the last ones. Not exact (docs/methods.md).
//
// Source: G. Rong, T.-S. Tan, Jump flooding in GPU with applications to Voronoi diagram and distance transform, 2006;
// the variants: the same, Variants of jump flooding algorithm for computing discrete Voronoi diagrams, 2007.
//
// Bound. A seed reaches any sample by steps that halve: its triangle, or one that is nearer where it comes by, is
// handed on along a path that is at most the sum of the distances along the axes, so at most sqrt 3 times the distance.
// With the argument of propagate.h a value is at most 1.7321 (d + h) + h where the nearest point lies in the grid, for
// any spacings.
#pragma once

#include <cstdint>

#include "approximate/spread.h"

namespace standoff {

/// The step of the first pass: at least half of the longest side. The next ones halve it, until 1.
inline std::int64_t first_jump(const Lattice& l) {
  std::int64_t step = 1;
  for (const std::int64_t side : l.size)
    while (2 * step < side) step *= 2;
  return step;
}

/// Calls pass(step) for each pass; `more` is the number of passes with step 1 at the end.
template <class Pass>
void for_each_jump(const Lattice& l, int more, const Pass& pass) {
  for (std::int64_t step = first_jump(l); step > 0; step /= 2) pass(step);
  for (int n = 0; n < more; ++n) pass(std::int64_t{1});
}

/// A sample after a pass, from `found` before it, which has one number per sample of the grid. Adds the distances that
/// were measured to `measured`.
template <class Corners>
STANDOFF_HD Found jump(const SpreadSpace<Corners>& space, std::int64_t step, std::int64_t x, std::int64_t y,
                       std::int64_t z, const Found* found, std::int64_t& measured) {
  const std::int64_t* const size = space.lattice.size;
  SpreadSample<Corners> sample{space, x, y, z, found[x + size[0] * (y + size[1] * z)]};
  for (std::int64_t k = z - step; k <= z + step; k += step) {
    if (k < 0 || k >= size[2]) continue;
    for (std::int64_t j = y - step; j <= y + step; j += step) {
      if (j < 0 || j >= size[1]) continue;
      for (std::int64_t i = x - step; i <= x + step; i += step)
        if (i >= 0 && i < size[0]) sample.take(found[i + size[0] * (j + size[1] * k)]);
    }
  }
  measured += sample.measured;
  return sample.best;
}

}  // namespace standoff
