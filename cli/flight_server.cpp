// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <thread>

#include "cli/flight_server.h"
#include "cli/json.h"
#include "cli/parse.h"

namespace standoff::cli {

using view::Reply;
using view::Request;

FlightServer::FlightServer(const fly::FlightSubject& subject, std::unique_ptr<fly::Flight> flight)
    : subject_(subject), walls_(fly::walls_data(subject)), show_(std::move(flight)) {}

void FlightServer::answer(const Request& request, std::string_view route, Reply& reply) {
  const bool post = request.method == "POST";
  if (post != (route == "controls"))
    return reply.refuse({405, post ? "this is asked for by GET" : "this is asked for by POST"});
  if (route.empty()) return reply.send(200, "text/html; charset=utf-8", fly::watched_page(subject_));
  if (route == "state") {
    const Json items = {{{"id", "walls"}, {"kind", "mesh"}}, {{"id", "flight"}, {"kind", "flight"}}};
    return reply.send(200, "application/json", Json{{"kind", "flight"}, {"items", items}}.dump());
  }
  if (route == "data") {
    const std::string* id = request.parameter("id");
    if (id && *id == "walls") return reply.send(200, "application/octet-stream", walls_);
    if (id && *id == "flight")
      return reply.send(200, "application/octet-stream", fly::watched_data(subject_, show_.controls()));
    return;
  }
  if (route == "events") return events(reply);
  if (route == "poses") return poses(reply);
  if (route == "controls") return change(request, reply);
}

void FlightServer::change(const Request& request, Reply& reply) {
  fly::FlightControls controls = show_.controls();
  if (const std::string* mode = request.parameter("mode"))
    controls.mode = parse_choice("mode", *mode, {"sweep", "thesis"}) == 0 ? experimental::FlightMode::sweep
                                                                          : experimental::FlightMode::thesis;
  if (const std::string* speed = request.parameter("speed")) controls.speed = parse_positive("speed", *speed);
  if (const std::string* flies = request.parameter("flies"))
    controls.bodies = parse_count("flies", *flies, 1, fly::kMostBodies);
  if (const std::string* rate = request.parameter("rate"))
    controls.steps_per_second = parse_not_negative("rate", *rate, fly::kMostSteps);
  show_.change(controls);
  reply.send(200, "application/json", "{}");
}

void FlightServer::poses(Reply& reply) {
  const view::PageWatch::Open open(watch_);
  if (!reply.begin_stream("application/octet-stream")) return;
  show_.watch([&](const std::string& frame) { return frame.empty() ? !reply.abandoned() : reply.part(frame); });
}

// Nothing is told here; the page sees by its end that the program was stopped.
void FlightServer::events(Reply& reply) {
  const view::PageWatch::Open open(watch_);
  if (!reply.begin_stream("text/event-stream") || !reply.part(": open\n\n")) return;
  while (!reply.abandoned()) std::this_thread::sleep_for(std::chrono::milliseconds(200));
}

}  // namespace standoff::cli
