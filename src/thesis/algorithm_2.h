// SPDX-License-Identifier: Apache-2.0
// What a sample decides in Algorithm 2 of the thesis (Fagerjord and Lochehina, 2008), for the CPU and for the GPU, and
// the seam between the algorithm and the devices that run it.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "geometry/host_device.h"
#include "geometry/triple.h"
#include "standoff/execution.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/pose.h"

namespace standoff::thesis {

/// A field in the world, beside its values.
struct PosedField {
  Grid grid;
  Pose pose;
  float thickness;
};

/// The nearest sample along an axis; -1 if it is not in the grid.
STANDOFF_HD inline std::int64_t nearest_index(double at, double origin, double spacing, std::int64_t size) {
  const double index = (at - origin) / spacing + 0.5;
  return index >= 0 && index < static_cast<double>(size) ? static_cast<std::int64_t>(index) : -1;
}

/// The sum of the value at sample (i,j,k) of a field and the value of the nearest sample of another one,
/// `other_value(u, v, w)`; infinite if one of them has none, which is so from the thickness on. It is never -0, so that
/// the least of several sums has the same bits in any order.
template <class ValueAt>
STANDOFF_HD double sum_at(const PosedField& visited, std::int64_t i, std::int64_t j, std::int64_t k, float value,
                          const PosedField& other, const ValueAt& other_value) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!(abs(value) < visited.thickness)) return kNone;
  const Vec3 p = apply_inverse(other.pose, apply(visited.pose, visited.grid.position(i, j, k)));
  const Grid& grid = other.grid;
  const std::int64_t u = nearest_index(p.x, grid.origin.x, grid.spacing.x, grid.size.x),
                     v = nearest_index(p.y, grid.origin.y, grid.spacing.y, grid.size.y),
                     w = nearest_index(p.z, grid.origin.z, grid.spacing.z, grid.size.z);
  if (u < 0 || v < 0 || w < 0) return kNone;
  const float theirs = other_value(u, v, w);
  if (!(abs(theirs) < other.thickness)) return kNone;
  return double{value} + double{theirs} + 0.0;
}

// Devices.

/// A field where a device can read it; each device derives its own from this.
struct HeldField {
  Grid grid;
  double thickness = 0;

  HeldField() = default;
  HeldField(const HeldField&) = delete;
  HeldField& operator=(const HeldField&) = delete;
  virtual ~HeldField() = default;

  PosedField at(const Pose& pose) const { return {grid, pose, static_cast<float>(thickness)}; }
};

/// What makes a minimum grid of a box: minimum_grid() in standoff/thesis.h.
struct MinimumRule {
  double thickness, e, speed;
};

/// A mesh and its field at one pose.
class MovingField {
 public:
  MovingField() = default;
  MovingField(const MovingField&) = delete;
  MovingField& operator=(const MovingField&) = delete;
  virtual ~MovingField() = default;

  /// Computes the field at another pose, in the place of the one before.
  virtual const HeldField& move_to(const Pose& pose) = 0;
};

/// Two fields of the same device. The first one is visited.
struct Algorithm2Job {
  const HeldField& visited;
  const Pose& of_visited;
  const HeldField& other;
  const Pose& of_other;
  int device;
};

/// The answer where no sample decides.
inline constexpr std::int64_t kNoSample = std::numeric_limits<std::int64_t>::max();

/// What a device does.
struct Algorithm2Functions {
  std::shared_ptr<const HeldField> (*hold)(DistanceField field, int device);
  std::unique_ptr<MovingField> (*moving)(const Mesh& mesh, const MinimumRule& rule, const Execution& execution);
  /// The index of the first sample, x fastest, whose sum is below the threshold, or kNoSample.
  std::int64_t (*first_below)(const Algorithm2Job& job, double threshold);
  /// The least sum, infinite if there is none.
  double (*least_sum)(const Algorithm2Job& job);
};

/// A row of the table of devices (src/backends/collision.cpp), the CPU among them.
struct Algorithm2Row {
  Backend backend;
  bool (*available)();
  std::string (*device_name)(int device);
  const Algorithm2Functions& run;
};

/// Throws Error{device} if there is no such device.
const Algorithm2Row& find_algorithm_2(Backend backend);

}  // namespace standoff::thesis

// CPU: src/thesis/algorithm_2.cpp. CUDA and its emulation: src/backends/cuda/algorithm_2.cu.

namespace standoff::cpu {
extern const thesis::Algorithm2Functions kAlgorithm2;
}
namespace standoff::cuda {
extern const thesis::Algorithm2Functions kAlgorithm2;
}
namespace standoff::emulated {
extern const thesis::Algorithm2Functions kAlgorithm2;
}
