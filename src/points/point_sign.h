// SPDX-License-Identifier: Apache-2.0
// The signs of points by the planned method. For closed meshes: winding numbers by exact rays, and a cache that
// continues them to points nearby.
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

/// A ray runs along an axis, 0 to 2, up to larger coordinates or down to smaller ones.
struct RayDirection {
  int axis;
  bool up;
  double length;  ///< to where it leaves the mesh's box
};

/// The coordinates in cyclic order, `axis` first.
inline Vec3 cycled(const Vec3& v, int axis) {
  return axis == 0 ? v : axis == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
}

class RayWinding {
 public:
  /// Requires that `index` holds all triangles of mesh.mesh; both outlive this.
  RayWinding(const OrientedMesh& mesh, const TriangleIndex& index);

  /// The winding number at a point: with the symbolic perturbation of sign/rows/ray_crossing.h, so it equals the number
  /// of a sample in the same place. If only the orientation of the mesh is inconsistent, the parity is right.
  std::int32_t at(Vec3 point, const cpu::PointKernels& kernels) const { return at(point, shortest(point), kernels); }
  /// The same by a ray in a given direction. Two meshes that are closed only together need the same direction.
  std::int32_t at(Vec3 point, RayDirection direction, const cpu::PointKernels& kernels) const;
  /// The direction in which a ray leaves the mesh's box soonest.
  RayDirection shortest(Vec3 point) const;
  /// The number at `point` minus the number where the point's coordinate `axis` is `other`: it counts the crossings
  /// between the two.
  std::int32_t beyond(int axis, double other, Vec3 point, const cpu::PointKernels& kernels) const;

 private:
  // Calls use(triangle, how often it counts) for each triangle whose box meets a segment along an axis: the row through
  // `local` between the coordinates `from` and `to`, which may be infinite.
  template <class Use>
  void for_each_between(int axis, const Vec3& local, double from, double to, const cpu::PointKernels& kernels,
                        const Use& use) const;

  const OrientedMesh mesh_;
  const TriangleIndex& index_;
  Vec3 low_, high_;  // the box around all triangles, local
};

/// The winding numbers of the last points that were asked. The number of a closed mesh changes at triangles only, so a
/// known number continues to other points: within an empty ball unchanged, and along a row by the triangles crossed.
/// Points are perturbed symbolically (sign/rows/ray_crossing.h).
class WindingCache {
 public:
  /// For the mesh of `rays`; keeps both arguments by reference.
  WindingCache(const RayWinding& rays, const cpu::PointKernels& kernels) : rays_(rays), kernels_(kernels) {}

  /// The number at the center of a ball without triangles: the number of a known ball that overlaps it, else
  /// otherwise(at). The ball is known from then on.
  template <class Otherwise>
  std::int32_t in_ball(const Vec3& at, double radius, const Otherwise& otherwise) {
    const Ball own{at, radius - 1e-12 * (radius + max_norm(at)), 0};  // radii are off by some 1e-16 of the coordinates
    const Ball* const same = overlapping(own);
    const std::int32_t winding = same ? same->winding : otherwise(at);
    // A smaller ball than the known one is not worth a place.
    if (!same || own.radius > same->radius) add({own.at, own.radius, winding});
    return winding;
  }
  /// The number at a point outside all known balls: the number of a known ball that a row through the point meets, plus
  /// the crossings between the two. If no row meets one, otherwise(at).
  template <class Otherwise>
  std::int32_t on_row(const Vec3& at, const Otherwise& otherwise) const {
    const OnRow nearest = nearest_on_rows(at);
    if (!nearest.ball) return otherwise(at);
    const double there = cycled(nearest.ball->at, nearest.axis).x;
    return nearest.ball->winding + rays_.beyond(nearest.axis, there, at, kernels_);
  }
  /// The same from the nearest known center, to which three rows lead, one along each axis. Requires that a ball is
  /// known.
  std::int32_t by_rows(const Vec3& at) const { return by_rows_from(*nearest_center(at), at); }
  /// The same if that center is nearer than `within`, along the axis on which it is farthest; else otherwise(at).
  template <class Otherwise>
  std::int32_t by_rows(const Vec3& at, double within, const Otherwise& otherwise) const {
    const Ball* const nearest = nearest_center(at);
    return nearest && max_norm(nearest->at - at) < within ? by_rows_from(*nearest, at) : otherwise(at);
  }

 private:
  // A ball without triangles; if its radius is not positive, only the number at its center is known.
  struct Ball {
    Vec3 at;
    double radius;
    std::int32_t winding;
  };
  // A known ball that a row through a point meets, and the row's axis.
  struct OnRow {
    const Ball* ball;
    int axis;
  };

  std::span<const Ball> all() const { return std::span(balls_).first(std::min(count_, balls_.size())); }
  void add(const Ball& one);
  const Ball* overlapping(const Ball& own) const;
  OnRow nearest_on_rows(const Vec3& at) const;
  const Ball* nearest_center(const Vec3& at) const;
  std::int32_t by_rows_from(const Ball& known, const Vec3& at) const;

  const RayWinding& rays_;
  const cpu::PointKernels& kernels_;
  std::array<Ball, 8> balls_;
  std::size_t count_ = 0;  // all balls that were ever added: a new one replaces the oldest
};

/// A point whose nearest triangle is known.
struct PointToSign {
  Vec3 at;
  double free_radius;  ///< no triangle is nearer, world units
  std::uint32_t triangle;
};

/// Decides which points are inside.
class PointSigns {
 public:
  PointSigns() = default;
  PointSigns(const PointSigns&) = delete;
  PointSigns& operator=(const PointSigns&) = delete;
  virtual ~PointSigns() = default;

  /// Decides which of the points are inside; it is fastest if they are near each other. A point on the surface gets
  /// either answer. Many threads may call this at once. `check` counts work in units of some 100 ns, and may stop it.
  virtual void decide(std::span<const PointToSign> points, const cpu::PointKernels& kernels, WorkCheck& check,
                      std::span<bool> inside) const = 0;
  /// The winding number that decides. Throws Error{usage} unless the method is SignMethod::winding.
  virtual double winding_number(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const;
  /// Whether winding numbers take so long that even a few are worth several threads.
  virtual bool is_slow() const { return false; }
  virtual std::int64_t memory_bytes() const { return 0; }
};

/// Null if the plan has no sign, or its method only changes distances. `index` holds all triangles. Keeps all arguments
/// by reference. Runs on the threads of the calling TBB arena.
std::unique_ptr<PointSigns> make_point_signs(const OrientedMesh& mesh, const TriangleIndex& index, const SignPlan& plan,
                                             WindingRule rule, int threads, Simd simd);

}  // namespace standoff
