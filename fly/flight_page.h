// SPDX-License-Identifier: Apache-2.0
// A flight as a page: recorded, or watched while it goes on (view/README.md).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "fly/flight.h"
#include "standoff/mesh.h"
#include "view/server/server.h"

namespace standoff::fly {

/// What a flight is drawn with.
struct FlightSubject {
  std::string walls_name;
  Body walls, fly;
  Mesh shell;  ///< a surface of the fly's field, around it
  double shell_distance = 0;
  Axis up = Axis::y;  ///< of the walls
};

/// The shell is as far from the fly as a quarter of its box's longest side.
FlightSubject flight_subject(std::string walls_name, const Body& walls, const Body& flier, int threads);

/// From how far on a wall is shown as far, world units.
double far_of(const FlightSubject& subject);

/// A page that shows a recorded flight, `frames_per_second` of its frames a second. Errors: usage (no frames).
std::string flight_page(const FlightSubject& subject, std::span<const FlightFrame> frames, double frames_per_second,
                        const std::string& title);

/// What the page of `standoff fly --view` asks its server for.
class FlightServer {
 public:
  FlightServer(const FlightSubject& subject, std::unique_ptr<Flight> flight);

  void answer(const view::Request& request, std::string_view route, view::Reply& reply);
  view::PageWatch& watch() { return watch_; }

 private:
  void change(const view::Request& request, view::Reply& reply);
  void poses(view::Reply& reply);
  void events(view::Reply& reply);

  FlightSubject subject_;
  std::string walls_;
  FlightShow show_;
  view::PageWatch watch_;
};

/// "sweep" or "thesis".
const char* name_of(FlightMode mode);

}  // namespace standoff::fly
