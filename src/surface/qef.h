// SPDX-License-Identifier: Apache-2.0
// The point of a cell that is nearest to all tangent planes of a loop, in least squares ("Dual contouring of Hermite
// data", Ju, Losasso, Schaefer, Warren 2002).
#pragma once

#include <array>

#include "standoff/vec.h"

namespace standoff {

/// The sum of squared distances from the planes added, as a function of the point.
class PlaneFit {
 public:
  void add(Vec3 point, Vec3 normal);
  bool empty() const { return count_ == 0; }
  /// The mean of the points added.
  Vec3 mass_point() const { return sum_ * (1.0 / count_); }
  /// The point of the box where the sum is least; where many are as good, the one nearest to the mass point. The least
  /// eigenvalues of the planes' normals, up to `tolerance` times the largest one, count as 0: in their directions the
  /// planes say nothing. Two planes at an angle of a have eigenvalues in the ratio tan(a/2)^2.
  Vec3 minimum(const Box& box, double tolerance) const;

 private:
  std::array<double, 6> normals_{};  // of the matrix A^T A: xx xy xz yy yz zz
  Vec3 right_;                       // A^T b, about the first point
  Vec3 first_, sum_, normal_sum_;
  int count_ = 0;
};

}  // namespace standoff
