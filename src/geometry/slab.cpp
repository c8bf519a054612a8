// SPDX-License-Identifier: Apache-2.0
#include "geometry/slab.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace standoff {
namespace {

// A slab this much thinner than the triangles are apart is one along a direction that rounding has turned.
constexpr double kTurned = 0.5;

Slab slab_along(const Corners& p, const Corners& q, const Vec3& normal) {
  double top = 0;
  for (const Vec3& corner : p) top = std::max(top, dot(normal, corner - p[0]));
  Slab slab{normal, {}, std::numeric_limits<double>::infinity()};
  for (int k = 0; k < 3; ++k) {
    slab.height[k] = dot(normal, q[k] - p[0]) - top;
    slab.thickness = std::min(slab.thickness, slab.height[k]);
  }
  return slab;
}

class Thickest {
 public:
  Thickest(const Corners& p, const Corners& q, const Slab& first) : p_(p), q_(q), best_(first) {}

  /// Its normal points to the side of `separation`, from p to q.
  void try_along(const Vec3& direction, const Vec3& separation) {
    const double size = length(direction);
    if (!(size > 0)) return;
    const Slab slab = slab_along(p_, q_, direction * ((dot(direction, separation) < 0 ? -1 : 1) / size));
    if (slab.thickness > best_.thickness) best_ = slab;
  }
  const Slab& best() const { return best_; }

 private:
  const Corners &p_, &q_;
  Slab best_;
};

}  // namespace

Slab slab_between(const Corners& p, const Corners& q, const ClosestPair& closest) {
  const double apart = std::sqrt(closest.distance_sq);
  const Slab slab = slab_along(p, q, apart > 0 ? closest.separation * (1 / apart) : Vec3{});
  if (slab.thickness > kTurned * apart) return slab;
  Thickest thickest(p, q, slab);
  const Vec3& separation = closest.separation;
  const auto edge = [](const Corners& t, int k) { return t[(k + 1) % 3] - t[k]; };
  for (const Corners* t : {&p, &q}) {
    thickest.try_along(normal_direction(*t), separation);
    for (int k = 0; k < 3; ++k) thickest.try_along(cross(edge(*t, k), cross(separation, edge(*t, k))), separation);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) thickest.try_along(cross(edge(p, i), edge(q, j)), separation);
  return thickest.best();
}

}  // namespace standoff
