// SPDX-License-Identifier: Apache-2.0
#include "view/flight/flight.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "standoff/error.h"

namespace standoff::view {
namespace {

using namespace experimental;

FlightOptions inside(const CollisionModel& walls, FlightOptions options) {
  options.bounds = walls.bounds();
  return options;
}

void check(const FlightControls& controls) {
  const auto fail = [](const std::string& what) { throw Error(ErrorCode::usage, what); };
  if (!(controls.speed > 0) || !std::isfinite(controls.speed))
    fail("the speed is not positive; give world units a step");
  if (controls.bodies < 1 || controls.bodies > kMostBodies)
    fail("so many flies cannot be watched; give 1 to " + std::to_string(kMostBodies));
  if (!(controls.steps_per_second >= 0 && controls.steps_per_second <= kMostSteps))
    fail("so many steps a second cannot be watched; give 0 to 100000");
}

}  // namespace

Flight::Flight(const CollisionModel& walls, const CollisionModel& flier, const FlightOptions& options,
               std::int64_t bodies)
    : world_(flier, inside(walls, options)), box_(walls.bounds()), middle_(flier.bounds().center()) {
  world_.add(walls);
  controls_ = {options.mode, options.on_contact, options.speed, bodies, 60};
  check(controls_);
  for (std::int64_t n = 0; n < bodies; ++n) world_.add_flier(box_);
}

void Flight::change(const FlightControls& controls) {
  check(controls);
  const FlightOptions before = world_.options();
  FlightOptions options = before;
  options.mode = controls.mode;
  options.on_contact = controls.on_contact;
  options.speed = controls.speed;
  if (options.mode != before.mode || options.speed != before.speed || options.on_contact != before.on_contact)
    world_.set_options(options);
  try {
    while (world_.fliers().size() < static_cast<std::size_t>(controls.bodies)) world_.add_flier(box_);
  } catch (...) {
    world_.keep_fliers(static_cast<std::size_t>(controls_.bodies));
    world_.set_options(before);
    throw;
  }
  world_.keep_fliers(static_cast<std::size_t>(controls.bodies));
  controls_ = controls;
}

std::int64_t Flight::advance(double seconds, std::int64_t most_steps) {
  due_ += std::max(0.0, seconds) * controls_.steps_per_second;
  const double whole = std::floor(due_);
  due_ -= whole;
  const std::int64_t steps = std::min(static_cast<std::int64_t>(std::min(whole, 1e15)), most_steps);
  run(steps);
  return steps;
}

void Flight::run(std::int64_t steps) {
  world_.run(steps);
  step_ += steps;
}

FlightFrame Flight::frame() {
  const auto fliers = world_.fliers();
  std::vector<double> distances(fliers.size());
  world_.wall_distances(distances);
  FlightFrame frame{step_, {}};
  frame.bodies.reserve(fliers.size());
  for (std::size_t n = 0; n < fliers.size(); ++n) {
    const Flier& it = fliers[n];
    const Vec3 x = rotate(it.pose, {1, 0, 0});
    frame.bodies.push_back({apply(it.pose, middle_), std::atan2(-x.z, x.x), distances[n], it.collisions, it.crossings});
  }
  return frame;
}

std::vector<FlightFrame> recorded(Flight& flight, std::int64_t steps, std::int64_t every,
                                  const ProgressCallback& progress) {
  std::vector<FlightFrame> frames{flight.frame()};
  for (std::int64_t done = 0; done < steps;) {
    const std::int64_t now = std::min(every, steps - done);
    flight.run(now);
    done += now;
    frames.push_back(flight.frame());
    if (progress && !progress({"fly", static_cast<double>(done) / static_cast<double>(steps)}))
      throw Error(ErrorCode::interrupted, "interrupted");
  }
  return frames;
}

}  // namespace standoff::view
