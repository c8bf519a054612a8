// SPDX-License-Identifier: Apache-2.0
// A flight as a page: watched while it goes on, or recorded.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cli/serve.h"
#include "fly/flight.h"
#include "fly/flight_page.h"
#include "standoff/collision.h"

namespace standoff::cli {

/// What the page of `standoff fly --view` asks its server for (view/README.md).
class FlightServer {
 public:
  FlightServer(const fly::FlightSubject& subject, std::unique_ptr<fly::Flight> flight);

  void answer(const view::Request& request, std::string_view route, view::Reply& reply);
  view::PageWatch& watch() { return watch_; }

 private:
  void change(const view::Request& request, view::Reply& reply);
  void poses(view::Reply& reply);
  void events(view::Reply& reply);

  fly::FlightSubject subject_;
  std::string walls_;
  fly::FlightShow show_;
  view::PageWatch watch_;
};

}  // namespace standoff::cli
