// SPDX-License-Identifier: Apache-2.0
#include "standoff/inspect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/guarded.h"

namespace standoff {
namespace {

constexpr std::uint64_t edge(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

// Calls f(length) for each run of equal elements.
template <class T, class F>
void for_each_run(std::vector<T>& values, F f) {
  std::ranges::sort(values);
  for (std::size_t first = 0, next = 0; first < values.size(); first = next) {
    while (next < values.size() && values[next] == values[first]) ++next;
    f(static_cast<std::int64_t>(next - first));
  }
}

}  // namespace

MeshSummary inspect(MeshView mesh) try {
  validate(mesh);
  MeshSummary found;
  found.bounds = bounds(mesh);
  std::vector<std::uint64_t> edges;
  std::vector<Triangle> corners;
  edges.reserve(3 * mesh.triangles.size());
  corners.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const double area = length(cross(b - a, c - a)) / 2;
    found.area += area;
    found.degenerate += area == 0;
    Triangle sorted = mesh.triangles[t];
    std::ranges::sort(sorted);
    corners.push_back(sorted);
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;
    for (const auto e : {edge(sorted[0], sorted[1]), edge(sorted[1], sorted[2]), edge(sorted[0], sorted[2])})
      edges.push_back(e);
  }
  for_each_run(edges, [&](std::int64_t triangles) {
    found.boundary_edges += triangles == 1;
    found.nonmanifold_edges += triangles > 2;
  });
  for_each_run(corners, [&](std::int64_t triangles) { found.duplicate += triangles - 1; });
  return found;
} catch (...) {
  throw_as_error("mesh");
}

FieldSummary inspect(const DistanceField& field) try {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto far = static_cast<float>(field.thickness());
  const Size3 size = field.grid().size;
  FieldSummary found{infinity, -infinity};
  std::vector<float> slice(static_cast<std::size_t>(size.x * size.y));
  std::vector<std::uint32_t> nearest(field.has_nearest() ? slice.size() : 0);
  for (std::int64_t k = 0; k < size.z; ++k) {
    field.copy_slices(k, 1, slice);
    for (const float value : slice) {
      if (std::isnan(value)) {
        ++found.nan;
        continue;
      }
      found.min = std::min(found.min, double{value});
      found.max = std::max(found.max, double{value});
      if (!field.has_nearest()) found.band += std::abs(value) < far;
    }
    if (!field.has_nearest()) continue;
    field.copy_nearest_slices(k, 1, nearest);
    found.band += std::ranges::count_if(nearest, [](std::uint32_t triangle) { return triangle != kNoTriangle; });
  }
  return found;
} catch (...) {
  throw_as_error("field");
}

}  // namespace standoff
