// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/along_curve.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "geometry/triangle_box.h"

namespace standoff {

std::vector<std::uint32_t> along_curve(MeshView mesh) {
  constexpr double kCells = 1 << 10;
  const Box bounds = standoff::bounds(mesh);
  const double side = bounds.longest_side(), scale = (kCells - 1) / side;
  const bool has_cells = scale > 0 && std::isfinite(scale);
  const std::size_t triangles = mesh.triangles.size();
  std::vector<std::uint64_t> keys(triangles);  // cell, triangle
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      keys[t] = t;
      if (!has_cells) continue;
      const Vec3 at = (triangle_box(mesh, t).center() - bounds.min) * scale;
      keys[t] |= morton(std::uint64_t(at.x), std::uint64_t(at.y), std::uint64_t(at.z)) << 32;
    }
  });
  std::ranges::sort(keys);
  std::vector<std::uint32_t> order(triangles);
  for (std::size_t n = 0; n < triangles; ++n) order[n] = static_cast<std::uint32_t>(keys[n]);
  return order;
}

}  // namespace standoff
