// SPDX-License-Identifier: Apache-2.0
// The boundary of a mesh as small closed polygons, rims, each with a cap that closes it; and the solid angles of caps,
// at points and as linear functions in boxes of samples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sign/diagnosis/boundary.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// A box of samples of the grid, in world units.
struct Cell {
  Vec3 center, half;  ///< every sample of the cell is within center +- half
  double radius;      ///< the length of half

  /// The squared distance of p from the box.
  double distance_sq(const Vec3& p) const {
    const double x = std::max(std::abs(p.x - center.x) - half.x, 0.0),
                 y = std::max(std::abs(p.y - center.y) - half.y, 0.0),
                 z = std::max(std::abs(p.z - center.z) - half.z, 0.0);
    return x * x + y * y + z * z;
  }
};

/// A part of the winding number as a linear function in a cell. It is off by at most `error` at all points of the cell.
struct LinearField {
  Vec3 center;
  double value = 0;  ///< at the center
  Vec3 gradient;
  double error = 0;

  double at(const Vec3& p) const { return value + dot(gradient, p - center); }
  void move_to(const Vec3& p) {
    value = at(p);
    center = p;
  }
  /// Requires the same center.
  void add(const LinearField& other) {
    value += other.value;
    gradient = gradient + other.gradient;
    error += other.error;
  }
  /// The most that the function may differ from `value` in the cell around its center.
  double reach(const Vec3& half) const {
    return error + std::abs(gradient.x) * half.x + std::abs(gradient.y) * half.y + std::abs(gradient.z) * half.z;
  }
};

/// Samples `begin` to `end` - 1 of a grid along each axis.
struct SampleBox {
  std::array<std::int64_t, 3> begin, end;
};

/// The cell of a box of samples. It is larger by a thousandth of the spacing, and by more than the rounding of
/// positions.
inline Cell cell_of(const Grid& grid, const SampleBox& box) {
  const Vec3 low = grid.position(box.begin[0], box.begin[1], box.begin[2]),
             high = grid.position(box.end[0] - 1, box.end[1] - 1, box.end[2] - 1);
  const double rounding = 1e-15 * (max_norm(low) + max_norm(high));
  const Vec3 half = (high - low) * 0.5 + grid.spacing * 1e-3 + Vec3{rounding, rounding, rounding};
  return {low + (high - low) * 0.5, half, length(half)};
}

/// A closed polygon of few corners. Its cap is the cone of triangles (apex, next corner, corner), `weight` times each.
struct Rim {
  std::span<const Vec3> corners;  ///< in the direction of the boundary: the first one follows the last one
  Vec3 apex;
  std::int32_t weight;  ///< positive
};

/// Polygons whose sum is the boundary: the mesh and the caps of all rims are a closed mesh.
///
/// Each boundary loop is taken apart into polygons without repeated corners. Polygons of many corners are cut up:
/// chords close arcs of a few edges, the chords are a polygon of fewer corners, and so on. A chord belongs to two rims,
/// in both directions, so it is not in the sum. So every rim is small, or has few corners: far rims are summed up by
/// their areas, and near ones cost little.
class Rims {
 public:
  static constexpr std::size_t kMaxCorners = 96;

  explicit Rims(const Boundary& boundary) {
    ProgressMeter nobody;
    make(boundary, nobody);
  }
  /// The progress can end it.
  Rims(const Boundary& boundary, ProgressMeter& progress) { make(boundary, progress); }

  std::size_t size() const { return apexes_.size(); }
  Rim operator[](std::size_t n) const {
    return {std::span(corners_).subspan(begin_[n], begin_[n + 1] - begin_[n]), apexes_[n], weights_[n]};
  }

 private:
  void make(const Boundary& boundary, ProgressMeter& progress);
  void add(std::vector<Vec3> polygon, std::int32_t weight);
  void add_small(std::span<const Vec3> polygon, std::int32_t weight);

  std::vector<Vec3> corners_;
  std::vector<std::size_t> begin_ = {0};  // by rim
  std::vector<Vec3> apexes_;
  std::vector<std::int32_t> weights_;
};

/// The triangles of all caps, each repeated by its rim's weight.
Mesh caps_of(const Rims& rims);

/// The side of the plane of a, b and c that p + (e^3, e, e^2) is on, with an infinitely small e as in ray_crossing.h. 0
/// only for triangles without area.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// The solid angle of the triangles (apex, corner, next corner) seen from p, over 4 pi, times the weight. The
/// generalised winding number of a mesh is the winding number of the mesh with all caps, plus the cap angles of all
/// rims.
struct CapAngle {
  double value;
  double error;  ///< bounds its rounding
};

/// The angle jumps by the rim's weight at the cap: exactly where RayTriangle takes a sample to be past the cap's
/// triangles, with the same symbolic perturbation.
CapAngle cap_angle(const Rim& rim, const Vec3& p);

/// The angle of one triangle of the cap, at the edge from corner `edge` to the next one.
CapAngle edge_angle(const Rim& rim, std::size_t edge, const Vec3& p);

/// The angle as a linear function in the cell, continued across the cap if the cell contains it: the angle at the
/// center, and the gradient, which depends on the rim alone. The error is infinite if an edge of the rim may be within
/// the cell's radius.
LinearField cap_field(const Rim& rim, const Cell& cell);

/// Whether a triangle may touch a cell. False only if no point of the triangle is in the cell, because its box or its
/// plane lies beside it. The cell is taken a little larger than it is, by more than rounding.
inline bool may_touch(const std::array<Vec3, 3>& t, const Cell& cell) {
  const Vec3 a = t[0] - cell.center, b = t[1] - cell.center, c = t[2] - cell.center;
  const Vec3 low = min(a, min(b, c)), high = max(a, max(b, c));
  if (low.x > cell.half.x || low.y > cell.half.y || low.z > cell.half.z || high.x < -cell.half.x ||
      high.y < -cell.half.y || high.z < -cell.half.z)
    return false;
  const Vec3 normal = cross(b - a, c - a);
  const Vec3 size = {std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const double rounding = 1e-14 * (dot(size, max(high, low * -1.0)));
  return std::abs(dot(normal, a)) <= dot(size, cell.half) + rounding;
}

/// Whether the cap of a rim may touch a cell.
inline bool may_touch(const Rim& rim, const Cell& cell) {
  const Vec3* corner = &rim.corners.back();
  for (const Vec3& next : rim.corners) {
    if (may_touch({rim.apex, *corner, next}, cell)) return true;
    corner = &next;
  }
  return false;
}

}  // namespace standoff
