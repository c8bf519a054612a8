// SPDX-License-Identifier: Apache-2.0
// standoff convert: mesh to mesh, field to field.
#include <memory>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

constexpr const char* kConvertExamples = R"(  standoff convert horse.3ds -o horse.stl              a mesh
  standoff convert part.stl -o part.ply --unit mm      a mesh, in metres
  standoff convert bunny.vti -o bunny.npz              a field
  standoff convert bunny.vti -o bunny.vdb              a field, for Blender and Houdini
)";

struct ConvertCommand {
  MeshInput input;
  FieldArgument field_argument;
  FileOutput output;
  Console console;
  bool uncompressed = false;
  int levels = 1;  // of a store

  void report(const char* kind, const char* key, const Json& what) const;
  void run();

 private:
  void write_slices(const FieldSlices& slices, const FieldWriteOptions& options) const;
};

void ConvertCommand::report(const char* kind, const char* key, const Json& what) const {
  if (!console.json()) return;
  Json json = json_answer("convert");
  json["kind"] = kind;
  json[key] = what;
  json["output"] = json_output(output.path());
  print(json, output.path());
}

// Slab by slab where that is possible, else as a whole.
void ConvertCommand::write_slices(const FieldSlices& slices, const FieldWriteOptions& options) const {
  const FieldReadOptions reading = field_argument.reading();
  if (output.format(field_formats()).slabs && !slices.has_nearest() && slices.sidecars().empty())
    return write_field(output.path(), *slices.slabs(reading, field_argument.slice_samples()), options);
  write_field(output.path(), slices.read(0, slices.grid().size.z, reading), options);
}

void ConvertCommand::run() {
  const bool is_field = kind_of(input.name()) == FileKind::field;
  const bool to_field = kind_of(output.path()) == FileKind::field;
  if (is_field && !to_field)
    throw Error(ErrorCode::usage,
                output.path().string() + ": a field can only become a field; use " + extensions(field_formats(), true));
  if (!is_field && to_field)
    throw Error(ErrorCode::usage,
                output.path().string() + ": convert does not make a field of a mesh; use standoff compute");
  if (is_field && input.scaled())
    throw Error(ErrorCode::usage, "--scale and --unit are for meshes; compute " + input.name() + " again with them");
  if (kind_of(output.path()) == FileKind::body)
    throw Error(ErrorCode::usage,
                output.path().string() + ": convert does not make a body of a mesh; use standoff build");
  check_input(input.name());
  output.check(is_field ? field_formats() : mesh_formats());
  output.check_levels(levels);
  const std::string writing = "writing " + output.path().string();
  if (is_field) {
    const auto [slices, read] = field_argument.read_parts(input.name(), console);
    const Grid& grid = slices ? slices->grid() : read.field.grid();
    const FieldWriteOptions options{
        .existing = output.existing(), .compress = !uncompressed, .sidecars = read.sidecars, .levels = levels};
    with_spinner(console, writing,
                 [&] { slices ? write_slices(*slices, options) : write_field(output.path(), read.field, options); });
    console.say(output.path().string() + ": " + size_text(grid.size) + " samples");
    return report("field", "grid", json_grid(grid));
  }
  field_argument.check_unused(input.name());
  if (uncompressed)
    throw Error(ErrorCode::usage, "--uncompressed: it is for fields, and " + input.name() + " is none; leave it out");
  const auto [mesh, read] = with_spinner(console, "reading " + input.name(), [&] { return input.read_with_report(); });
  validate(mesh);
  const MeshWriteOptions options = input.write_options(read, output.existing());
  with_spinner(console, writing, [&] { write_mesh(output.path(), mesh, options); });
  console.say(mesh_line(output.path().string(), mesh));
  say_taken_unit(console, output.path(), options);
  report("mesh", "mesh", {{"triangles", mesh.triangles.size()}, {"vertices", mesh.vertices.size()}});
}

}  // namespace

void add_convert(CLI::App& program) {
  auto* verb = add_verb(program, "convert", "turn a mesh or field into another format", kConvertExamples);
  const auto command = std::make_shared<ConvertCommand>();
  command->input.add_any_to(*verb, false);
  command->input.add_scale_to(*verb);
  command->output.add_to(*verb, "FILE",
                         "the new file: " + extensions(mesh_formats(), true) + " for a mesh,\n" +
                             extensions(field_formats(), true) + " for a field");
  verb->get_option("--output")->required();
  command->field_argument.add_to(*verb);
  add_uncompressed(*verb, command->uncompressed);
  add_levels(*verb, command->levels);
  command->console.add_to(*verb, Console::kMessages | Console::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
