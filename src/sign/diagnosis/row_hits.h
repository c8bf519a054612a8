// SPDX-License-Identifier: Apache-2.0
// Where rows along x through points of parts meet the parts whose boxes contain the point's part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/containers.h"
#include "sign/diagnosis/point_cells.h"
#include "sign/oriented_mesh.h"

namespace standoff {

/// A row meets a triangle.
struct RowHit {
  std::uint32_t row, part, triangle;
  std::int32_t step;  ///< RayTriangle::crossing
};

/// Each triangle is compared with the rows that may meet it.
class RowSearch {
 public:
  /// `part_of` for each triangle: a number in the order, or another one if it takes no part.
  RowSearch(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, const BoxOrder& order)
      : mesh_(mesh), part_of_(part_of), order_(order) {}

  /// How many triangles and rows find() compares.
  std::int64_t tests(std::span<const PartPoint> rows) const;
  /// All hits, by row, part, triangle. False if there are more than `most`, unless there is but one row.
  bool find(std::span<const PartPoint> rows, std::size_t most, std::vector<RowHit>& hits) const;

  /// Whether a point of the row is past the hit.
  bool is_past(const Vec3& at, const RowHit& hit) const;
  /// About where the row through `at` meets the hit.
  double x_of(const Vec3& at, const RowHit& hit) const;

 private:
  bool takes_part(std::size_t t) const { return mesh_.use_of(t) != 0 && part_of_[t] < order_.size(); }
  Box box_of(std::size_t t) const;

  OrientedMesh mesh_;
  std::span<const std::uint32_t> part_of_;
  const BoxOrder& order_;
};

}  // namespace standoff
