// SPDX-License-Identifier: Apache-2.0
// Winding numbers of points, whole ones that change at triangles alone: what is known of one point tells those of
// others.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "points/cpu/kernels.h"
#include "points/ray_winding.h"
#include "standoff/vec.h"

namespace standoff {

/// The points that were asked last. Numbers are those of the points that symbolic perturbation makes of them
/// (sign/rows/ray_crossing.h).
class KnownWindings {
 public:
  /// Of the mesh that `rays` cross; both are kept by reference.
  KnownWindings(const RayWinding& rays, const cpu::PointKernels& kernels) : rays_(rays), kernels_(kernels) {}

  /// The number at the center of a ball without triangles, from a known ball that overlaps it. If there is none, from
  /// otherwise(at). It is known from then on.
  template <class Otherwise>
  std::int32_t in_ball(const Vec3& at, double radius, const Otherwise& otherwise) {
    const Known own{at, radius - 1e-12 * (radius + max_norm(at)), 0};  // radii are off by some 1e-16 of the coordinates
    const Known* const same = overlapping(own);
    const std::int32_t winding = same ? same->winding : otherwise(at);
    if (!same || own.radius > same->radius) add({own.at, own.radius, winding});  // else it says less about others
    return winding;
  }
  /// The number at a point that no known ball overlaps: from one that is on one of the point's rows, by the crossings
  /// between the two. If there is none, from otherwise(at).
  template <class Otherwise>
  std::int32_t on_row(const Vec3& at, const Otherwise& otherwise) const {
    const OnRow nearest = nearest_on_rows(at);
    if (!nearest.known) return otherwise(at);
    const double there = turned(nearest.known->at, nearest.axis).x;
    return nearest.known->winding + rays_.beyond(nearest.axis, there, at, kernels_);
  }
  /// The same from the nearest known point, by a row along each axis. Requires that one is known.
  std::int32_t by_rows(const Vec3& at) const;

 private:
  struct Known {
    Vec3 at;
    double radius;  // of a ball without triangles; not positive if none is known
    std::int32_t winding;
  };
  // A known ball on a row of a point, along which axis.
  struct OnRow {
    const Known* known;
    int axis;
  };

  std::span<const Known> all() const { return std::span(known_).first(std::min(count_, known_.size())); }
  void add(const Known& one);
  const Known* overlapping(const Known& own) const;
  OnRow nearest_on_rows(const Vec3& at) const;

  const RayWinding& rays_;
  const cpu::PointKernels& kernels_;
  std::array<Known, 8> known_;
  std::size_t count_ = 0;  // of all that were added; the oldest one makes room
};

}  // namespace standoff
