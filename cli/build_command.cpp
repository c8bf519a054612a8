// SPDX-License-Identifier: Apache-2.0
// standoff build: a mesh made into a body, once, for many questions.
#include <filesystem>
#include <memory>

#include "cli/body_input.h"
#include "cli/commands.h"
#include "cli/console.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "cli/usage.h"

namespace standoff::cli {
namespace {

constexpr const char* kExamples =
    R"(  standoff build maze.stl                              maze.body, for collide, distance, sweep and fly
  standoff build maze.stl -o out/maze.body --unit mm   in metres, elsewhere
  standoff collide maze.body fly.stl --pose 3,1,2      nothing is built again
)";

struct Command {
  MeshInput input;
  FileOutput output;
  ModelOptions options;
  Console console;

  void run();
};

void Command::run() {
  if (!output.given()) output.set_path(input.stem() + ".body");
  check_input(input.name());
  output.check({{"body", "", true, true, false}});
  const Mesh mesh = with_spinner(console, "reading " + input.name(), [&] { return input.read(); });
  const std::string file = output.path().string();
  const CollisionModel body = with_spinner(console, "building " + file, [&] { return CollisionModel(mesh, options); });
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
  auto* verb = add_verb(program, "build", "make a body of a mesh, once for many questions", kExamples);
  const auto command = std::make_shared<Command>();
  ModelOptions& options = command->options;
  using S = const std::string&;
  command->input.add_to(*verb);
  command->input.add_scale_to(*verb);
  add_parsed(*verb, {"--spacing", "S", "of the body's field (default: chosen from the mesh)", "Body"},
             [&options](S o, S t) { options.spacing = parse_positive(o, t); });
  add_threads(*verb, "Body", options.execution.threads);
  command->output.add_to(*verb, "BODY", "the body: .body (default: the mesh's name with .body, here)");
  command->console.add_to(*verb, Console::kMessages | Console::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
