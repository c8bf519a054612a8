// SPDX-License-Identifier: Apache-2.0
// The middles of triangles' boxes, which orders of triangles go by.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstdint>

#include "field/backend.h"
#include "geometry/triangle_box.h"

namespace standoff::cpu {

/// Calls use(n, triangle, center) for the n-th triangle of a job, the center in the cube [0, 1]^3 around all of them.
/// On the threads of the calling TBB arena.
template <class Use>
void for_each_center(const Job& job, const Use& use) {
  using Blocked = tbb::blocked_range<std::int64_t>;
  const Blocked all(0, job.triangle_count(), 4096);
  const auto included = [&](const Blocked& range, Box box) {
    for (std::int64_t n = range.begin(); n < range.end(); ++n) {
      const Box own = triangle_box(job.mesh, job.triangle(n));
      box = {min(box.min, own.min), max(box.max, own.max)};
    }
    return box;
  };
  const auto both = [](const Box& a, const Box& b) { return Box{min(a.min, b.min), max(a.max, b.max)}; };
  const Box box = tbb::parallel_reduce(all, Box{}, included, both);
  const double longest = box.longest_side();
  const double scale = longest > 0 ? 1 / longest : 0;
  tbb::parallel_for(all, [&](const Blocked& range) {
    job.progress.check();
    for (std::int64_t n = range.begin(); n < range.end(); ++n) {
      const std::uint32_t triangle = job.triangle(n);
      const Vec3 at = (triangle_box(job.mesh, triangle).center() - box.min) * scale;
      use(static_cast<std::size_t>(n), triangle, min(at, Vec3{1, 1, 1}));
    }
  });
}

}  // namespace standoff::cpu
