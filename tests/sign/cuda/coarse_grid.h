// SPDX-License-Identifier: Apache-2.0
// Grids for meshes that emulated devices sign: few samples, as emulation is slow.
#pragma once

#include <cstdint>

#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff::testing {

/// Some `across` samples along the mesh's longest side, spacings of three sizes, a sample of room on each side.
inline Grid coarse_grid(const Mesh& mesh, std::int64_t across) {
  const Box box = bounds(mesh);
  const double spacing = box.longest_side() / static_cast<double>(across);
  return {
      {across + 3, across + 4, across + 5}, box.min - Vec3{1, 1, 1} * spacing, {spacing, 0.9 * spacing, 1.1 * spacing}};
}

}  // namespace standoff::testing
