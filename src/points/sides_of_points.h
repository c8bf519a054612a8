// SPDX-License-Identifier: Apache-2.0
// Which points are inside, by the planned method.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/progress.h"
#include "points/cpu/kernels.h"
#include "points/triangle_index.h"
#include "sign/plan.h"

namespace standoff {

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
