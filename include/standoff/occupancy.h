// SPDX-License-Identifier: Apache-2.0
// Solid voxels: which samples of a grid are inside a mesh, without distances (docs/sign.md).
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"

namespace standoff {

/// One bit per sample of a grid: 1 inside, 0 outside.
struct STANDOFF_API Occupancy {
  Grid grid;
  /// Rows along x, one after the other, y before z. Each row begins with a new byte, and has its first sample in the
  /// lowest bit; the bits after its last sample are 0. numpy.unpackbits(bits, bitorder="little") gives the samples.
  std::vector<std::uint8_t> bits;
  SignReport sign;  ///< how inside was decided

  std::int64_t row_bytes() const { return (grid.size.x + 7) / 8; }
  /// Requires a sample of the grid.
  bool inside(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const std::int64_t byte = (k * grid.size.y + j) * row_bytes() + i / 8;
    return (bits[static_cast<std::size_t>(byte)] >> (i % 8) & 1) != 0;
  }
  /// How many samples are inside. Times the volume of a voxel, the solid's volume, nearly.
  std::int64_t count() const;
};

struct OccupancyOptions {
  SignOptions sign = {};     ///< a method that needs no distances: winding, parity, flood or automatic
  Execution execution = {};  ///< the backend must be automatic or cpu
  ProgressCallback progress = {};
};

/// Decides for each sample whether it is inside, exactly as compute() decides its sign. Takes a bit per sample and what
/// the sign needs. Runs on the CPU. Errors: as compute; usage also for other sign methods.
STANDOFF_API Occupancy occupancy(MeshView mesh, const Grid& grid, const OccupancyOptions& options = {});

}  // namespace standoff
