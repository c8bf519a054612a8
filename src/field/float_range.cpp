#include "field/float_range.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "standoff/error.h"

namespace standoff {
namespace {

constexpr double kFarthest = 0x1p60;        // spacings
constexpr double kFarthestWorld = 0x1p125;  // world units
constexpr double kLeastSpacing = 0x1p-110, kLargestSpacing = 0x1p100;
constexpr double kMostUneven = 0x1p60;  // the largest spacing to the least

double largest(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

void check_domain(MeshView mesh, const Grid& grid) {
  const double spacing = grid.max_spacing();
  if (spacing < kLeastSpacing || spacing > kLargestSpacing)
    throw Error(ErrorCode::limit, "compute: the spacing is " + std::to_string(std::ilogb(spacing)) +
                                      " binary orders from one, too many for values in float; scale mesh and grid");
  const Vec3 h = grid.spacing;
  if (std::min({h.x, h.y, h.z}) < spacing / kMostUneven)
    throw Error(ErrorCode::limit,
                "compute: one spacing is less than 2^-60 of another, too little for float; take more even spacings");
  const Vec3 center = grid.bounds().center();
  const double limit = std::min(kFarthest * spacing, kFarthestWorld);
  // Vertices lie in a row, corners do not: look at these only where some vertex, which may be unused, is far.
  const auto all_near = [&](const tbb::blocked_range<std::size_t>& range, bool near) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) near &= largest(mesh.vertices[v] - center) <= limit;
    return near;
  };
  if (tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, mesh.vertices.size(), 8192), true, all_near,
                           std::logical_and<>()))
    return;
  const auto is_far = [&](const tbb::blocked_range<std::size_t>& range, std::size_t first) {
    for (std::size_t t = range.begin(); t < range.end() && t < first; ++t)
      for (int k = 0; k < 3; ++k)
        if (!(largest(mesh.corner(t, k) - center) <= limit)) return t;
    return first;
  };
  const std::size_t none = mesh.triangles.size();
  const std::size_t found = tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, none, 8192), none, is_far,
                                                 [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (found != none)
    throw Error(ErrorCode::limit,
                "mesh: triangle " + std::to_string(found) +
                    " is farther than 2^60 spacings, or 2^125 units, from the grid; remove it, scale "
                    "the mesh or coarsen the grid",
                {.triangle = static_cast<std::int64_t>(found)});
}

}  // namespace standoff
