// SPDX-License-Identifier: Apache-2.0
#include "points/known_windings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace standoff {
namespace {

// Whether a length whose square is given is less than another.
bool is_less(double sq, double than) { return than > 0 && sq < than * than * (1 - 1e-12); }

}  // namespace
void KnownWindings::add(const Known& one) { known_[count_++ % known_.size()] = one; }

const KnownWindings::Known* KnownWindings::overlapping(const Known& own) const {
  for (const Known& other : all()) {
    const Vec3 between = own.at - other.at;
    if (is_less(dot(between, between), own.radius + other.radius)) return &other;
  }
  return nullptr;
}

KnownWindings::OnRow KnownWindings::nearest_on_rows(const Vec3& at) const {
  OnRow nearest{};
  double length = std::numeric_limits<double>::infinity();
  for (const Known& other : all())
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 off = turned(other.at - at, axis);
      if (std::abs(off.x) < length && is_less(off.y * off.y + off.z * off.z, other.radius))
        nearest = {&other, axis}, length = std::abs(off.x);
    }
  return nearest;
}

std::int32_t KnownWindings::by_rows(const Vec3& at) const {
  const Known& nearest =
      *std::ranges::min_element(all(), {}, [&](const Known& other) { return max_norm(other.at - at); });
  const Vec3 &there = nearest.at, along_y{there.x, at.y, at.z}, along_z{there.x, there.y, at.z};
  return nearest.winding + rays_.beyond(0, there.x, at, kernels_) + rays_.beyond(1, there.y, along_y, kernels_) +
         rays_.beyond(2, there.z, along_z, kernels_);
}

}  // namespace standoff
