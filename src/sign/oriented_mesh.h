// SPDX-License-Identifier: Apache-2.0
// A mesh in the orientation that its sign is decided with. The caller's mesh is never changed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "standoff/mesh.h"

namespace standoff {

struct OrientedMesh {
  MeshView mesh;
  /// For each triangle 1 as it is, -1 reversed, 0 left out. Empty: all as they are.
  std::span<const std::int8_t> use = {};

  int use_of(std::size_t triangle) const { return use.empty() ? 1 : use[triangle]; }
  /// The corners in the order of use. Requires that the triangle is not left out.
  std::array<Vec3, 3> corners(std::size_t triangle) const {
    std::array<Vec3, 3> t = mesh.corners(triangle);
    if (use_of(triangle) < 0) std::swap(t[1], t[2]);
    return t;
  }
};

}  // namespace standoff
