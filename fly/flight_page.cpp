// SPDX-License-Identifier: Apache-2.0
#include "fly/flight_page.h"

#include "fly/flight.h"
#include "page/page.h"
#include "standoff/compute.h"
#include "standoff/page.h"
#include "standoff/surface.h"

namespace standoff::fly {
namespace {

using page::json_number;
using page::json_string;
using page::json_triple;
using page::JsonObject;
using page::Section;

constexpr double kShellShare = 0.25;  // of the fly's longest side
constexpr std::int64_t kShellSamples = 40;
constexpr std::int64_t kFlyTriangles = 350;      // of many flies
constexpr std::int64_t kWallTriangles = 16'000;  // walls are flat: this is enough to see them by

PageOptions options(std::int64_t proxy_triangles, std::string title = {}) {
  PageOptions options;
  options.title = std::move(title);
  options.up = Axis::y;
  options.proxy_triangles = proxy_triangles;
  return options;
}

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
    return mesh.triangles.empty() ? std::string() : page_data(PageMesh{name, mesh}, options(kFlyTriangles));
  };
  return {{"fly", packed("fly", subject.fly.mesh())}, {"shell", packed("shell", subject.shell)}};
}

}  // namespace

const char* name_of(experimental::FlightMode mode) {
  return mode == experimental::FlightMode::thesis ? "thesis" : "sweep";
}

double far_of(const FlightSubject& subject) { return subject.fly.bounds().longest_side() * 1.5; }

FlightSubject flight_subject(std::string walls_name, const CollisionModel& walls, const CollisionModel& flier,
                             const Execution& execution) {
  const Box box = flier.bounds();
  FlightSubject subject{std::move(walls_name), walls, flier, {}, kShellShare * box.longest_side()};
  if (!(subject.shell_distance > 0)) return subject;
  ComputeOptions compute_options;
  compute_options.execution = execution;
  const Padding padding{.length = 1.2 * subject.shell_distance};
  const Grid grid = fit_samples(box, kShellSamples, padding);
  const DistanceField field = compute(flier.mesh(), grid, kFullField, compute_options).field;
  subject.shell = isosurface(field, {.at = subject.shell_distance}).mesh;
  return subject;
}

std::string walls_data(const FlightSubject& subject) {
  return page_data(PageMesh{subject.walls_name, subject.walls.mesh()}, options(kWallTriangles));
}

std::string watched_data(const FlightSubject& subject, const FlightControls& controls) {
  const std::string asked = JsonObject()
                                .add("mode", json_string(name_of(controls.mode)))
                                .add("speed", json_number(controls.speed))
                                .add("flies", json_number(controls.bodies))
                                .add("rate", json_number(controls.steps_per_second))
                                .text();
  return page::packed_blob(header_of(subject).add("live", "true").add("controls", asked), bodies_of(subject), 1);
}

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
  const auto page = options(kWallTriangles, title);
  return page::html(title, page, {walls_data(subject), page::packed_blob(header, sections, page.compression)});
}

std::string watched_page(const FlightSubject& subject) {
  PageOptions page = options(kWallTriangles, "standoff fly: " + subject.walls_name);
  page.served = true;
  return make_page({}, {}, page);
}

}  // namespace standoff::fly
