// SPDX-License-Identifier: Apache-2.0
// The inner loops of the queries, compiled once per instruction set; the answers do not depend on the set.
#pragma once

#include <cstdint>
#include <span>

#include "collision/body/kernel_data.h"
#include "standoff/execution.h"

namespace standoff::collision {

struct Kernels {
  const char* name;
  /// Writes lower bounds of the distance between 16 spheres, placed in the field's frame, and the surface; negative if
  /// a sphere may touch it. If a bound from the coarse field exceeds `enough`, the fine field is not sampled.
  void (*gaps)(const FieldView&, const FloatTransform&, const Sphere16&, float enough, float* gap);
  /// The same for spheres whose centres are in the field's frame already.
  void (*gaps_at)(const FieldView&, const float (*center)[kLanes], const float* radius, float enough, float* gap);
  /// Returns bit n if box n and `box` share a point.
  std::uint32_t (*overlapping)(const Boxes16&, const FloatBox& box);
  /// Squared distances between oriented boxes and `box`, in one frame, at least: by their projections onto the axes of
  /// both, onto the line of centers, and, where given, onto three more perpendicular unit vectors. Returns bits of
  /// those that are at most `most_sq`.
  std::uint32_t (*obb_distances_sq)(const Obb16&, const Obb& box, const float (*axes)[3], float most_sq,
                                    float* distance_sq);
  /// Pairs of a triangle of a leaf and one of another whose projections onto both sets of axes are no farther apart
  /// than the root of most_sq. Of each leaf the center that the axes' offsets lead from and to, and the number of its
  /// triangles. Returns how many pairs there are.
  int (*near_triangles)(const Triangle16& first, const float (&center)[3], int count, const Triangle16& second,
                        const float (&second_center)[3], int second_count, const LeafAxes (&axes)[2], float most_sq,
                        LeafPair* pairs);
  /// Writes how long sixteen oriented boxes stay farther than `keep` from `box`, at least. They are in one frame, and
  /// either the sixteen or `box` move. Times above `enough` may be too short.
  void (*obb_free_times)(const Obb16&, const DoubleObb& box, bool sixteen_move, const RigidVelocity&, double keep,
                         double enough, double* time);
  /// The same for one pair.
  double (*obb_free_time)(const DoubleObb& resting, const DoubleObb& moving, const RigidVelocity&, double keep);
  /// Writes, for each of sixteen resting triangles, bits of the moving ones that may come within `keep` of it during
  /// `duration`: that neither one of the axes, unit vectors, nor the normal of a triangle separates from it.
  void (*approaching_triangles)(const DoubleTriangles& resting, const DoubleTriangles& moving,
                                const DoubleTransform& to_resting, const RigidVelocity&, const Vec3 (&axes)[kLeafAxes],
                                double keep, double duration, std::uint32_t* moving_lanes);
  /// Transforms 16 triangles into another frame, and writes their boxes grown by `by`; `all` becomes the box around
  /// them.
  void (*transform_triangles)(const FloatTransform&, const Triangle16&, float by, Triangle16& transformed,
                              Boxes16& boxes, FloatBox& all);
  /// Writes the pairs of triangles, one of each packet, whose boxes share a point and which neither triangle's normal
  /// separates by more than `apart`. Returns their number. It is fastest if b has fewer lanes.
  int (*close_pairs)(const TriangleSubset& a, const TriangleSubset& b, float apart, LanePair* pairs);
  /// Decides eight pairs in the world; `transform_p` and `transform_q`, unless null, transform their corners to it.
  void (*overlap_pairs)(const TrianglePairs&, const DoubleTransform* transform_p, const DoubleTransform* transform_q,
                        PairOverlaps&);
  /// Finds the closest points of eight pairs that do not cross; the transforms are the same as for overlap_pairs.
  void (*closest)(const TrianglePairs&, const DoubleTransform* transform_p, const DoubleTransform* transform_q,
                  ClosestOfPairs&);

  static const Kernels portable, avx2, avx512;  ///< defined in kernels_<set>.cpp
};

/// The kernels for an instruction set; the best set for Simd::automatic. Throws Error{usage} that begins with `where`
/// if the processor lacks the set.
const Kernels& kernels_for(Simd simd, const char* where);
/// The best kernels that this processor can run.
const Kernels& best_kernels();
/// The kernels of all sets that this processor can run, the best first; for tests.
std::span<const Kernels* const> all_kernels();

}  // namespace standoff::collision
