// SPDX-License-Identifier: Apache-2.0
// A part of the winding number in a cell: a linear function, and how far it may be off.
#pragma once

#include <algorithm>
#include <cmath>

#include "standoff/vec.h"

namespace standoff {

/// Samples low to high of the grid as a box, in world units.
struct Cell {
  Vec3 center, half;  ///< every sample of the cell is within center +- half
  double radius;      ///< the length of half

  /// The squared distance of the nearest point of the box.
  double distance_sq(const Vec3& p) const {
    const double x = std::max(std::abs(p.x - center.x) - half.x, 0.0),
                 y = std::max(std::abs(p.y - center.y) - half.y, 0.0),
                 z = std::max(std::abs(p.z - center.z) - half.z, 0.0);
    return x * x + y * y + z * z;
  }
};

/// Off by at most `error` at all points of a cell.
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
  /// How far the function may be from `value` in the cell around its center.
  double reach(const Vec3& half) const {
    return error + std::abs(gradient.x) * half.x + std::abs(gradient.y) * half.y + std::abs(gradient.z) * half.z;
  }
};

}  // namespace standoff
