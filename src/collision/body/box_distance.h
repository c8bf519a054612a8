// SPDX-License-Identifier: Apache-2.0
// How far apart two oriented boxes, and two triangles, are at least: by the gaps of their projections onto
// perpendicular vectors, in single precision. One source for a lane of a GPU and for sixteen floats at once; what it
// may be off by is in tolerances.h.
#pragma once

#include <limits>

#include "collision/body/kernel_data.h"
#include "geometry/closest_pair.h"
#include "geometry/triple.h"

namespace standoff::collision {

/// In place of a length of zero.
inline constexpr float kLeastLength = std::numeric_limits<float>::min();

template <class F>
STANDOFF_INLINE F along(const Triple<F>& p, const float (&axis)[3]) {
  return p.x * F(axis[0]) + p.y * F(axis[1]) + p.z * F(axis[2]);
}

template <class F>
STANDOFF_INLINE F squared_gap(const F& distance, const F& reach) {
  const F gap = max(distance - reach, F(0));
  return gap * gap;
}

/// Oriented boxes as in Obb: one, or one in each lane.
template <class F>
struct OrientedBoxes {
  Triple<F> center, axis[3];
  F half[3];
};

/// The squared distance between boxes and `box`, in one frame, at least: by their projections onto the axes of both,
/// onto the line of centers, and, where given, onto three more perpendicular unit vectors.
template <class F>
STANDOFF_INLINE F box_distance_sq(const OrientedBoxes<F>& boxes, const Obb& box, const float (*axes)[3]) {
  const Triple<F> offset = Triple<F>{F(box.center[0]), F(box.center[1]), F(box.center[2])} - boxes.center;
  F cosine[3][3];  // of the angle between two axes, their magnitudes
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) cosine[k][j] = abs(along(boxes.axis[k], box.axis[j]));
  F of_theirs(0), of_box(0), reach(0);
  for (int k = 0; k < 3; ++k) {
    const F at = abs(plain_dot(offset, boxes.axis[k]));
    F own = boxes.half[k];
    for (int j = 0; j < 3; ++j) own = own + cosine[k][j] * F(box.half[j]);
    of_theirs = of_theirs + squared_gap(at, own);
    reach = reach + boxes.half[k] * at;
  }
  for (int k = 0; k < 3; ++k) {
    const F at = abs(along(offset, box.axis[k]));
    F own(box.half[k]);
    for (int j = 0; j < 3; ++j) own = own + cosine[j][k] * boxes.half[j];
    of_box = of_box + squared_gap(at, own);
    reach = reach + F(box.half[k]) * at;
  }
  // Along the line of centers, times its length. The order of operations keeps the fourth power of a length out.
  const F length_sq = plain_dot(offset, offset), gap = max(length_sq - reach, F(0));
  const F of_line = gap / max(length_sq, F(kLeastLength)) * gap;
  F best = max(max(of_theirs, of_box), of_line);
  if (axes) {
    F of_axes(0);
    for (int k = 0; k < 3; ++k) {
      float own_of_box = 0;
      for (int j = 0; j < 3; ++j)
        own_of_box += box.half[j] * standoff::abs(box.axis[j][0] * axes[k][0] + box.axis[j][1] * axes[k][1] +
                                                  box.axis[j][2] * axes[k][2]);
      F own(own_of_box);
      for (int j = 0; j < 3; ++j) own = own + boxes.half[j] * abs(along(boxes.axis[j], axes[k]));
      of_axes = of_axes + squared_gap(F(abs(along(offset, axes[k]))), own);
    }
    best = max(best, of_axes);
  }
  return best;
}

/// The interval that a triangle covers on an axis.
template <class F>
struct Projection {
  F low, high;
};
template <class F>
STANDOFF_INLINE Projection<F> projected(const Triple<F> (&corner)[3], const float (&axis)[3]) {
  const F at[3] = {along(corner[0], axis), along(corner[1], axis), along(corner[2], axis)};
  return {min(at[0], min(at[1], at[2])), max(at[0], max(at[1], at[2]))};
}
template <class F>
STANDOFF_INLINE F squared_gap(const Projection<F>& a, const Projection<F>& b) {
  return squared_gap(max(a.low - b.high, b.low - a.high), F(0));
}

}  // namespace standoff::collision
