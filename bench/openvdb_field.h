// SPDX-License-Identifier: Apache-2.0
// A field of standoff as a grid of OpenVDB: the same values in a level set.
#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>

#include "standoff/field.h"
#include "workload.h"

namespace standoff::bench {

/// Active voxels are those whose magnitude is below the thickness; the interior is filled with minus the thickness.
inline openvdb::FloatGrid::Ptr openvdb_field(const Workload& work, const DistanceField& field) {
  const Size3 n = work.grid.size;
  const Vec3 origin = work.grid.origin;
  const auto thickness = static_cast<float>(work.full() ? 1e30 : work.thickness);
  const auto grid = openvdb::FloatGrid::create(thickness);
  const auto transform = openvdb::math::Transform::createLinearTransform(work.grid.spacing.x);
  transform->postTranslate({origin.x, origin.y, origin.z});
  grid->setTransform(transform);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName("distance");
  auto voxels = grid->getAccessor();
  for (std::int64_t k = 0; k < n.z; ++k)
    for (std::int64_t j = 0; j < n.y; ++j)
      for (std::int64_t i = 0; i < n.x; ++i) {
        const float value = field.value(i, j, k);
        if (std::abs(value) < thickness) voxels.setValue({int(i), int(j), int(k)}, value);
      }
  if (!work.full()) openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

}  // namespace standoff::bench
