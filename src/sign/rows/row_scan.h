// SPDX-License-Identifier: Apache-2.0
// Finds where triangles cross the rows of a grid: in single precision (cpu/row_patch.h), and exactly (ray_crossing.h)
// where its rounding might change the answer.
#pragma once

#include <array>
#include <cstdint>

#include "sign/cpu/kernels.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/crossing_list.h"
#include "sign/rows/sample_axis.h"
#include "standoff/grid.h"

namespace standoff {

/// Rows of a grid, those of whole rows of tiles or one alone: begin <= row < end along y and along z, and within the
/// grid. At most 2^17 rows of tiles.
struct RowWindow {
  std::array<std::int64_t, 2> begin, end;
};

class RowScan {
 public:
  /// Requires a valid mesh and grid; the mesh outlives the scan.
  RowScan(const OrientedMesh& mesh, const Grid& grid, Simd simd = Simd::automatic);

  /// Adds the crossings of triangles first to end - 1 with the window's rows to the list, but for those past the last
  /// sample. Returns whether it had room for all.
  bool scan(std::size_t first, std::size_t end, const RowWindow& window, CrossingList& list) const;

 private:
  struct Batch;
  // How many rows, along y and along z.
  struct Extent {
    std::int64_t columns, planes;
  };
  // Where a patch is.
  struct Place {
    std::size_t triangle;
    std::int64_t base, j, k;  // of x = 0, and of the first row
  };

  template <bool kPacked>
  bool scan_filtered(std::size_t first, std::size_t end, Batch& batch) const;
  bool add_strips(const cpu::RowPatch& patch, const Extent& rows, const Place& place, Batch& batch) const;
  bool add_rows(const Place& place, const Extent& rows, Batch& batch) const;
  bool add_all_exactly(std::size_t triangle, const RowWindow& window, Batch& batch) const;
  bool add_exactly(std::size_t triangle, const std::array<Vec3, 3>& corners, std::int64_t j, std::int64_t k,
                   Batch& batch) const;
  bool finish(Batch& batch) const;

  OrientedMesh mesh_;
  Grid grid_;
  SampleAxis x_, y_, z_;
  double slack_;  // what a coordinate in samples may be off by
  bool filters_;  // whether single precision will do for anything
  const cpu::SignKernels* kernels_;
};

}  // namespace standoff
