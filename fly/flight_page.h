// SPDX-License-Identifier: Apache-2.0
// Flights as pages hold them (view/README.md).
#pragma once

#include <span>
#include <string>

#include "fly/flight.h"
#include "standoff/mesh.h"

namespace standoff::fly {

/// What a flight is drawn with.
struct FlightSubject {
  std::string walls_name;
  CollisionModel walls, fly;
  Mesh shell;  ///< a surface of the fly's field, around it
  double shell_distance = 0;
};

/// The shell is as far from the fly as a quarter of its box's longest side.
FlightSubject flight_subject(std::string walls_name, const CollisionModel& walls, const CollisionModel& flier,
                             const Execution& execution);

/// From how far on a wall is shown as far, world units.
double far_of(const FlightSubject& subject);

/// The walls, with few triangles for while things move, which is always.
std::string walls_data(const FlightSubject& subject);
/// The fly, its shell, and what there is to say of the flight, for a page that watches it.
std::string watched_data(const FlightSubject& subject, const FlightControls& controls);
/// A page that shows a recorded flight, `frames_per_second` of its frames a second. Errors: usage (no frames).
std::string flight_page(const FlightSubject& subject, std::span<const FlightFrame> frames, double frames_per_second,
                        const std::string& title);

/// What the page of a flight is made with: y is up.
std::string watched_page(const FlightSubject& subject);

/// "sweep" or "thesis".
const char* name_of(experimental::FlightMode mode);

}  // namespace standoff::fly
