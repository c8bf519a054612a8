// SPDX-License-Identifier: Apache-2.0
// standoff surface: a field or mesh into a watertight surface.
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/json.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/surface.h"

namespace standoff::cli {
namespace {

/// What the surface was made of.
struct SurfaceSubject {
  const char* kind = "mesh";  ///< or "field"
  Grid grid;
};

void say(const SurfaceResult& found, const std::string& output, const Console& console) {
  const SurfaceReport& report = found.report;
  say_sign(console, report.sign);
  console.say(mesh_line(output, found.mesh) + (report.floats ? "" : ", 64-bit coordinates"));
  if (report.examined) {
    console.say(counted(report.components, "component") + ", " + (report.intersections_known ? "" : "at least ") +
                counted(report.self_intersections, "self-intersection"));
  }
  if (report.capped > 0)
    console.warn("the solid reaches the border of the grid and was cut off there; take a larger grid");
  if (report.clamped > 0)
    console.warn(counted(report.clamped, "edge") +
                 " of the grid that the surface crosses: values there are clamped to the field's thickness, so that "
                 "vertices are not accurate; compute the field with a larger thickness");
  if (!report.lost.empty()) console.warn(report.lost);
  console.detail(counted(report.ambiguous_faces, "ambiguous face") + "; vertices keep " + number(report.clearance) +
                 " spacings from samples");
}

Json surface_json(const std::string& input, const SurfaceSubject& subject, const SurfaceOptions& options,
                  const SurfaceResult& found, const std::filesystem::path& output) {
  const SurfaceReport& report = found.report;
  Json json = json_answer("surface");
  json["kind"] = subject.kind;
  json["input"] = {{"file", input}};
  json["grid"] = json_grid(subject.grid);
  json["at"] = options.at;
  json["wall"] = options.wall;
  json["method"] = options.method == SurfaceMethod::dual ? "dual" : "marching-cubes";
  json["surface"] = {
      {"triangles", report.triangles}, {"vertices", report.vertices}, {"ambiguous_faces", report.ambiguous_faces},
      {"clamped", report.clamped},     {"capped", report.capped},     {"floats", report.floats},
      {"clearance", report.clearance}};
  if (report.examined) {
    json["surface"]["components"] = report.components;
    json["surface"]["self_intersections"] = report.self_intersections;
    json["surface"]["intersections_known"] = report.intersections_known;
  }
  if (std::string(subject.kind) == "mesh")
    json["lost"] = {{"share", report.lost_share},
                    {"parts", report.parts},
                    {"lost_parts", report.lost_parts},
                    {"thickness", report.lost_thickness},
                    {"what", report.lost}};
  if (std::string(subject.kind) == "mesh")
    json["sign"] = {{"method", name_of(report.sign.method)}, {"why", report.sign.why}, {"sure", report.sign.sure}};
  json["output"] = json_output(output);
  return json;
}

constexpr const char* kSurfaceExamples =
    R"(  standoff surface damaged.obj -o solid.ply                   a watertight solid out of any mesh
  standoff surface part.stl --method dual -r 400 -o part.ply  keeps sharp edges
  standoff surface part.stl --at 0.5 -o larger.stl            everything within 0.5 of the part; -0.5: smaller
  standoff surface part.stl --wall 2 -o hollow.stl            a hollow part with walls of 2
  standoff surface field.vti --at 3s -o offset.ply            of a field: where its value is 3 samples
)";

struct SurfaceCommand {
  MeshInput input;
  FieldArgument field_argument;
  FileOutput output;
  GridOptions grid;
  Thickness shell{0};
  SurfaceOptions options;
  Thickness at{0}, wall{0};
  bool coordinates_given = false, sign_given = false;
  Console console;

  void add_to(CLI::App& verb);
  void run();

 private:
  SurfaceResult of_field();
  SurfaceResult of_slices(const FieldSlices& slices);
  SurfaceResult of_mesh();
  void expect_surface(const SurfaceResult& found, const std::string& what_to_do) const;
  void set_levels(double spacing);
  SurfaceSubject subject;
  MeshReadReport read;  // of the mesh; of a field the axis that points up alone
};

// "0.5", "-0.5" or "-2s".
Thickness parse_level(const std::string& option, const std::string& text) {
  const bool in_samples = text.ends_with('s');
  return {parse_number(option, in_samples ? text.substr(0, text.size() - 1) : text), in_samples};
}

void SurfaceCommand::add_to(CLI::App& verb) {
  input.add_any_to(verb, false);
  output.add_to(verb, "MESH", "the surface: " + extensions(mesh_formats(), true));
  verb.get_option("--output")->required();
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set,
                           const char* group = "Surface") {
    add_parsed(verb, {name, value, help, group}, set);
  };
  add("--at", "D",
      "the value on the surface (default 0): world units (0.5) or\nsamples (2s); negative: inside the solid",
      [this](S o, S t) { at = parse_level(o, t); });
  add("--wall", "T", "make the solid hollow, with walls of this thickness:\nworld units (2) or samples (3s)",
      [this](S o, S t) {
        wall = parse_thickness(o, t);
        if (wall.infinite()) throw Error(ErrorCode::usage, o + " '" + t + "': give a finite thickness");
      });
  add("--method", "NAME",
      "marching-cubes (default); dual: dual contouring, which\nkeeps the sharp edges and corners of meshes",
      [this](S o, S t) {
        options.method =
            parse_choice(o, t, {"marching-cubes", "dual"}) == 0 ? SurfaceMethod::marching_cubes : SurfaceMethod::dual;
      });
  add("--coordinates", "NAME",
      "auto: 32-bit floats where they move no vertex noticeably\n(default); single: always; full: never",
      [this](S o, S t) {
        options.coordinates = static_cast<Coordinates>(parse_choice(o, t, {"auto", "single", "full"}));
        coordinates_given = true;
      });
  verb.add_flag("--check", options.examine, "also count components and self-intersections of the surface")
      ->group("Surface");
  grid.add_without_thickness_to(verb);
  input.add_scale_to(verb);
  add_sign(verb, options.sign, shell,
           {"how inside is decided, as in standoff compute: " + sign_names(takes_all, options.sign.method),
            "take the surface of the union of all parts (docs/outer.md)"});
  add_threads(verb, "Work", options.execution.threads);
  field_argument.add_to(verb, "field, surface and their making");
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
}

void SurfaceCommand::set_levels(double spacing) {
  options.at = at.world(spacing);
  options.wall = wall.world(spacing);
}

SurfaceResult SurfaceCommand::of_field() {
  if (input.scaled() || sign_given || grid.given())
    throw Error(ErrorCode::usage, input.name() + " is a field: options of the mesh, its grid and its sign belong to " +
                                      "standoff compute; leave them out");
  const auto [slices, file] = field_argument.read_parts(input.name(), console);
  if (slices) return of_slices(*slices);
  const DistanceField& field = file.field;
  subject = {"field", field.grid()};
  read.up = field.provenance().up.value_or(Axis::z);
  set_levels(field.grid().max_spacing());
  return with_progress(console, options.progress, [&] { return surface(field, options); });
}

// Reads no more than some slices at a time, if it can.
SurfaceResult SurfaceCommand::of_slices(const FieldSlices& slices) {
  const Grid& g = slices.grid();
  subject = {"field", g};
  read.up = slices.provenance().up.value_or(Axis::z);
  set_levels(g.max_spacing());
  const FieldReadOptions reading = field_argument.reading();
  return with_progress(console, options.progress, [&] {
    if (options.wall > 0 || options.method == SurfaceMethod::dual)
      return surface(slices.read(0, g.size.z, reading), options);
    return surface(g, slices.thickness(), slices.reader(reading), options, field_argument.slice_samples());
  });
}

SurfaceResult SurfaceCommand::of_mesh() {
  MeshReadResult loaded = with_spinner(console, "reading " + input.name(), [&] { return input.read_with_report(); });
  const Mesh mesh = std::move(loaded.mesh);
  read = std::move(loaded.report);
  validate(mesh);
  Box box = bounds(mesh);
  if (const double far = std::max(max_norm(box.min), max_norm(box.max)); far > kMaxCoordinate)
    throw Error(ErrorCode::input, input.name() + ": a coordinate of " + number(far) +
                                      ", too far out for a grid; repair the mesh, or scale it down with --scale");
  // The grid is one around the surface, which reaches beyond the mesh.
  const bool in_samples = at.in_samples || wall.in_samples || shell.in_samples;
  double spacing = in_samples ? grid.choose(box).grid.max_spacing() : 1;
  const double reach = std::max(0.0, at.world(spacing)) + shell.world(spacing) / 2;
  if (reach > 0) box = box.grown(reach);
  subject = {"mesh", grid.choose(box).grid};
  spacing = subject.grid.max_spacing();
  set_levels(spacing);
  options.sign.shell = shell.world(spacing);
  console.say(mesh_line(input.name(), mesh));
  return naming_mesh(input.name(), "surface", [&] {
    return with_progress(console, options.progress, [&] { return surface(mesh, subject.grid, options); });
  });
}

void SurfaceCommand::run() {
  const bool is_field = kind_of(input.name()) == FileKind::field;
  if (kind_of(input.name()) == FileKind::body)
    throw Error(ErrorCode::input, input.name() + ": this is a body; give the mesh it was built from");
  check_input(input.name());
  output.check(mesh_formats());
  output.check_differs(input.name());
  options.memory_limit = field_argument.memory_limit();
  // These have no other numbers; where they do not suffice, the error comes before the file.
  if (!coordinates_given && (output.path().extension() == ".stl" || output.path().extension() == ".glb"))
    options.coordinates = Coordinates::single;
  const SurfaceResult found = is_field ? of_field() : of_mesh();
  if (found.mesh.triangles.empty())
    throw Error(ErrorCode::input,
                input.name() + ": there is no surface at " + number(options.at) +
                    (is_field ? std::string(": no value of the field is less; take one that standoff info shows")
                              : ": no sample of the grid is inside, by the sign " +
                                    std::string(name_of(found.report.sign.method)) +
                                    "; take more samples (-r), another --sign, or a larger --at"));
  const MeshWriteOptions writing = input.write_options(read, output.existing());
  with_spinner(console, "writing " + output.path().string(), [&] { write_mesh(output.path(), found.mesh, writing); });
  say(found, output.path().string(), console);
  say_taken_unit(console, output.path(), writing);
  if (console.json()) print(surface_json(input.name(), subject, options, found, output.path()), output.path());
}

}  // namespace

void add_surface(CLI::App& program) {
  auto* verb =
      add_verb(program, "surface", "turn a field or mesh into a watertight surface, at any offset", kSurfaceExamples);
  const auto command = std::make_shared<SurfaceCommand>();
  command->add_to(*verb);
  verb->callback([command, verb] {
    command->sign_given = is_sign_given(*verb);
    command->run();
  });
}

}  // namespace standoff::cli
