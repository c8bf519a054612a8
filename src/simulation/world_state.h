// SPDX-License-Identifier: Apache-2.0
// What a world holds.
#pragma once

#include <optional>
#include <vector>

#include "simulation/crossing_check.h"
#include "standoff/experimental/simulation.h"
#include "standoff/field.h"
#include "standoff/points.h"

namespace standoff::experimental {

/// Errors: usage.
void check_options(const FlightOptions& options);

struct World::State {
  struct Resting {
    CollisionModel model;
    Pose pose;
    double tolerance;                    // of sweeps; fliers start twice as far away
    std::optional<DistanceField> field;  // thesis mode
    std::optional<CrossingCheck> check;
    std::optional<MeshQuery> query;  // of the model's mesh, once distances were asked for
  };

  CollisionModel flier;
  FlightOptions options;
  std::vector<Resting> resting;
  std::vector<Flier> fliers;
  std::optional<DistanceField> field;  // of the flier, in thesis mode
  std::vector<Vec3> marks;             // the points whose paths are checked

  // What the options ask for, of the moving body and of a resting one. A check that is there already is kept.
  void prepare();
  void prepare(Resting& body) const;
  DistanceField thesis_field(const CollisionModel& model) const;

  void step(Flier& it) const;
  bool leaves_bounds(const Pose& pose) const;
  bool thesis_hit(const Resting& body, const Pose& at) const;
  bool thesis_step(Flier& it, const Pose& next) const;
  bool sweep_step(Flier& it, Pose& next) const;
};

}  // namespace standoff::experimental
