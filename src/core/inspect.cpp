// SPDX-License-Identifier: Apache-2.0
#include "standoff/inspect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
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

void add_value(float value, FieldSummary& found) {
  if (std::isnan(value)) return void(++found.nan);
  found.min = std::min(found.min, double{value});
  found.max = std::max(found.max, double{value});
}

// The samples of a stored tile that lie in the grid.
void add_tile(const DistanceField& field, const DistanceField::Tile& tile, FieldSummary& found) {
  constexpr std::int64_t kSide = DistanceField::kTileSide;
  const Size3& size = field.grid().size;
  const auto far = static_cast<float>(field.thickness());
  for (std::int64_t k = 0; k < std::min(kSide, size.z - kSide * tile.at.z); ++k)
    for (std::int64_t j = 0; j < std::min(kSide, size.y - kSide * tile.at.y); ++j)
      for (std::int64_t i = 0; i < std::min(kSide, size.x - kSide * tile.at.x); ++i) {
        const auto n = static_cast<std::size_t>(i + kSide * (j + kSide * k));
        add_value(tile.values[n], found);
        found.band += tile.nearest.empty() ? std::abs(tile.values[n]) < far : tile.nearest[n] != kNoTriangle;
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
  FieldSummary found{infinity, -infinity};
  for (const DistanceField::Tile& tile : field.tiles()) add_tile(field, tile, found);
  // A tile that is not stored has one value. A file of few bytes may ask for very many of these.
  const auto far = static_cast<float>(field.thickness());
  const std::span<const std::int32_t> slots = field.slots();
  if (slots.empty() || std::ranges::find(slots, DistanceField::kOutside) != slots.end()) add_value(far, found);
  if (std::ranges::find(slots, DistanceField::kInside) != slots.end()) add_value(-far, found);
  return found;
} catch (...) {
  throw_as_error("field");
}

}  // namespace standoff
