// SPDX-License-Identifier: Apache-2.0
// Conservative advancement of one pair of triangles, in the world and in double precision.
#pragma once

#include <optional>

#include "collision/rigid_motion.h"
#include "geometry/triangle_pair.h"

namespace standoff::collision {

/// Finds when a triangle in motion comes within the tolerance of a resting one. Between the two lies a slab
/// (Slab), and its normal gives two lower bounds of the time until they touch; each step takes the later one.
class TriangleSweep {
 public:
  TriangleSweep(const QueryPair& pair, const AxisAngleMotion& path, double tolerance);

  /// The first contact of two triangles, given by their BVH indices, at a time in [from, until).
  std::optional<SweepResult> first_contact(std::uint32_t target_index, std::uint32_t probe_index, double from,
                                           double until) const;

 private:
  double time_to_reserve(const Corners& moving, double t, const Slab& slab, double reserve, double acceleration) const;
  SweepResult hit(double t, std::uint32_t target_index, std::uint32_t probe_index, Vec3 point, Vec3 normal) const;
  SweepResult hit(double t, std::uint32_t target_index, std::uint32_t probe_index, const ClosestPair& pair) const;

  const QueryPair& pair_;
  const AxisAngleMotion& path_;
  const double tolerance_;
  const double sure_direction_from_;  // nearer than this, rounding decides the direction between closest points
};

}  // namespace standoff::collision
