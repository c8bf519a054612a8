// SPDX-License-Identifier: Apache-2.0
// Functions of the 2008 master's thesis alone: Fagerjord and Lochehina, "GPGPU: Fast and easy Distance Field
// computation on GPU" (docs/thesis.md). Use them only for comparison: their answers may be wrong.
//
// Algorithm 1 is Method::thesis, and its skip rule is SkipRule::Kind::neighbour, both in standoff/compute.h: they fill
// the same fields by the same call, so functions of their own would only repeat it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh_view.h"
#include "standoff/pose.h"

namespace standoff {

/// The thesis's minimum grid: the box grown by the thickness, (max - min) / thickness * e samples per axis, rounded up,
/// at least 2. `e` is 2 to 4 in the thesis. `speed`, the distance that a body moves in one step, makes the grid finer:
/// the factor is then e * (1 + speed / thickness). Errors: usage if the thickness is not positive and finite, e < 1, or
/// speed < 0.
STANDOFF_API Grid minimum_grid(const Box& box, double thickness, double e = 2, double speed = 0);

/// Algorithm 2 of the 2008 thesis, for comparison. Of the field with fewer samples, it visits those samples that lie in
/// the other field's grid. The bodies collide if, for one of these samples, its value and that of the nearest sample of
/// the other field are both below the thickness of their fields, and the sum of the values is below `threshold`. The
/// algorithm misses collisions and raises false alarms; docs/thesis.md says how often.
struct ThesisCollisionResult {
  bool hit = false;
  /// How many samples of the field with fewer were visited, x fastest: all up to the first that decides, or all there
  /// are; 0 if the boxes of the grids are apart.
  std::int64_t samples = 0;
};
STANDOFF_API ThesisCollisionResult collide_thesis(const DistanceField& a, const Pose& pose_a, const DistanceField& b,
                                                  const Pose& pose_b, double threshold);
/// The least such sum, from which a threshold can be chosen; infinite if there is none.
STANDOFF_API double thesis_sum(const DistanceField& a, const Pose& pose_a, const DistanceField& b, const Pose& pose_b);

namespace thesis {
struct Algorithm2Row;
struct HeldField;
}  // namespace thesis

/// A field where Algorithm 2 runs: on the CPU, or in the memory of a GPU, into which it is copied once, one value per
/// sample. Copies of a ThesisField share the field.
class STANDOFF_API ThesisField {
 public:
  /// Backend::automatic is the CPU: the test of one pose is little work. Errors: usage (execution), device, limit (the
  /// device's memory).
  explicit ThesisField(DistanceField field, const Execution& execution = {});
  // There are no moves, because they would leave an empty field behind.
  ThesisField(const ThesisField&) = default;
  ThesisField& operator=(const ThesisField&) = default;
  ~ThesisField() = default;

  const Grid& grid() const;
  double thickness() const;
  Backend backend() const;
  /// The name of the GPU; empty on the CPU.
  std::string device_name() const;

 private:
  friend class MinimumField;
  friend struct ThesisFieldAccess;
  ThesisField(std::shared_ptr<const thesis::HeldField> held, const thesis::Algorithm2Row* row, int device)
      : held_(std::move(held)), row_(row), device_(device) {}

  std::shared_ptr<const thesis::HeldField> held_;
  const thesis::Algorithm2Row* row_;
  int device_;
};

/// Algorithm 2 where the fields are, with the same answers as above, on every device. May be called from several
/// threads. Errors: usage (threshold, poses, fields that are on different devices), device.
STANDOFF_API ThesisCollisionResult collide_thesis(const ThesisField& a, const Pose& pose_a, const ThesisField& b,
                                                  const Pose& pose_b, double threshold);
STANDOFF_API double thesis_sum(const ThesisField& a, const Pose& pose_a, const ThesisField& b, const Pose& pose_b);

/// The minimum field of a mesh that moves, computed anew wherever it is. On a GPU the mesh is copied there once; then
/// it is moved, its box is found, and its field is computed, in the GPU's memory.
class STANDOFF_API MinimumField {
 public:
  /// `thickness`, `e` and `speed`: as for minimum_grid(). Copies the mesh. Backend::automatic is the CPU. Errors: input
  /// (mesh), usage (execution, and as minimum_grid), device, limit (the device's memory).
  MinimumField(MeshView mesh, double thickness, double e = 2, double speed = 0, const Execution& execution = {});
  // As above.
  MinimumField(const MinimumField&) = default;
  MinimumField& operator=(const MinimumField&) = default;
  ~MinimumField() = default;

  /// The field of the mesh at a pose, in world coordinates: on the minimum grid of the moved mesh's box, by Algorithm 1
  /// without a skip rule, without a sign. It has the same bits on every device. Its memory is used again for another
  /// pose once it and its copies are gone. May be called from several threads; each of those at work at the same time
  /// has memory of its own. Errors: usage (pose), limit (memory, sizes), device.
  ThesisField at(const Pose& pose) const;
  Backend backend() const;
  /// The name of the GPU; empty on the CPU.
  std::string device_name() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace standoff
