// SPDX-License-Identifier: Apache-2.0
#include "cli/mesh_report.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "cli/text.h"

namespace standoff::cli {
namespace {

constexpr std::size_t kShownComponents = 4;

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, share < 0.0995 ? "%.2g %%" : "%.0f %%", 100 * share);
  return text;
}

// "3 flipped, 2 degenerate": the counts that are not 0.
std::string list_of(const std::vector<std::pair<std::int64_t, const char*>>& counts, const char* none) {
  std::string text;
  for (const auto& [count, what] : counts)
    if (count > 0) text += (text.empty() ? "" : ", ") + grouped(count) + " " + what;
  return text.empty() ? none : text;
}

std::string closed_text(const MeshReport& r) {
  if (r.closed()) return "yes";
  if (r.triangles == 0) return "no";
  std::string text = "no: " + counted(r.boundary_edges, "boundary edge") + " in " + counted(r.boundary_loops, "loop") +
                     ", the largest " + number(r.largest_hole) + " across";
  if (r.largest_hole_in_samples > 0) text += " (" + number(r.largest_hole_in_samples) + " samples)";
  return text + "; closing them takes " + percent(r.cap_share) + " of the area, openness " + number(r.openness);
}

std::string orientation_text(const MeshReport& r) {
  const std::string done = list_of({{r.flipped, "flipped"}, {r.left_out, "left out"}}, "");
  std::string text = r.inconsistent_edges == 0 ? "consistent" : counted(r.inconsistent_edges, "inconsistent edge");
  if (!done.empty()) text += "; for the sign: " + done;
  if (r.unorientable > 0)
    text += "; " + grouped(r.unorientable) + (r.unorientable == 1 ? " patch has" : " patches have") + " but one side";
  return text;
}

std::string intersections_text(const MeshReport& r) {
  const std::string pairs = counted(r.intersecting_pairs, "pair") + " of triangles";
  if (r.intersections_known) return r.intersecting_pairs == 0 ? "none" : pairs;
  return r.intersecting_pairs == 0 ? "none found, not all were looked for" : "at least " + pairs;
}

std::string component_text(const MeshComponent& c) {
  std::string text = counted(c.triangles, "triangle") + ", area " + number(c.area);
  if (c.solid) text += ", volume " + number(c.volume);
  if (c.depth > 0) text += (c.volume < 0 ? ", cavity at depth " : ", at depth ") + std::to_string(c.depth);
  return text + (c.closed ? "" : ", open");
}

Json json_component(const MeshComponent& c) {
  return {{"triangles", c.triangles},
          {"first_triangle", json_triangle(c.first_triangle)},
          {"bounds", json_box(c.bounds)},
          {"area", c.area},
          {"volume", c.volume},
          {"centroid", json_point(c.centroid)},
          {"inertia", json_point({c.inertia[0], c.inertia[1], c.inertia[2]})},
          {"products", json_point({c.inertia[3], c.inertia[4], c.inertia[5]})},
          {"closed", c.closed},
          {"solid", c.solid},
          {"depth", c.depth}};
}

}  // namespace

std::string row(const char* name, const std::string& value) {
  std::string line = name;
  return line + std::string(14 - line.size(), ' ') + one_line(value) + "\n";
}

std::string report_text(const MeshReport& r, std::size_t vertices) {
  const auto vertex_count = static_cast<std::int64_t>(vertices);
  const std::string sign = r.method == SignMethod::none ? "none" : name_of(r.method);
  std::string text =
      row("triangles", grouped(r.triangles)) +
      row("vertices",
          grouped(vertex_count) + (vertex_count == r.positions ? "" : ", at " + counted(r.positions, "position"))) +
      row("from", point_text(r.bounds.min)) + row("to", point_text(r.bounds.max)) +
      row("extent", point_text(r.bounds.extent())) + row("area", number(r.area)) + row("volume", number(r.volume)) +
      row("closed", closed_text(r)) + row("orientation", orientation_text(r)) +
      row("defects",
          list_of(
              {{r.degenerate, "degenerate"}, {r.duplicate, "duplicate"}, {r.nonmanifold_edges, "nonmanifold edges"}},
              "none") +
              (r.two_sided ? "; two-sided" : "")) +
      row("intersections", intersections_text(r)) +
      row("parts", counted(r.component_count, "component") + ", " + grouped(r.patches) +
                       (r.patches == 1 ? " patch" : " patches") +
                       (r.nesting_known ? ", nested to depth " + std::to_string(r.deepest) : "") +
                       (r.closed() ? ", winding numbers " + std::to_string(r.least_winding) + " to " +
                                         std::to_string(r.most_winding)
                                   : ""));
  if (r.component_count > 1) {
    const std::size_t shown = std::min(r.components.size(), kShownComponents);
    for (std::size_t n = 0; n < shown; ++n) text += row("", component_text(r.components[n]));
    if (const auto more = r.component_count - static_cast<std::int64_t>(shown); more > 0)
      text += row("", "and " + grouped(more) + " more, by --json");
  }
  return text + row("sign", sign + (r.sure ? ": " : ", not certain: ") + r.why);
}

void add_report(Json& json, const MeshReport& r) {
  Json& mesh = json["mesh"];
  mesh["triangles"] = r.triangles;
  mesh["positions"] = r.positions;
  mesh["bounds"] = json_box(r.bounds);
  mesh["extent"] = json_point(r.bounds.extent());
  mesh["area"] = r.area;
  mesh["volume"] = r.volume;
  mesh["closed"] = r.closed();
  mesh["degenerate"] = r.degenerate;
  mesh["duplicate"] = r.duplicate;
  mesh["duplicate_same"] = r.duplicate_same;
  mesh["duplicate_opposite"] = r.duplicate_opposite;
  mesh["two_sided"] = r.two_sided;
  mesh["boundary_edges"] = r.open_edges;
  mesh["nonmanifold_edges"] = r.nonmanifold_edges;
  mesh["inconsistent_edges"] = r.inconsistent_edges;
  mesh["patches"] = r.patches;
  json["orientation"] = {{"flipped", r.flipped},
                         {"left_out", r.left_out},
                         {"cancelled_parts", r.cancelled_parts},
                         {"cancelled_share", r.cancelled_share},
                         {"inconsistent_edges", r.inconsistent_after},
                         {"unorientable", r.unorientable}};
  json["boundary"] = {
      {"edges", r.boundary_edges},
      {"loops", r.boundary_loops},
      {"length", r.boundary_length},
      {"largest_hole", r.largest_hole},
      {"largest_hole_in_samples", r.largest_hole_in_samples > 0 ? Json(r.largest_hole_in_samples) : Json(nullptr)},
      {"cap_share", r.cap_share},
      {"openness", r.openness}};
  json["nesting"] = {{"known", r.nesting_known},
                     {"deepest", r.deepest},
                     {"least_winding", r.closed() ? Json(r.least_winding) : Json(nullptr)},
                     {"most_winding", r.closed() ? Json(r.most_winding) : Json(nullptr)}};
  json["intersections"] = {{"pairs", r.intersecting_pairs}, {"complete", r.intersections_known}};
  json["sign"] = {{"method", name_of(r.method)}, {"sure", r.sure}, {"why", r.why}};
  json["component_count"] = r.component_count;
  json["components"] = Json::array();
  for (const MeshComponent& component : r.components) json["components"].push_back(json_component(component));
}

}  // namespace standoff::cli
