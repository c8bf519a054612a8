// SPDX-License-Identifier: Apache-2.0
// standoff info: what is in a mesh, field or body file.
#include <chrono>
#include <cmath>
#include <memory>

#include "cli/body_input.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/field_argument.h"
#include "cli/files.h"
#include "cli/mesh_report.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/signals.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "cli/usage.h"
#include "standoff/inspect.h"
#include "standoff/io.h"
#include "standoff/mesh_report.h"

namespace standoff::cli {
namespace {

constexpr const char* kInfoExamples =
    R"(  standoff info bunny.obj            what it is, what is wrong with it, which sign method fits
  standoff info bunny.vti            grid, thickness, values
  standoff info bunny.vti --json     the same for programs
)";

MeshReport examined(const MeshInput& input, const Mesh& mesh, MeshReportOptions options, const Console& console) {
  const auto start = std::chrono::steady_clock::now();
  options.progress = console.progress();  // with the bar, until this returns
  MeshReport found = report(mesh, options);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  console.detail("examining " + input.name() + ": " + seconds_text(elapsed.count()));
  return found;
}

void tell_mesh(const MeshInput& input, const MeshReportOptions& options, const Console& console) {
  MeshReadReport read;
  const Mesh mesh = with_spinner(console, "reading " + input.name(), [&] { return input.read(&read); });
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
                    {"hash", hash_text(content_hash(mesh))}};
    add_report(json, found);
    return print(json);
  }
  std::string done;
  for (const std::string& note : notes(read)) done += row("read", note);
  print(row("mesh", input.name()) + done + report_text(found, mesh.vertices.size()) +
        row("hash", hash_text(content_hash(mesh))));
}

void tell_field(const std::string& name, const FieldArgument& input, const Console& console) {
  const FieldFile file = input.read_file(name, console);
  const DistanceField& field = file.field;
  const Grid& g = field.grid();
  const FieldSummary found = inspect(field);
  const Provenance& from = field.provenance();
  const std::int64_t tiles = field.tile_count().count();
  if (console.json()) {
    Json json = json_answer("info");
    json["kind"] = "field";
    json["field"] = {{"file", name},
                     {"nearest_triangle", field.has_nearest()},
                     {"sidecars", Json::array()},
                     {"method", from.method},
                     {"sign", from.sign},
                     {"version", from.version}};
    for (const Sidecar& sidecar : file.sidecars) json["field"]["sidecars"].push_back(sidecar.name);
    json["mesh"] = {{"hash", from.mesh_hash == 0 ? Json(nullptr) : Json(hash_text(from.mesh_hash))}};
    json["grid"] = json_grid(g);
    json["thickness"] = json_number(field.thickness());
    json["values"] = {{"min", json_number(found.min)}, {"max", json_number(found.max)}, {"nan", found.nan}};
    json["samples"] = {{"total", g.sample_count()}, {"band", found.band}};
    json["tiles"] = {{"total", tiles}, {"stored", field.stored_tiles()}};
    json["memory_bytes"] = field.memory_bytes();
    return print(json);
  }
  const auto or_unknown = [](const std::string& text) {
    return text.empty() ? std::string("unknown") : beginning(text, 200);
  };
  const std::string made = or_unknown(from.method) + ", standoff " + or_unknown(from.version);
  std::string sidecars;
  for (const Sidecar& sidecar : file.sidecars)
    sidecars += (sidecars.empty() ? "" : ", ") + beginning(sidecar.name, 100) +
                (sidecar.components > 1 ? " (" + std::to_string(sidecar.components) + " numbers)" : "");
  print(
      row("field", name) + row("size", size_text(g.size) + ", " + counted(g.sample_count(), "sample")) +
      row("origin", point_text(g.origin)) + row("to", point_text(g.bounds().max)) +
      row("spacing", spacing_text(g.spacing)) +
      row("thickness",
          std::isinf(field.thickness()) ? "infinite: every sample is a distance" : number(field.thickness())) +
      row("values", number(found.min) + " to " + number(found.max) +
                        (found.nan > 0 ? "; " + counted(found.nan, "sample") + " not a number" : "")) +
      row("band", counted(found.band, "sample") +
                      (field.has_nearest() || std::isinf(field.thickness()) ? "" : " nearer than the thickness")) +
      row("tiles", grouped(field.stored_tiles()) + " of " + grouped(tiles) + " stored, " +
                       bytes_text(field.memory_bytes()) + " in memory") +
      row("nearest", field.has_nearest() ? "triangles stored" : "not stored") +
      (sidecars.empty() ? "" : row("sidecars", sidecars)) +
      row("sign", from.sign.empty() ? (found.min < 0 ? "signed, method unknown" : "none") : beginning(from.sign, 200)) +
      row("method", made) + row("mesh hash", from.mesh_hash == 0 ? "unknown" : hash_text(from.mesh_hash)));
}

void tell_body(const std::string& name, const Console& console) {
  const CollisionModel body = with_spinner(console, "reading " + name, [&] { return CollisionModel::load(name); });
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
        row("to", point_text(box.max)) + row("closed", body.closed() ? "yes" : "no") +
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
    const bool is_mesh = kind_of(input.name()) != FileKind::field && kind_of(input.name()) != FileKind::body;
    if (!is_mesh && options.spacing > 0)
      throw Error(ErrorCode::usage, "--spacing: " + input.name() + " is no mesh; leave it out");
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
