// SPDX-License-Identifier: Apache-2.0
#include "sign/outer/row_sides.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "sign/rows/ray_crossing.h"

namespace standoff {
namespace {

// The axis becomes x, in the circle that ray_crossing.h describes.
Vec3 turned(const Vec3& v, int axis) {
  if (axis == 0) return v;
  if (axis == 1) return {v.y, v.z, v.x};
  return {v.z, v.x, v.y};
}

Corners turned(const Corners& t, int axis) { return {turned(t[0], axis), turned(t[1], axis), turned(t[2], axis)}; }

// The box around a row, as long as the mesh.
Box box_of(const Row& row, Box box) {
  const auto fix = [&](double Vec3::*part, double at) { box.min.*part = box.max.*part = at; };
  fix(row.axis == 0 ? &Vec3::y : row.axis == 1 ? &Vec3::z : &Vec3::x, row.at.x);
  fix(row.axis == 0 ? &Vec3::z : row.axis == 1 ? &Vec3::x : &Vec3::y, row.at.y);
  return box;
}

struct PlaceInterval {
  double low, high;
};

// Where a row along x crosses the triangle: x = x0 - s / n_x with s = n_y dy + n_z dz, n the normal. With u the
// roundoff, a part of n is off by less than 4 u times its products' magnitudes m (Shewchuk), and s by less than 8 u M
// with M = m_y |dy| + m_z |dz|, which is at least |s|. If n_x is off by at most a half of itself, dividing by it costs
// 2 * 4 u m_x / |n_x| of |s / n_x|. The difference at the end rounds once more. Never beyond the triangle's corners.
PlaceInterval place_on(const Corners& t, double y, double z) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  const double nx = u.y * v.z - u.z * v.y, mx = std::abs(u.y * v.z) + std::abs(u.z * v.y);
  const double ny = u.z * v.x - u.x * v.z, my = std::abs(u.z * v.x) + std::abs(u.x * v.z);
  const double nz = u.x * v.y - u.y * v.x, mz = std::abs(u.x * v.y) + std::abs(u.y * v.x);
  const auto [low, high] = std::minmax({t[0].x, t[1].x, t[2].x});
  if (!(std::abs(nx) > 8 * kRoundoffDouble * mx)) return {low, high};
  const double dy = y - t[0].y, dz = z - t[0].z;
  const double x = t[0].x - (ny * dy + nz * dz) / nx;
  const double most = (my * std::abs(dy) + mz * std::abs(dz)) / std::abs(nx);
  const double off =
      kRoundoffDouble * ((16 + 8 * mx / std::abs(nx)) * most + 4 * std::max(std::abs(low), std::abs(high)));
  return {std::clamp(x - off, low, high), std::clamp(x + off, low, high)};
}

bool in_plane_of(const Corners& plane, const Corners& t) {
  for (const Vec3& v : t)
    if (orient3d(plane[0], plane[1], plane[2], v) != 0) return false;
  return true;
}

}  // namespace

RowSides::RowSides(const OrientedMesh& mesh, const Bvh& bvh) : mesh_(mesh), bvh_(bvh), bounds_(bounds(mesh.mesh)) {}

std::optional<TwoSides> RowSides::of(std::uint32_t triangle, const Row& row) const {
  const int most_displaced = (4 - row.axis) % 3;
  const Corners own = turned(mesh_.mesh.corners(triangle), row.axis);
  if (RayTriangle(own, most_displaced).crossing(row.at.x, row.at.y) == 0) return std::nullopt;
  const PlaceInterval here = place_on(own, row.at.x, row.at.y);
  TwoSides sides{0, 0};
  bool sure = true;
  for_each_overlap(bvh_, bvh_.frame().local(box_of(row, bounds_)), [&](std::uint32_t place) {
    const std::uint32_t other = bvh_.order()[place];
    if (mesh_.use_of(other) == 0) return;
    const Corners t = turned(mesh_.corners(other), row.axis);
    const int leaves = RayTriangle(t, most_displaced).crossing(row.at.x, row.at.y);
    if (leaves == 0) return;
    const PlaceInterval there = place_on(t, row.at.x, row.at.y);
    if (there.low > here.high) return;
    sides.behind -= leaves;
    if (there.high < here.low)
      sides.before -= leaves;
    else
      sure = sure && (other == triangle || in_plane_of(own, t));
  });
  return sure ? std::optional(sides) : std::nullopt;
}

}  // namespace standoff
