// SPDX-License-Identifier: Apache-2.0
// standoff build: a mesh made into a body or a query, once, for many questions.
#include <filesystem>
#include <memory>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/error.h"
#include "standoff/points.h"

namespace standoff::cli {
namespace {

constexpr const char* kBuildExamples =
    R"(  standoff build maze.stl                              maze.body, for collide, distance, sweep and fly
  standoff build maze.stl -o out/maze.body --unit mm   in metres, elsewhere
  standoff collide maze.body fly.stl --pose 3,1,2      nothing is built again
  standoff build maze.stl -o maze.query                for standoff points
)";

struct BuildCommand {
  MeshInput input;
  FileOutput output;
  BodyOptions options;
  SignOptions sign;  // of a query
  Thickness shell{0};
  bool spacing_given = false, sign_given = false;
  Console console;

  void run();

 private:
  void check();
  void build_query(const Mesh& mesh);
};

void BuildCommand::check() {
  output.check({{"body", "", true, true, false}, {"query", "", true, true, false}});
  const bool query = kind_of(output.path()) == FileKind::query;
  if (query && spacing_given)
    throw Error(ErrorCode::usage, "--spacing is for bodies; a query has no field, leave it out");
  if (!query && sign_given) throw Error(ErrorCode::usage, "--sign is for queries; give -o NAME.query, or leave it out");
  if (shell.in_samples)
    throw Error(ErrorCode::usage, "--sign shell: a query has no samples; give its thickness in world units");
  sign.shell = shell.value;
}

void BuildCommand::build_query(const Mesh& mesh) {
  const std::string file = output.path().string();
  const MeshQuery query = naming_mesh(input.name(), "build", [&] {
    return with_spinner(console, "building " + file,
                        [&] { return MeshQuery(mesh, {.sign = sign, .execution = options.execution}); });
  });
  with_spinner(console, "writing " + file, [&] { query.save(output.path(), output.existing()); });
  const SignReport& report = query.sign();
  say_sign(console, report);
  console.say(mesh_line(file, mesh) + ", " +
              (report.method == SignMethod::none ? "no sign" : "sign " + std::string(name_of(report.method))) + ", " +
              bytes_text(query.memory_bytes()) + " in memory");
  if (!console.json()) return;
  Json json = json_answer("build");
  json["mesh"] = {
      {"triangles", mesh.triangles.size()}, {"vertices", mesh.vertices.size()}, {"bounds", json_box(bounds(mesh))}};
  json["memory_bytes"] = query.memory_bytes();
  if (report.method != SignMethod::none) add_sign_report(json, report);
  json["output"] = json_output(output.path());
  print(json, output.path());
}

void BuildCommand::run() {
  if (!output.given()) output.set_path(input.stem() + ".body");
  check_input(input.name());
  check();
  const Mesh mesh = with_spinner(console, "reading " + input.name(), [&] { return input.read(); });
  if (kind_of(output.path()) == FileKind::query) return build_query(mesh);
  const std::string file = output.path().string();
  const Body body = with_spinner(console, "building " + file, [&] { return Body(mesh, options); });
  with_spinner(console, "writing " + file, [&] { body.save(output.path(), output.existing()); });
  console.say(mesh_line(file, mesh) + ", field of " + size_text(body.grid().size) + " samples, " +
              bytes_text(body.memory_bytes()) + " in memory");
  if (!console.json()) return;
  Json json = json_answer("build");
  add_body(json, body);
  json["output"] = json_output(output.path());
  print(json, output.path());
}

}  // namespace

void add_build(CLI::App& program) {
  auto* verb = add_verb(program, "build", "make a body or a query of a mesh, once for many questions", kBuildExamples);
  const auto command = std::make_shared<BuildCommand>();
  BodyOptions& options = command->options;
  command->input.add_to(*verb);
  command->input.add_scale_to(*verb);
  add_parsed(*verb, {"--spacing", "S", "of the body's field (default: chosen from the mesh)", "Body"},
             [command](S o, S t) {
               command->options.spacing = parse_positive(o, t);
               command->spacing_given = true;
             });
  add_threads(*verb, "Body", options.execution.threads);
  command->output.add_to(*verb, "FILE",
                         "a body, .body, or a query for standoff points, .query\n(default: the mesh's name with .body, "
                         "here)");
  add_sign(*verb, command->sign, command->shell);
  command->console.add_to(*verb, Console::kMessages | Console::kJson);
  verb->callback([command, verb] {
    command->sign_given = is_sign_given(*verb);
    command->run();
  });
}

}  // namespace standoff::cli
