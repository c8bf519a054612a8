// SPDX-License-Identifier: Apache-2.0
// How fast the winding number of an open mesh may change from one place to another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sign/diagnosis/boundary.h"

namespace standoff {

/// Away from the mesh, the gradient of the winding number is that of its boundary's solid angle over 4 pi: the integral
/// of (x - e) x de / |x - e|^3 over the boundary's edges, by the law of Biot and Savart. So no longer than that of
/// |de| / |x - e|^2.
class WindingSlope {
 public:
  explicit WindingSlope(const Boundary& boundary);

  /// Not less than the gradient's length anywhere within a radius of a point, where no triangle is. Infinite if that
  /// cannot be said, or if it is more than `most`.
  double around(const Vec3& point, double radius, double most) const;
  std::int64_t memory_bytes() const { return static_cast<std::int64_t>(parts_.size() * sizeof(Part)); }

 private:
  static constexpr std::size_t kFanout = 16;

  // A ball around edges that are near each other; their length, as often as they count.
  struct Part {
    Vec3 center;
    double radius, length;
  };
  struct Sum;

  static Part around_all(const Part* parts, std::size_t count);
  void add(std::size_t level, std::size_t number, Sum& sum) const;

  std::vector<Part> parts_;         // of all levels: edges, sixteen of those, sixteen of these, ..
  std::vector<std::size_t> begin_;  // of each level, and the end
};

}  // namespace standoff
