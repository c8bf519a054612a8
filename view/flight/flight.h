// SPDX-License-Identifier: Apache-2.0
// A flight that is watched: what is shown of it, and what a watcher may change while it goes on.
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/collision.h"
#include "standoff/experimental/simulation.h"

namespace standoff::view {

/// One moving body at one moment.
struct Flying {
  Vec3 at;                      ///< the middle of its box
  double heading_rad = 0;       ///< how far it is turned about the y axis
  double distance = 0;          ///< from `at` to the nearest wall, world units
  std::int64_t collisions = 0;  ///< so far, by this body
  std::int64_t crossings = 0;
};

struct FlightFrame {
  std::int64_t step = 0;  ///< since the beginning
  std::vector<Flying> bodies;
};

struct FlightControls {
  experimental::FlightMode mode = experimental::FlightMode::sweep;
  experimental::OnContact on_contact = experimental::OnContact::turn_back;
  double speed = 0.02;           ///< world units a step
  std::int64_t bodies = 1;       ///< 1 to kMostBodies
  double steps_per_second = 60;  ///< 0 stops it; at most kMostSteps

  friend bool operator==(const FlightControls&, const FlightControls&) = default;
};
inline constexpr std::int64_t kMostBodies = 1000;
inline constexpr double kMostSteps = 100'000;

class Flight {
 public:
  /// Bodies start at random places in the walls' box. Errors: as World.
  Flight(const CollisionModel& walls, const CollisionModel& flier, const experimental::FlightOptions& options,
         std::int64_t bodies);

  const FlightControls& controls() const { return controls_; }
  /// Errors: usage; input (no room for so many); the flight goes on as before.
  void change(const FlightControls& controls);

  /// Flies as many steps as `seconds` have at the controls' rate, whole ones; what is left over counts the next time.
  /// Never more than `most_steps`. Returns how many.
  std::int64_t advance(double seconds, std::int64_t most_steps);
  void run(std::int64_t steps);
  FlightFrame frame();

 private:
  experimental::World world_;
  Box box_;
  Vec3 middle_;
  FlightControls controls_;
  double due_ = 0;  // steps, a fraction of one
  std::int64_t step_ = 0;
};

/// A flight of `steps` steps as it is shown later: a frame at the beginning, and after every `every` steps.
std::vector<FlightFrame> recorded(Flight& flight, std::int64_t steps, std::int64_t every,
                                  const ProgressCallback& progress = {});

}  // namespace standoff::view
