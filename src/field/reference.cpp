// SPDX-License-Identifier: Apache-2.0
// Exact distances and winding numbers, to compare fields with.
#include "field/reference.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/predicates.h"
#include "geometry/triangle_box.h"
#include "geometry/triangle_distance.h"

namespace standoff {
namespace {

double box_distance_sq(Vec3 p, const Box& box) {
  const Vec3 outside = max(max(box.min - p, p - box.max), Vec3{});
  return dot(outside, outside);
}

// The place of a point of the unit cube on a Morton curve, by the top 21 bits of each coordinate.
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

double TriangleGroups::distance(Vec3 p) const {
  std::size_t nearest = 0;
  double nearest_sq = std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < boxes_.size(); ++g)
    if (const double sq = box_distance_sq(p, boxes_[g]); sq < nearest_sq) {
      nearest = g;
      nearest_sq = sq;
    }
  double best_sq = std::numeric_limits<double>::infinity();
  look_at(nearest, p, best_sq);
  for (std::size_t g = 0; g < boxes_.size(); ++g)
    if (box_distance_sq(p, boxes_[g]) <= best_sq) look_at(g, p, best_sq);
  return std::sqrt(best_sq);
}

double TriangleGroups::distance(Vec3 p, std::uint32_t triangle) const {
  return std::sqrt(triangle_distance_sq(p, triangle));
}

void TriangleGroups::look_at(std::size_t g, Vec3 p, double& best_sq) const {
  for (const auto t : group(g))
    if (box_distance_sq(p, triangle_box(mesh_, t)) <= best_sq) best_sq = std::min(best_sq, triangle_distance_sq(p, t));
}

double TriangleGroups::triangle_distance_sq(Vec3 p, std::uint32_t t) const {
  // Corners are relative to the sample, so that a mesh far from the origin loses nothing.
  const auto [a, b, c] = mesh_.corners(t);
  return origin_distance_sq(triple_of(a - p), triple_of(b - p), triple_of(c - p));
}

namespace {

// The projection along y.
Flat flat(const Vec3& v) { return {v.x, v.z}; }

// The side of the line from a to b that q is on: 1 left, -1 right. Requires a.x != b.x. Symbolic perturbation moves
// each q to (q.x + e^2, q.y + e), where e is positive and smaller than any number: so a point on the line counts as
// above it.
int side_of_line(const Flat& a, const Flat& b, const Flat& q) {
  const int side = orient2d(a, b, q);
  return side != 0 ? side : b.x > a.x ? 1 : -1;
}

// The winding number of the triangle's projection along y around p, seen with x to the right and z up: 1 anticlockwise,
// -1 clockwise, or 0. Counts the edges that pass above p, by direction. With the same e, a corner at p's x is left of
// p.
int turns_round(const Corners& t, const Vec3& p) {
  int turns = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 &a = t[n], &b = t[(n + 1) % 3];
    const bool a_left = a.x <= p.x, b_left = b.x <= p.x;
    if (a_left == b_left) continue;
    const int side = side_of_line(flat(a), flat(b), flat(p));
    if (a_left && side < 0) --turns;
    if (b_left && side > 0) ++turns;
  }
  return turns;
}

bool in_box(const Corners& t, const Vec3& p) {
  const Vec3 low = min(min(t[0], t[1]), t[2]), high = max(max(t[0], t[1]), t[2]);
  return low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && low.z <= p.z && p.z <= high.z;
}

// Whether q is left of one edge and right of another one.
bool is_outside(const Flat& a, const Flat& b, const Flat& c, const Flat& q) {
  const int sides[] = {orient2d(a, b, q), orient2d(b, c, q), orient2d(c, a, q)};
  return std::ranges::count(sides, 1) > 0 && std::ranges::count(sides, -1) > 0;
}

// Whether p is exactly on the triangle. A point of the triangle's plane is on it if its projections along all three
// axes are on the triangle's projections. If a projection is a segment, a point off its line is left of one edge and
// right of another, and its box bounds the rest.
bool is_on(const Corners& t, const Vec3& p) {
  if (!in_box(t, p) || orient3d(t[0], t[1], t[2], p) != 0) return false;
  const auto outside = [&](double Vec3::*right, double Vec3::*up) {
    const auto shadow = [&](const Vec3& v) { return Flat{v.*right, v.*up}; };
    return is_outside(shadow(t[0]), shadow(t[1]), shadow(t[2]), shadow(p));
  };
  return !outside(&Vec3::x, &Vec3::y) && !outside(&Vec3::y, &Vec3::z) && !outside(&Vec3::z, &Vec3::x);
}

}  // namespace

ReferenceWinding winding_by_crossings(const OrientedMesh& mesh, const TriangleGroups& groups, const Vec3& p) {
  ReferenceWinding winding;
  groups.for_each_above(p, [&](std::uint32_t triangle) {
    if (mesh.use_of(triangle) == 0) return;
    const Corners t = mesh.corners(triangle);
    winding.on_surface = winding.on_surface || is_on(t, p);
    // With n = (b - a) x (c - a), turns = -sign(n.y): an upward normal is seen from its back. A ray leaves the solid
    // where n.y > 0. orient3d = sign(n . (p - a)), and n . (p - a) = n.y * (height of p above the triangle's plane):
    // p is below the triangle where orient3d = turns. 0 means on it, as said above.
    const int turns = turns_round(t, p);
    if (turns != 0 && orient3d(t[0], t[1], t[2], p) == turns) winding.value -= turns;
  });
  return winding;
}

ReferenceWinding winding_by_angles(const OrientedMesh& mesh, const Vec3& p) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double sum = 0, error = 0;
  for (std::size_t triangle = 0; triangle < mesh.mesh.triangles.size(); ++triangle) {
    if (mesh.use_of(triangle) == 0) continue;
    Corners t = mesh.corners(triangle);
    for (Vec3& v : t) v = v - p, v = v * (1 / length(v));
    // tan(angle / 2) = sine / cosine. In units u of 2^-53, the error of each corner's direction is at most 6 u. So the
    // error of the sine is 18 u plus 10 u of its own rounding, of the cosine 36 u plus 21 u of its own, of both
    // together less than 64 u. Seen from the origin, the direction of (cosine, sine) is then off by at most asin(64 u /
    // its distance). If p is on an edge, the point is the origin, and any angle is possible.
    const double sine = dot(t[0], cross(t[1], t[2]));
    const double cosine = 1 + dot(t[0], t[1]) + dot(t[1], t[2]) + dot(t[2], t[0]);
    if (!std::isfinite(sine + cosine)) return {0, kInfinity};
    sum += std::atan2(sine, cosine);
    const double off = 64 * kRoundoffDouble / std::max(std::abs(sine), std::abs(cosine));
    error += (off < 1 ? 2 * off : 2 * std::numbers::pi) + kRoundoffDouble * std::abs(sum);
  }
  return {sum / (2 * std::numbers::pi), error / (2 * std::numbers::pi)};
}

}  // namespace standoff
