// SPDX-License-Identifier: Apache-2.0
// Which points are inside: by the winding number of a closed mesh, by what is known of points nearby, and by the
// planned method.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/progress.h"
#include "points/cpu/kernels.h"
#include "points/triangle_index.h"
#include "sign/oriented_mesh.h"
#include "sign/plan.h"
#include "standoff/vec.h"

namespace standoff {

// The winding number of a closed mesh at a point: the crossings of a ray from the point, counted exactly.

/// The direction of a ray: along an axis, 0 to 2, towards larger or smaller coordinates.
struct RayWay {
  int axis;
  bool up;
};

/// The vector in coordinates whose first axis is `axis`; the other two follow in a circle.
inline Vec3 turned(const Vec3& v, int axis) {
  return axis == 0 ? v : axis == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
}

class RayWinding {
 public:
  /// Requires the index of all triangles of mesh.mesh; both outlive this.
  RayWinding(const OrientedMesh& mesh, const TriangleIndex& index);

  /// The same numbers, with the same symbolic perturbation, as rows of samples have (sign/rows/ray_crossing.h). Of a
  /// mesh that is closed but for its orientation, the parity is right.
  std::int32_t at(Vec3 point, const cpu::PointKernels& kernels) const { return at(point, shortest(point), kernels); }
  /// What the ray that way says: for meshes that are closed only together, which must be asked the same way.
  std::int32_t at(Vec3 point, RayWay way, const cpu::PointKernels& kernels) const;
  /// The way on which a ray leaves the mesh's box soonest.
  RayWay shortest(Vec3 point) const;
  /// The number at the point less the one where its coordinate `axis` is `other`: the crossings between the two.
  std::int32_t beyond(int axis, double other, Vec3 point, const cpu::PointKernels& kernels) const;

 private:
  // Calls use(triangle, how often it counts) for the triangles whose boxes a row meets between two local points, along
  // an axis. The points may be anywhere.
  template <class Use>
  void for_each_between(int axis, const Vec3& local, double from, double to, const cpu::PointKernels& kernels,
                        const Use& use) const;

  const OrientedMesh mesh_;
  const TriangleIndex& index_;
  Vec3 low_, high_;  // of the box around all, local
};

// Winding numbers of points, whole ones that change at triangles alone: what is known of one point tells those of
// others.

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

// Which points are inside, by the planned method.

/// A point whose nearest triangle is known. `free_radius`: nearer than that there is no triangle, world units.
struct PointToSide {
  Vec3 at;
  double free_radius;
  std::uint32_t triangle;
};

class SidesOfPoints {
 public:
  SidesOfPoints() = default;
  SidesOfPoints(const SidesOfPoints&) = delete;
  SidesOfPoints& operator=(const SidesOfPoints&) = delete;
  virtual ~SidesOfPoints() = default;

  /// Decides for each of some points, which had better be near each other. Points on the surface get one of its sides.
  /// Many threads may ask at once. `check` counts work in some 100 ns, and may stop it.
  virtual void decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels, WorkCheck& check,
                      std::span<bool> inside) const = 0;
  /// The winding number that decides; only of SignMethod::winding.
  virtual double winding_number(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const;
  /// Whether winding numbers take so long that threads had better share few of them.
  virtual bool is_slow() const { return false; }
  virtual std::int64_t memory_bytes() const { return 0; }
};

/// Null if the plan has no sign, or its method changes distances alone. `index` is that of all triangles. All that is
/// given is kept by reference. Runs on the threads of the calling TBB arena.
std::unique_ptr<SidesOfPoints> make_sides_of_points(const OrientedMesh& mesh, const TriangleIndex& index,
                                                    const SignPlan& plan, WindingRule rule, int threads, Simd simd);

}  // namespace standoff
