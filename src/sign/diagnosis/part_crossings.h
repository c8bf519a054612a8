// SPDX-License-Identifier: Apache-2.0
// The parts of a mesh by their boxes, and where rows along x through points of parts cross other parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sign/oriented_mesh.h"

namespace standoff {

/// The solid parts in an order of their boxes: what contains another one comes first; of equal boxes the first contains
/// the others. A part is named by its place in it.
class PartOrder {
 public:
  explicit PartOrder(std::vector<Box> sorted) : boxes_(std::move(sorted)) {}
  const Box& operator[](std::uint32_t n) const { return boxes_[n]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(boxes_.size()); }

  /// Whether the box of `outer` contains that of `inner`.
  bool may_contain(std::uint32_t outer, std::uint32_t inner) const {
    if (outer >= inner) return false;
    const Box &a = boxes_[outer], &b = boxes_[inner];
    return a.min.x <= b.min.x && a.min.y <= b.min.y && a.min.z <= b.min.z &&  //
           a.max.x >= b.max.x && a.max.y >= b.max.y && a.max.z >= b.max.z;
  }

 private:
  std::vector<Box> boxes_;
};

/// For each part, whether its box is in another one's, and whether its box contains no other one's.
struct Candidates {
  std::vector<std::uint8_t> inner, innermost;
  std::int64_t tests = 0;
};
/// `tests` is how many pairs of boxes are compared; where it is more than `most_tests`, nothing else is known.
Candidates find_candidates(const PartOrder& order, std::int64_t most_tests);

/// A point on the surface of a part.
struct PartPoint {
  Vec3 at;
  std::uint32_t part;
};

/// A row, the n-th of those asked for, crosses a triangle of a part.
struct PartCrossing {
  std::uint32_t row, part, triangle;
  std::int32_t step;  ///< of the part's winding number (RayTriangle::crossing)
};

/// Finds where rows along x, each through a point of a part, cross the parts that may contain that part. Each triangle
/// looks for the rows that may cross it.
class PartCrossings {
 public:
  /// `part_of` for each triangle: a part, or a number past all of them if the triangle is not looked at.
  PartCrossings(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, const PartOrder& order)
      : mesh_(mesh), part_of_(part_of), order_(order) {}

  /// How many pairs of a triangle and a row find() compares.
  std::int64_t tests(std::span<const PartPoint> rows) const;
  /// All crossings, by row, part, triangle. False, and none, if there are more than `most`. Takes memory for `most`.
  bool find(std::span<const PartPoint> rows, std::size_t most, std::vector<PartCrossing>& crossings) const;

  /// Whether a point of the row is past the crossing.
  bool is_past(const Vec3& at, const PartCrossing& crossing) const;
  /// About where the row through `at` crosses.
  double x_of(const Vec3& at, const PartCrossing& crossing) const;

 private:
  bool is_looked_at(std::size_t t) const { return mesh_.use_of(t) != 0 && part_of_[t] < order_.size(); }
  Box bounds_of(std::size_t t) const;

  OrientedMesh mesh_;
  std::span<const std::uint32_t> part_of_;
  const PartOrder& order_;
};

}  // namespace standoff
