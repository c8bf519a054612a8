// SPDX-License-Identifier: Apache-2.0
// standoff generate: a mesh made by code, into a file.
#include <algorithm>
#include <memory>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "scenes/scenes.h"
#include "standoff/error.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

constexpr const char* kGenerateExamples = R"(  standoff generate --list                             what there is
  standoff generate factory -o factory.ply             2,889,536 triangles
  standoff generate sphere --triangles 5000 -o s.stl   about as many as asked for
)";

struct GenerateCommand {
  std::string scene;
  bool list = false;
  std::int64_t triangles = 0;
  FileOutput output;
  Console console;

  void run();
  void print_list() const;
};

void GenerateCommand::print_list() const {
  if (console.json()) {
    Json described = Json::array();
    for (const auto& known : scenes::all())
      described.push_back({{"name", known.name}, {"triangles", known.triangles}, {"description", known.description}});
    Json json = json_answer("generate");
    json["scenes"] = described;
    return print(json);
  }
  constexpr std::size_t kNameWidth = 18, kCountWidth = 10;
  const auto blanks = [](std::size_t width, const std::string& beside) {
    return std::string(width > beside.size() ? width - beside.size() : 1, ' ');
  };
  std::string text;
  for (const auto& known : scenes::all()) {
    const std::string count = grouped(known.triangles);
    text += known.name + blanks(kNameWidth, known.name) + blanks(kCountWidth, count) + count + "  " +
            known.description + "\n";
  }
  print(text);
}

void GenerateCommand::run() {
  if (list) return print_list();
  if (scene.empty()) throw Error(ErrorCode::usage, "generate: no SCENE given; see standoff generate --list");
  const SceneName named = parse_scene(scene);
  if (named.triangles != 0 && triangles != 0)
    throw Error(ErrorCode::usage, "--triangles: " + scene + " names a number already; give one of them");
  check_input("scene:" + named.name);
  if (!output.given()) output.set_path(named.name + ".ply");
  output.check(mesh_formats());
  const Mesh mesh = with_spinner(console, "making " + named.name,
                                 [&] { return scenes::make(named.name, std::max(triangles, named.triangles)); });
  with_spinner(console, "writing " + output.path().string(),
               [&] { write_mesh(output.path(), mesh, {.existing = output.existing(), .up = Axis::y}); });
  console.say(mesh_line(output.path().string(), mesh));
  if (!console.json()) return;
  Json json = json_answer("generate");
  json["scene"] = named.name;
  json["mesh"] = {{"triangles", mesh.triangles.size()}, {"vertices", mesh.vertices.size()}};
  json["output"] = json_output(output.path());
  print(json, output.path());
}

}  // namespace

void add_generate(CLI::App& program) {
  auto* verb = add_verb(program, "generate", "make a mesh by code: machines, terrain, a labyrinth, nasty cases",
                        kGenerateExamples);
  const auto command = std::make_shared<GenerateCommand>();
  auto* scene =
      verb->add_option("SCENE", command->scene, "the name of a scene, see --list; scene:NAME[:TRIANGLES] too");
  auto* list = verb->add_flag("--list", command->list, "list the scenes")->excludes(scene)->group("Scene");
  add_parsed(*verb, {"--triangles", "N", "about so many triangles (default: the scene's own)", "Scene"},
             [command = command.get()](const std::string& option, const std::string& text) {
               command->triangles = parse_count(option, text, 1, scenes::kMostTriangles);
             })
      ->excludes(list);
  command->output.add_to(
      *verb, "MESH", "the mesh: " + extensions(mesh_formats(), true) + "\n(default: the scene's name with .ply, here)");
  command->console.add_to(*verb, Console::kMessages | Console::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
