// SPDX-License-Identifier: Apache-2.0
// standoff info: what is in a mesh, field or body file.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/inspect.h"
#include "standoff/io.h"
#include "standoff/mesh_report.h"
#include "standoff/zarr.h"

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

// A line of an answer for people: a name and a value.
std::string row(const char* name, const std::string& value) {
  std::string line = name;
  return line + std::string(14 - line.size(), ' ') + one_line(value) + "\n";
}

// The report for people, one screen. `vertices` counts those of the file.
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

// Adds the report to an answer: the keys that docs/json.md lists.
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
  mesh["open_edges"] = r.open_edges;
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

constexpr const char* kInfoExamples =
    R"(  standoff info bunny.obj            what it is, what is wrong with it, which sign method fits
  standoff info bunny.vti            grid, thickness, values
  standoff info bunny.vti --json     the same for programs
)";

MeshReport examined(const MeshInput& input, const Mesh& mesh, MeshReportOptions options, const Console& console) {
  const auto start = std::chrono::steady_clock::now();
  options.progress = console.progress();
  MeshReport found = report(mesh, options);
  options.progress = nullptr;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  console.detail("examining " + input.name() + ": " + seconds_text(elapsed.count()));
  return found;
}

Json json_axis(std::optional<Axis> axis) { return axis ? Json(std::string(1, name_of(*axis))) : Json(nullptr); }

void tell_mesh(const MeshInput& input, const MeshReportOptions& options, const Console& console) {
  const auto [mesh, read] = with_spinner(console, "reading " + input.name(), [&] { return input.read_with_report(); });
  const MeshReport found = examined(input, mesh, options, console);
  if (console.json()) {
    Json json = json_answer("info");
    json["kind"] = "mesh";
    json["mesh"] = {{"file", input.name()},
                    {"vertices", mesh.vertices.size()},
                    {"format", read.format.empty() ? Json(nullptr) : Json(read.format)},
                    {"unit_scale", read.unit_scale},
                    {"metres_per_unit", read.metres_per_unit > 0 ? Json(read.metres_per_unit) : Json(nullptr)},
                    {"axes", read.axes},
                    {"up", json_axis(read.up)},
                    {"hash", hash_text(content_hash(mesh))}};
    add_report(json, found);
    return print(json);
  }
  std::string done;
  for (const std::string& note : notes(read)) done += row("read", note);
  print(row("mesh", input.name()) + done + report_text(found, mesh.vertices.size()) +
        row("hash", hash_text(content_hash(mesh))));
}

// What is known of a field before any of its samples: name, grid, thickness, provenance.
Json json_field(const std::string& name, bool nearest, const Provenance& from, const Grid& grid, double thickness) {
  Json json = json_answer("info");
  json["kind"] = "field";
  json["field"] = {{"file", name},      {"nearest", nearest},      {"sidecars", Json::array()}, {"method", from.method},
                   {"sign", from.sign}, {"version", from.version}, {"up", json_axis(from.up)}};
  json["mesh"] = {{"hash", from.mesh_hash == 0 ? Json(nullptr) : Json(hash_text(from.mesh_hash))}};
  json["grid"] = json_grid(grid);
  json["thickness"] = json_number(thickness);
  return json;
}

std::string grid_rows(const std::string& name, const Grid& g, double thickness) {
  return row("field", name) + row("size", size_text(g.size) + ", " + counted(g.sample_count(), "sample")) +
         row("origin", point_text(g.corner())) + row("to", point_text(g.bounds().max)) +
         row("spacing", spacing_text(g.spacing)) +
         row("thickness", std::isinf(thickness) ? "infinite: every sample is a distance" : number(thickness));
}

std::string provenance_rows(const Provenance& from, const char* without_sign) {
  const auto or_unknown = [](const std::string& text) {
    return text.empty() ? std::string("unknown") : beginning(text, 200);
  };
  return row("sign", from.sign.empty() ? without_sign : beginning(from.sign, 200)) +
         row("method", or_unknown(from.method) + ", standoff " + or_unknown(from.version)) +
         row("mesh hash", from.mesh_hash == 0 ? "unknown" : hash_text(from.mesh_hash)) +
         row("up", from.up ? std::string(1, name_of(*from.up)) : "unknown");
}

std::vector<Grid> levels_of(const ZarrStore& store) {
  std::vector<Grid> grids;
  for (int level = 0; level < store.levels(); ++level) grids.push_back(store.level(level).grid());
  return grids;
}

// "3: 64 x 64 x 64, 32 x 32 x 32, 16 x 16 x 16".
std::string levels_text(const ZarrStore& store) {
  std::string text = std::to_string(store.levels());
  const char* before = ": ";
  for (const Grid& level : levels_of(store)) {
    text += before + size_text(level.size);
    before = ", ";
  }
  return text;
}

// Of a store the metadata alone, which is read at once however large it is.
void tell_store(const std::string& name, const FieldArgument& input, const Console& console) {
  const ZarrStore store = input.open_store(name);
  const Size3 shard = store.shard(), chunk = store.chunk();
  if (console.json()) {
    Json json = json_field(name, store.has_nearest(), store.provenance(), store.grid(), store.thickness());
    json["store"] = {{"shard", json_size(shard)},
                     {"chunk", json_size(chunk)},
                     {"bytes", written_bytes(name)},
                     {"levels", Json::array()}};
    for (const Grid& level : levels_of(store))
      json["store"]["levels"].push_back({{"size", json_size(level.size)}, {"spacing", json_point(level.spacing)}});
    return print(json);
  }
  print(grid_rows(name, store.grid(), store.thickness()) +
        row("store", "Zarr 3, " + bytes_text(written_bytes(name)) + "; shards of " + size_text(shard) + ", chunks of " +
                         size_text(chunk)) +
        (store.levels() > 1 ? row("levels", levels_text(store)) : "") +
        row("nearest", store.has_nearest() ? "triangles stored" : "not stored") +
        provenance_rows(store.provenance(), "none, or method unknown"));
}

void tell_field(const std::string& name, const FieldArgument& input, const Console& console) {
  const FieldFile file = input.read_file(name, console);
  const DistanceField& field = file.field;
  const Grid& g = field.grid();
  const FieldSummary found = inspect(field);
  const std::int64_t tiles = field.tile_count().count();
  if (console.json()) {
    Json json = json_field(name, field.has_nearest(), field.provenance(), g, field.thickness());
    for (const Sidecar& sidecar : file.sidecars) json["field"]["sidecars"].push_back(sidecar.name);
    json["values"] = {{"min", json_number(found.min)}, {"max", json_number(found.max)}, {"nan", found.nan}};
    json["samples"] = {{"total", g.sample_count()}, {"band", found.band}};
    json["tiles"] = {{"total", tiles}, {"stored", field.stored_tiles()}};
    json["memory_bytes"] = field.memory_bytes();
    return print(json);
  }
  std::string sidecars;
  for (const Sidecar& sidecar : file.sidecars)
    sidecars += (sidecars.empty() ? "" : ", ") + beginning(sidecar.name, 100) +
                (sidecar.components > 1 ? " (" + std::to_string(sidecar.components) + " numbers)" : "");
  print(grid_rows(name, g, field.thickness()) +
        row("values", number(found.min) + " to " + number(found.max) +
                          (found.nan > 0 ? "; " + counted(found.nan, "sample") + " not a number" : "")) +
        row("band", counted(found.band, "sample") +
                        (field.has_nearest() || std::isinf(field.thickness()) ? "" : " nearer than the thickness")) +
        row("tiles", grouped(field.stored_tiles()) + " of " + grouped(tiles) + " stored, " +
                         bytes_text(field.memory_bytes()) + " in memory") +
        row("nearest", field.has_nearest() ? "triangles stored" : "not stored") +
        (sidecars.empty() ? "" : row("sidecars", sidecars)) +
        provenance_rows(field.provenance(), found.min < 0 ? "signed, method unknown" : "none"));
}

void tell_body(const std::string& name, const Console& console) {
  const Body body = with_spinner(console, "reading " + name, [&] { return Body::load(name); });
  if (console.json()) {
    Json json = json_answer("info");
    json["kind"] = "body";
    json["body"] = {{"file", name}};
    add_body(json, body);
    return print(json);
  }
  const auto count = [](std::size_t n) { return grouped(static_cast<std::int64_t>(n)); };
  const Box box = body.bounds();
  const Grid grid = body.grid();
  print(row("body", name) + row("triangles", count(body.mesh().triangles.size())) +
        row("vertices", count(body.mesh().vertices.size())) + row("from", point_text(box.min)) +
        row("to", point_text(box.max)) + row("closed", body.has_inside() ? "yes" : "no") +
        row("field", size_text(grid.size) + ", " + counted(grid.sample_count(), "sample")) +
        row("spacing", spacing_text(grid.spacing)) + row("thickness", number(body.thickness())) +
        row("memory", bytes_text(body.memory_bytes())));
}

struct InfoCommand {
  MeshInput input;
  FieldArgument field;
  MeshReportOptions options;
  Console console;

  void run() const {
    check_input(input.name());
    const bool is_mesh = kind_of(input.name()) != FileKind::field && kind_of(input.name()) != FileKind::body;
    if (!is_mesh && options.spacing > 0)
      throw Error(ErrorCode::usage, "--spacing: " + input.name() + " is no mesh; leave it out");
    if (is_store(input.name())) return tell_store(input.name(), field, console);
    if (kind_of(input.name()) == FileKind::field) return tell_field(input.name(), field, console);
    field.check_unused(input.name());
    if (kind_of(input.name()) == FileKind::body) return tell_body(input.name(), console);
    tell_mesh(input, options, console);
  }
};

}  // namespace

void add_info(CLI::App& program) {
  auto* verb = add_verb(program, "info", "say what is in a mesh, field or body", kInfoExamples);
  const auto command = std::make_shared<InfoCommand>();
  command->input.add_any_to(*verb, true);
  command->field.add_to(*verb);
  add_parsed(*verb, {"--spacing", "S", "distance between planned samples: says how large holes are in samples", "Mesh"},
             [options = &command->options](const std::string& option, const std::string& text) {
               options->spacing = parse_positive(option, text);
             });
  command->console.add_to(*verb, Console::kJson | Console::kMessages | Console::kProgress);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
