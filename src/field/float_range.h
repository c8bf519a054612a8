// SPDX-License-Identifier: Apache-2.0
// How far apart mesh and grid may be.
#pragma once

#include <cmath>

#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// The points whose distances from a grid float holds: at most 2^60 spacings and 2^125 units from its centre, along
/// each axis.
class FloatRange {
 public:
  explicit FloatRange(const Grid& grid);
  /// False for points that are not finite.
  bool holds(Vec3 p) const {
    const Vec3 d = p - center_;
    return std::abs(d.x) <= farthest_ && std::abs(d.y) <= farthest_ && std::abs(d.z) <= farthest_;
  }

 private:
  Vec3 center_;
  double farthest_;
};

/// Whether the grid's spacings are within what check_domain() asks for.
bool has_float_spacing(const Grid& grid);

/// Backends compute squared distances in float, in units of the spacing. Throws Error{limit} where those, or the
/// distances in world units, would not be normal floats: the mesh reaches farther than 2^60 spacings or 2^125 units
/// from the grid's centre, the largest spacing is not within 2^-110 and 2^100, or one is less than 2^-60 of another.
/// Requires a valid mesh and grid.
void check_domain(MeshView mesh, const Grid& grid);
/// The same of the box around a mesh.
void check_domain(const Box& mesh, const Grid& grid);

}  // namespace standoff
