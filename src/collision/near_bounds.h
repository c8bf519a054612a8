// SPDX-License-Identifier: Apache-2.0
// What the searches for the nearest pair on the CPU and on a GPU share: which node of a pair is opened, boxes and axes
// in the frames of both bodies, and how far bounds in single precision must reach.
#pragma once

#include "collision/body/box_distance.h"
#include "collision/body/kernel_data.h"
#include "collision/tolerances.h"
#include "geometry/closest_pair.h"
#include "geometry/triangle_overlap.h"
#include "geometry/triple.h"

namespace standoff::collision {

/// The squared half diagonal. Of a pair of nodes the one whose box has the larger one is opened.
STANDOFF_INLINE float size_sq(const Obb& box) {
  return box.half[0] * box.half[0] + box.half[1] * box.half[1] + box.half[2] * box.half[2];
}
STANDOFF_INLINE bool opens_target(int target_level, const Obb& of_target, int probe_level, const Obb& of_probe) {
  return probe_level == 0 || (target_level > 0 && size_sq(of_target) >= size_sq(of_probe));
}

/// A box of the probe in the target's frame.
STANDOFF_INLINE Obb in_target(const FloatTransform& to_target, const Obb& box) {
  Obb moved;
  for (int axis = 0; axis < 3; ++axis) {
    const float* const r = to_target.rotation + 3 * axis;
    const auto rotated = [r](const float* v) { return r[0] * v[0] + r[1] * v[1] + r[2] * v[2]; };
    moved.center[axis] = rotated(box.center) + to_target.translation[axis];
    moved.half[axis] = box.half[axis];
    for (int k = 0; k < 3; ++k) moved.axis[k][axis] = rotated(box.axis[k]);
  }
  return moved;
}

/// A box of the target in the probe's frame.
STANDOFF_INLINE Obb in_probe(const FloatTransform& to_target, const Obb& box) {
  float center[3];
  for (int axis = 0; axis < 3; ++axis) center[axis] = box.center[axis] - to_target.translation[axis];
  Obb moved;
  for (int axis = 0; axis < 3; ++axis) {
    const float* const r = to_target.rotation + axis;
    const auto rotated = [r](const float* v) { return r[0] * v[0] + r[3] * v[1] + r[6] * v[2]; };
    moved.center[axis] = rotated(center);
    moved.half[axis] = box.half[axis];
    for (int k = 0; k < 3; ++k) moved.axis[k][axis] = rotated(box.axis[k]);
  }
  return moved;
}

/// Three perpendicular unit vectors; the first one has the direction of v, or any direction if v is zero.
struct PerpendicularAxes {
  Triple<double> axis[3];
};
STANDOFF_INLINE PerpendicularAxes perpendicular_axes(const Triple<double>& v) {
  const double size = sqrt(plain_dot(v, v));
  const Triple<double> first = size > 0 ? v * (1 / size) : Triple<double>{1, 0, 0};
  const double x = abs(first.x), y = abs(first.y), z = abs(first.z);
  const Triple<double> other = x <= y && x <= z ? Triple<double>{1, 0, 0}
                               : y <= z         ? Triple<double>{0, 1, 0}
                                                : Triple<double>{0, 0, 1};
  const Triple<double> across = plain_cross(first, other), second = across * (1 / sqrt(plain_dot(across, across)));
  return {{first, second, plain_cross(first, second)}};
}

/// A vector in the frame that a transform leads from.
STANDOFF_INLINE Triple<double> rotated_back(const DoubleTransform& transform, const Triple<double>& v) {
  const double* const r = transform.rotation;
  return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
          r[2] * v.x + r[5] * v.y + r[8] * v.z};
}

STANDOFF_INLINE Triple<double> center_of(const Obb& box) { return {box.center[0], box.center[1], box.center[2]}; }
STANDOFF_INLINE Triple<double> axis_of(const Obb& box, int k) {
  return {box.axis[k][0], box.axis[k][1], box.axis[k][2]};
}

/// From the center of a box of the target to that of a box of the probe, in the target's frame.
STANDOFF_INLINE Triple<double> offset_of(const DoubleTransform& to_target, const Obb& first, const Obb& second) {
  return transformed(to_target, center_of(second)) - center_of(first);
}

/// Axes of the target's frame for two leaves whose centers are apart by `offset`, from the target's to the probe's.
STANDOFF_INLINE LeafAxes leaf_axes(const DoubleTransform& to_target, const PerpendicularAxes& axes,
                                   const Triple<double>& offset) {
  LeafAxes both;
  for (int k = 0; k < 3; ++k) {
    const Triple<double>&of_target = axes.axis[k], of_probe = rotated_back(to_target, of_target);
    both.offset[k] = static_cast<float>(plain_dot(of_target, offset));
    both.first[k][0] = static_cast<float>(of_target.x), both.second[k][0] = static_cast<float>(of_probe.x);
    both.first[k][1] = static_cast<float>(of_target.y), both.second[k][1] = static_cast<float>(of_probe.y);
    both.first[k][2] = static_cast<float>(of_target.z), both.second[k][2] = static_cast<float>(of_probe.z);
  }
  return both;
}

// What a search for the nearest pair must look at, by the best distance so far.

/// Pairs whose distances differ by less than this are about equally near: bounds hardly tell them apart. `slack`: what
/// bounds of pairs of nodes may be off by.
STANDOFF_INLINE double about_equal(double distance, double slack) { return slack + kFarShare * distance; }

/// Squared bounds above this cannot hide a distance of at most `wanted`.
STANDOFF_INLINE float reach_sq(double wanted, double slack) {
  const float reach = static_cast<float>(wanted + slack);
  return reach < 0 ? -1 : reach * reach * (kRoundUp * kRoundUp);
}

/// What bounds of triangles of two leaves may be off by. `radii`: of both bodies together.
STANDOFF_INLINE double leaf_slack(double radii, const Obb& first, const Obb& second, double pose_slack) {
  const auto radius_of = [](const Obb& box) {
    const Triple<double> half{box.half[0], box.half[1], box.half[2]};
    return sqrt(plain_dot(half, half));
  };
  return kCornerSlack * radii + kLeafSlack * (radius_of(first) + radius_of(second)) + pose_slack;
}

}  // namespace standoff::collision
