// SPDX-License-Identifier: Apache-2.0
#include "field/triangle_groups.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/triangle_box.h"
#include "geometry/triangle_distance.h"

namespace standoff {
namespace {

double box_distance_sq(Vec3 p, const Box& box) {
  const Vec3 outside = max(max(box.min - p, p - box.max), Vec3{});
  return dot(outside, outside);
}

// A place in [0, 1) along each axis, by the top 21 bits of each coordinate.
std::uint64_t curve_key(Vec3 unit) {
  const auto cell = [](double u) {
    return u > 0 ? static_cast<std::uint64_t>(std::min(u, 1.0) * 0x1fffff) : 0;  // NaN counts as 0
  };
  return morton(cell(unit.x), cell(unit.y), cell(unit.z));
}

std::vector<std::uint32_t> along_curve(MeshView mesh, std::span<const std::uint32_t> among) {
  struct Entry {
    std::uint64_t key;
    std::uint32_t triangle;
  };
  const Box box = bounds(mesh);
  const Vec3 extent = max(box.extent(), Vec3{1, 1, 1} * std::numeric_limits<double>::min());
  std::vector<Entry> entries(among.empty() ? mesh.triangles.size() : among.size());
  tbb::parallel_for(std::size_t{0}, entries.size(), [&](std::size_t n) {
    const std::uint32_t t = among.empty() ? static_cast<std::uint32_t>(n) : among[n];
    const auto [a, b, c] = mesh.corners(t);
    const Vec3 centre = a * (1.0 / 3) + b * (1.0 / 3) + c * (1.0 / 3);
    entries[n] = {curve_key((centre - box.min) / extent), t};
  });
  tbb::parallel_sort(
      entries, [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.triangle < b.triangle; });
  std::vector<std::uint32_t> order(entries.size());
  std::ranges::transform(entries, order.begin(), &Entry::triangle);
  return order;
}

}  // namespace

TriangleGroups::TriangleGroups(MeshView mesh, std::span<const std::uint32_t> among)
    : mesh_(mesh), order_(along_curve(mesh, among)) {
  boxes_.resize((order_.size() + kGroup - 1) / kGroup);
  tbb::parallel_for(std::size_t{0}, boxes_.size(), [this](std::size_t g) {
    for (const auto t : group(g)) {
      const Box own = triangle_box(mesh_, t);
      boxes_[g].include(own.min);
      boxes_[g].include(own.max);
    }
  });
}

std::span<const std::uint32_t> TriangleGroups::group(std::size_t g) const {
  return std::span(order_).subspan(g * kGroup, std::min(kGroup, order_.size() - g * kGroup));
}

double TriangleGroups::distance(Vec3 p) const { return std::sqrt(find(p).distance_sq); }

std::uint32_t TriangleGroups::nearest(Vec3 p) const { return find(p).triangle; }

TriangleGroups::Found TriangleGroups::find(Vec3 p) const {
  std::size_t nearest = 0;
  double nearest_sq = std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < boxes_.size(); ++g)
    if (const double sq = box_distance_sq(p, boxes_[g]); sq < nearest_sq) {
      nearest = g;
      nearest_sq = sq;
    }
  Found best;
  look_at(nearest, p, best);
  for (std::size_t g = 0; g < boxes_.size(); ++g)
    if (box_distance_sq(p, boxes_[g]) <= best.distance_sq) look_at(g, p, best);
  return best;
}

double TriangleGroups::distance(Vec3 p, std::uint32_t triangle) const {
  return std::sqrt(triangle_distance_sq(p, triangle));
}

void TriangleGroups::look_at(std::size_t g, Vec3 p, Found& best) const {
  for (const auto t : group(g)) {
    if (!(box_distance_sq(p, triangle_box(mesh_, t)) <= best.distance_sq)) continue;
    const double sq = triangle_distance_sq(p, t);
    if (sq < best.distance_sq || (sq == best.distance_sq && t < best.triangle)) best = {sq, t};
  }
}

double TriangleGroups::triangle_distance_sq(Vec3 p, std::uint32_t t) const {
  // Relative to the sample, so that a mesh far from the origin loses nothing.
  const auto [a, b, c] = mesh_.corners(t);
  return origin_distance_sq(triple_of(a - p), triple_of(b - p), triple_of(c - p));
}

}  // namespace standoff
