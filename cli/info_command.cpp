// SPDX-License-Identifier: Apache-2.0
// standoff info: what is in a mesh, field or body file.
#include <cmath>
#include <memory>

#include "cli/body_input.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/field_argument.h"
#include "cli/files.h"
#include "cli/signals.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "cli/usage.h"
#include "standoff/inspect.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

constexpr const char* kExamples = R"(  standoff info bunny.obj            triangles, bounds, whether it is closed
  standoff info bunny.vti            grid, thickness, values
  standoff info bunny.vti --json     the same for programs
)";

std::string row(const char* name, const std::string& value) {
  std::string line = name;
  return line + std::string(14 - line.size(), ' ') + one_line(value) + "\n";
}

// "12", or "12 (3 % of ...)" would be more than people ask; zero is said in a word.
std::string none_or(std::int64_t n) { return n == 0 ? "none" : grouped(n); }

void tell_mesh(const MeshInput& input, const Console& console) {
  MeshReadReport report;
  const Mesh mesh = with_spinner(console, "reading " + input.name(), [&] { return input.read(&report); });
  const MeshSummary found = inspect(mesh);
  const Box& box = found.bounds;
  if (console.json()) {
    Json json = json_answer("info");
    json["kind"] = "mesh";
    json["mesh"] = {{"file", input.name()},
                    {"triangles", mesh.triangles.size()},
                    {"vertices", mesh.vertices.size()},
                    {"bounds", json_box(box)},
                    {"extent", json_point(box.extent())},
                    {"area", found.area},
                    {"degenerate", found.degenerate},
                    {"duplicate", found.duplicate},
                    {"boundary_edges", found.boundary_edges},
                    {"nonmanifold_edges", found.nonmanifold_edges},
                    {"closed", found.closed()},
                    {"format", report.format.empty() ? Json(nullptr) : Json(report.format)},
                    {"unit_scale", report.unit_scale},
                    {"metres_per_unit", report.metres_per_unit > 0 ? Json(report.metres_per_unit) : Json(nullptr)},
                    {"axes", report.axes},
                    {"hash", hash_text(content_hash(mesh))}};
    return print(json);
  }
  const auto count = [](std::size_t n) { return grouped(static_cast<std::int64_t>(n)); };
  std::string read;
  for (const std::string& note : notes(report)) read += row("read", note);
  print(row("mesh", input.name()) + read + row("triangles", count(mesh.triangles.size())) +
        row("vertices", count(mesh.vertices.size())) + row("from", point_text(box.min)) +
        row("to", point_text(box.max)) + row("extent", point_text(box.extent())) + row("area", number(found.area)) +
        row("degenerate", none_or(found.degenerate)) + row("duplicate", none_or(found.duplicate)) +
        row("closed", found.closed() ? "yes"
                                     : "no: " + counted(found.boundary_edges, "boundary edge") + ", " +
                                           counted(found.nonmanifold_edges, "nonmanifold edge")) +
        row("hash", hash_text(content_hash(mesh))));
}

void tell_field(const std::string& name, const FieldArgument& input, const Console& console) {
  const DistanceField field = input.read(name, console);
  const Grid& g = field.grid();
  const FieldSummary found = inspect(field);
  const Provenance& from = field.provenance();
  const std::int64_t tiles = field.tile_count().count();
  if (console.json()) {
    Json json = json_answer("info");
    json["kind"] = "field";
    json["field"] = {{"file", name},
                     {"nearest_triangle", field.has_nearest()},
                     {"method", from.method},
                     {"sign", from.sign},
                     {"version", from.version}};
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

struct Command {
  MeshInput input;
  FieldArgument field;
  Console console;

  void run() const {
    if (kind_of(input.name()) == FileKind::field) return tell_field(input.name(), field, console);
    field.check_unused(input.name());
    if (kind_of(input.name()) == FileKind::body) return tell_body(input.name(), console);
    tell_mesh(input, console);
  }
};

}  // namespace

void add_info(CLI::App& program) {
  auto* verb = add_verb(program, "info", "say what is in a mesh, field or body", kExamples);
  const auto command = std::make_shared<Command>();
  command->input.add_any_to(*verb, true);
  command->field.add_to(*verb);
  command->console.add_to(*verb, Console::kJson | Console::kMessages);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
