// SPDX-License-Identifier: Apache-2.0
// Sides of points by definition, independent of everything in src: of convex solids by the planes of their faces, of
// any mesh by the sum of the solid angles of its triangles.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "standoff/mesh.h"
#include "tests/sign/cases/expect_sides.h"
#include "tests/sign/solid_angles.h"

namespace standoff::testing {

inline constexpr SignOptions kWinding{.method = SignMethod::winding}, kParity{.method = SignMethod::parity},
    kNormal{.method = SignMethod::normal}, kFlood{.method = SignMethod::flood},
    kAutomatic{.method = SignMethod::automatic}, kAsOriented{.method = SignMethod::winding, .as_oriented = true};

/// The inside of what has none.
inline Side nowhere(Vec3) { return Side::outside; }

/// Sides of every n-th sample of a grid by the generalised winding number. None is known within 1e-6 of a threshold.
class ByWinding {
 public:
  ByWinding(const Mesh& mesh, const Grid& grid, WindingRule rule = WindingRule::positive, std::size_t every = 1)
      : grid_(grid) {
    for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      sides_.push_back(sides_.size() % every == 0 ? side(winding_number(mesh, grid.position(i, j, k)), rule)
                                                  : Side::unknown);
    });
  }
  Side operator()(Vec3 p) const {
    const Vec3 at = (p - grid_.origin) / grid_.spacing;
    return sides_[static_cast<std::size_t>(grid_.index(std::lround(at.x), std::lround(at.y), std::lround(at.z)))];
  }

 private:
  static Side side(double winding, WindingRule rule) {
    const double w = rule == WindingRule::positive ? winding : std::abs(winding);
    const double threshold = rule == WindingRule::odd ? std::floor(w) + 0.5 : 0.5;
    if (std::abs(w - threshold) < 1e-6) return Side::unknown;
    return side_of(rule == WindingRule::odd ? std::fmod(std::round(w), 2) == 1 : w > 0.5);
  }

  Grid grid_;
  std::vector<Side> sides_;
};

/// A convex solid whose triangles are oriented outwards. No side is known within `margin` of its faces' planes.
class Convex {
 public:
  explicit Convex(MeshView mesh, double margin = 1e-9) : margin_(margin * bounds(mesh).longest_side()) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [a, b, c] = mesh.corners(t);
      const Vec3 n = cross(b - a, c - a);
      if (length(n) > 0) planes_.push_back({n * (1 / length(n)), a});
    }
  }
  Side operator()(Vec3 p) const {
    Side side = Side::inside;
    for (const Plane& plane : planes_) {
      const double height = dot(plane.normal, p - plane.point);
      if (height > margin_) return Side::outside;
      if (height >= -margin_) side = Side::unknown;
    }
    return side;
  }

 private:
  struct Plane {
    Vec3 normal, point;
  };
  std::vector<Plane> planes_;
  double margin_;
};

/// The union of solids.
template <class Solid>
Side in_any(const std::vector<Solid>& solids, Vec3 p) {
  Side side = Side::outside;
  for (const Solid& solid : solids) {
    const Side one = solid(p);
    if (one == Side::inside) return one;
    if (one == Side::unknown) side = one;
  }
  return side;
}

/// What is inside the first and not inside the second.
inline Side except(Side solid, Side hole) {
  if (solid == Side::outside || hole == Side::inside) return Side::outside;
  return hole == Side::unknown ? Side::unknown : solid;
}

/// shapes.h's torus about the x axis, before it was cut into m by n quadrilaterals.
class RoundTorus {
 public:
  RoundTorus(double m, double n, double R, double r, Vec3 centre = {})
      : R_(R), r_(r), centre_(centre), margin_(r * (1 - std::cos(kPi / n)) + (R + r) * (1 - std::cos(kPi / m))) {}
  Side operator()(Vec3 p) const {
    const Vec3 q = p - centre_;
    const double deep = r_ - std::hypot(std::hypot(q.y, q.z) - R_, q.x);
    return std::abs(deep) <= margin_ ? Side::unknown : side_of(deep > 0);
  }

 private:
  static constexpr double kPi = std::numbers::pi;
  double R_, r_;
  Vec3 centre_;
  double margin_;  // how far chords are from their arcs
};

}  // namespace standoff::testing
