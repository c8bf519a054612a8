// SPDX-License-Identifier: Apache-2.0
// A world between two runs: other options, other bodies, how near the walls are.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/guarded.h"
#include "simulation/world_state.h"
#include "standoff/compute.h"
#include "standoff/thesis.h"

namespace standoff::experimental {

void check_options(const FlightOptions& o) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::usage, std::string("simulation: ") + what); };
  if (!(o.speed >= 0) || !std::isfinite(o.speed))
    fail("the speed must be zero or more, and finite; give world units a step");
  if (!(o.scatter_rad >= 0 && o.scatter_rad <= std::numbers::pi))
    fail("the scatter must be from 0 to pi; 0 turns that off");
  if (!(o.tolerance >= 0) || !std::isfinite(o.tolerance))
    fail("the tolerance must be zero or more, and finite; give a small part of the bodies' size, or 0");
  if (!(o.thickness > 0) || !std::isfinite(o.thickness))
    fail("the thickness must be positive and finite; give a few steps' length");
  if (!(o.threshold >= 0) || !std::isfinite(o.threshold))
    fail("the threshold must be zero or more, and finite; 0 takes the larger spacing");
  validate("simulation", o.execution, Runs::on_the_cpu);
}

DistanceField World::State::thesis_field(const CollisionModel& model) const {
  const Grid grid = minimum_grid(model.bounds(), options.thickness, options.minimum, options.speed);
  ComputeOptions compute_options;
  compute_options.execution = options.execution;
  return compute(model.mesh(), grid, options.thickness, compute_options).field;
}

void World::State::prepare() {
  field.reset();
  if (options.mode == FlightMode::thesis) field = thesis_field(flier);
  if (options.check && marks.empty()) marks = outermost_points(flier.mesh());
}

void World::State::prepare(Resting& body) const {
  body.tolerance = options.tolerance > 0 ? options.tolerance : automatic_tolerance(body.model, flier);
  body.field.reset();
  if (options.mode == FlightMode::thesis) body.field = thesis_field(body.model);
  if (options.check && !body.check) body.check.emplace(body.model.mesh(), body.pose);
}

const FlightOptions& World::options() const { return state_->options; }

void World::set_options(const FlightOptions& options) try {
  check_options(options);
  // Into a copy: what fails changes nothing.
  State changed = *state_;
  changed.options = options;
  changed.prepare();
  for (State::Resting& body : changed.resting) changed.prepare(body);
  *state_ = std::move(changed);
} catch (...) {
  throw_as_error("simulation");
}

void World::restore_flier(const Flier& flier) try {
  validate(flier.pose);
  if (!(std::abs(length(flier.direction) - 1) < 1e-6))
    throw Error(ErrorCode::usage, "simulation: a direction is not one long; give a unit vector");
  state_->fliers.push_back(flier);
} catch (...) {
  throw_as_error("simulation");
}

void World::keep_fliers(std::size_t count) {
  if (count < state_->fliers.size()) state_->fliers.resize(count);
}

void World::wall_distances(std::span<double> out) try {
  if (out.size() != state_->fliers.size())
    throw Error(ErrorCode::usage, "simulation: there are " + std::to_string(state_->fliers.size()) +
                                      " moving bodies; give room for as many distances");
  std::vector<Vec3> points(out.size());
  std::vector<double> distances(out.size());
  std::ranges::fill(out, std::numeric_limits<double>::infinity());
  const Vec3 middle = state_->flier.bounds().center();
  for (State::Resting& body : state_->resting) {
    if (!body.query) body.query.emplace(body.model.mesh(), MeshQueryOptions{.execution = state_->options.execution});
    for (std::size_t n = 0; n < points.size(); ++n)
      points[n] = apply_inverse(body.pose, apply(state_->fliers[n].pose, middle));
    // One by one: points far from each other have no triangles in common, and are slow to ask for together.
    for (std::size_t n = 0; n < points.size(); ++n) {
      body.query->distances({&points[n], 1}, {&distances[n], 1}, {.threads = 1});
      out[n] = std::min(out[n], distances[n]);
    }
  }
} catch (...) {
  throw_as_error("simulation");
}

}  // namespace standoff::experimental
