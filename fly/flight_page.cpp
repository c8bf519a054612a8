// SPDX-License-Identifier: Apache-2.0
#include "fly/flight_page.h"

#include <charconv>
#include <chrono>
#include <cstdint>
#include <system_error>
#include <thread>
#include <utility>

#include "page/page.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/page.h"
#include "standoff/surface.h"

namespace standoff::fly {
namespace {

using page::json_number;
using page::json_string;
using page::json_triple;
using page::JsonObject;
using page::Section;
using view::Reply;
using view::Request;

constexpr double kShellShare = 0.25;  // of the fly's longest side
constexpr std::int64_t kShellSamples = 40;
constexpr std::int64_t kFlyTriangles = 350;      // of many flies
constexpr std::int64_t kWallTriangles = 16'000;  // walls are flat: this is enough to see them by

PageOptions options(std::int64_t proxy_triangles) { return {.proxy_triangles = proxy_triangles}; }

JsonObject header_of(const FlightSubject& subject) {
  const Box box = subject.fly.bounds();
  return JsonObject()
      .add("kind", json_string("flight"))
      .add("name", json_string("flight in " + subject.walls_name))
      .add("middle", json_triple(box.center()))
      .add("length", json_number(box.longest_side()))
      .add("far", json_number(far_of(subject)))
      .add("spacing", json_number(box.longest_side() / 8))
      .add("shell", json_number(subject.shell_distance));
}

std::vector<Section> bodies_of(const FlightSubject& subject) {
  const auto packed = [](const char* name, MeshView mesh) {
    if (mesh.triangles.empty()) return std::string();
    return page::mesh_blob(PageMesh{name, mesh}, options(kFlyTriangles), nullptr, page::kAnyShape);
  };
  return {{"fly", packed("fly", subject.fly.mesh())}, {"shell", packed("shell", subject.shell)}};
}

}  // namespace

const char* name_of(FlightMode mode) { return mode == FlightMode::thesis ? "thesis" : "sweep"; }

double far_of(const FlightSubject& subject) { return subject.fly.bounds().longest_side() * 1.5; }

FlightSubject flight_subject(std::string walls_name, const Body& walls, const Body& flier, int threads) {
  const Box box = flier.bounds();
  FlightSubject subject{std::move(walls_name), walls, flier, {}, kShellShare * box.longest_side()};
  if (!(subject.shell_distance > 0)) return subject;
  ComputeOptions compute_options{.sign = {SignMethod::none}, .execution = {.threads = threads}};
  const Padding padding{.length = 1.2 * subject.shell_distance};
  const Grid grid = fit_resolution(box, kShellSamples, padding);
  const DistanceField field = compute(flier.mesh(), grid, kFullField, compute_options).field;
  subject.shell = surface(field, {.at = subject.shell_distance}).mesh;
  return subject;
}

namespace {

// The walls, with few triangles for while things move, which is always.
std::string walls_data(const FlightSubject& subject) {
  return page::mesh_blob(PageMesh{subject.walls_name, subject.walls.mesh()}, options(kWallTriangles), nullptr,
                         page::kAnyShape);
}

}  // namespace

std::string flight_page(const FlightSubject& subject, std::span<const FlightFrame> frames, double frames_per_second,
                        const std::string& title) {
  CodedFlight coded = coded_flight(frames);
  JsonObject header = header_of(subject);
  header.add("live", "false")
      .add("frames", json_number(coded.frames))
      .add("bodies", json_number(coded.bodies))
      .add("frames_per_second", json_number(frames_per_second))
      .add("step", json_number(coded.step))
      .add("origin", json_triple(coded.origin));
  std::vector<Section> sections = bodies_of(subject);
  sections.push_back({"positions", std::move(coded.positions)});
  sections.push_back({"distances", std::move(coded.distances)});
  sections.push_back({"headings", std::move(coded.headings)});
  sections.push_back({"collisions", std::move(coded.collisions)});
  sections.push_back({"crossings", std::move(coded.crossings)});
  sections.push_back({"steps", std::move(coded.steps)});
  PageOptions page = options(kWallTriangles);
  page.up = subject.up;
  return page::html(title, page, {walls_data(subject), page::packed_blob(header, sections, page.compression)});
}

namespace {

std::string watched_page(const FlightSubject& subject) {
  PageOptions page = options(kWallTriangles);
  page.title = "standoff fly: " + subject.walls_name;
  page.up = subject.up;
  page.served = true;
  return make_page({}, {}, page);
}

// The fly, its shell, and what there is to say of the flight, for a page that watches it.
std::string watched_data(const FlightSubject& subject, const FlightControls& controls) {
  const std::string asked = JsonObject()
                                .add("mode", json_string(name_of(controls.mode)))
                                .add("speed", json_number(controls.speed))
                                .add("flies", json_number(controls.bodies))
                                .add("rate", json_number(controls.steps_per_second))
                                .text();
  return page::packed_blob(header_of(subject).add("live", "true").add("controls", asked), bodies_of(subject), 1);
}

// A control's number. Errors: usage.
template <class Number>
Number number_of(const char* control, const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    throw Error(ErrorCode::usage, std::string(control) + " '" + text + "': give a number");
  return number;
}

// Errors: usage.
FlightMode mode_of(const std::string& text) {
  for (const FlightMode mode : {FlightMode::sweep, FlightMode::thesis})
    if (text == name_of(mode)) return mode;
  throw Error(ErrorCode::usage, "mode '" + text + "': give sweep or thesis");
}

}  // namespace

FlightServer::FlightServer(const FlightSubject& subject, std::unique_ptr<Flight> flight)
    : subject_(subject), walls_(walls_data(subject)), show_(std::move(flight)) {}

void FlightServer::answer(const Request& request, std::string_view route, Reply& reply) {
  const bool post = request.method == "POST";
  if (post != (route == "controls"))
    return reply.refuse({405, post ? "this is asked for by GET" : "this is asked for by POST"});
  if (route.empty()) return reply.send(200, "text/html; charset=utf-8", watched_page(subject_));
  if (route == "state")
    return reply.send(200, "application/json",
                      R"({"kind":"flight","items":[{"id":"walls","kind":"mesh"},{"id":"flight","kind":"flight"}]})");
  if (route == "data") {
    const std::string* id = request.parameter("id");
    if (id && *id == "walls") return reply.send(200, "application/octet-stream", walls_);
    if (id && *id == "flight")
      return reply.send(200, "application/octet-stream", watched_data(subject_, show_.controls()));
    return;
  }
  if (route == "events") return events(reply);
  if (route == "poses") return poses(reply);
  if (route == "controls") return change(request, reply);
}

void FlightServer::change(const Request& request, Reply& reply) {
  FlightControls controls = show_.controls();
  if (const std::string* mode = request.parameter("mode")) controls.mode = mode_of(*mode);
  if (const std::string* speed = request.parameter("speed")) controls.speed = number_of<double>("speed", *speed);
  if (const std::string* flies = request.parameter("flies")) controls.bodies = number_of<std::int64_t>("flies", *flies);
  if (const std::string* rate = request.parameter("rate")) controls.steps_per_second = number_of<double>("rate", *rate);
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

}  // namespace standoff::fly
