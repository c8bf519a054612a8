// SPDX-License-Identifier: Apache-2.0
// standoff crossings: Hermite data of a mesh on a grid, into a file.
#include <algorithm>
#include <memory>

#include "cli/commands.h"
#include "cli/compute_report.h"
#include "cli/console.h"
#include "cli/files.h"
#include "cli/grid_options.h"
#include "cli/memory.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/sign_options.h"
#include "cli/signals.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "cli/usage.h"
#include "standoff/error.h"
#include "standoff/hermite.h"
#include "standoff/io.h"

namespace standoff::cli {
namespace {

constexpr const char* kCrossingsExamples =
    R"(  standoff crossings bunny.obj                         into bunny.npz, 256 samples on the longest side
  standoff crossings part.stl -o hermite.npz --sign auto   normals outwards, copies and inner walls left out
  standoff crossings part.stl -o table.csv -r 50       a line for each crossing
)";

const std::vector<FileFormat>& crossing_formats() {
  static const std::vector<FileFormat> all{{"npz", "NumPy arrays", false, true}, {"csv", "a table", false, true}};
  return all;
}

struct CrossingsCommand {
  MeshInput mesh;
  FileOutput output;
  GridOptions grid;
  EdgeCrossingOptions options;
  Console console;

  void add_to(CLI::App& verb);
  void run();
  void tell(const Mesh& loaded, const GridChoice& choice, const std::vector<EdgeCrossing>& crossings) const;
};

void CrossingsCommand::add_to(CLI::App& verb) {
  mesh.add_to(verb);
  output.add_to(verb, "FILE", "the crossings: .npz or .csv (default: the mesh's name with .npz, here)");
  grid.add_without_thickness_to(verb);
  mesh.add_scale_to(verb);
  add_sign_to(verb, {"none", "auto", "winding", "parity", "normal", "flood"},
              "orient the triangles, and leave copies and inner walls out, as\ncompute does for this sign: auto, "
              "winding or normal; parity and\nflood take all as they are, as none does (default)",
              options.sign);
  verb.add_flag("--outer", options.sign.outer, "leave out triangles inside (sign winding or auto, closed meshes)")
      ->group("Sign");
  add_threads(verb, "Work", options.execution.threads);
  add_parsed(verb,
             {"--memory-limit", "SIZE",
              "most memory for the crossings, as in 500M or 8G\n(default: 80 % of the machine's)", "Work"},
             [this](const std::string& o, const std::string& t) { options.memory_limit = parse_bytes(o, t); });
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
}

void CrossingsCommand::run() {
  if (!output.given()) output.set_path(mesh.stem() + ".npz");
  check_input(mesh.name());
  output.check(crossing_formats());
  output.check_differs(mesh.name());
  if (options.memory_limit == 0) options.memory_limit = default_memory_limit();
  const Mesh loaded = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read(); });
  validate(loaded);
  const GridChoice choice = grid.choose(bounds(loaded));
  console.say(mesh_line(mesh.name(), loaded));
  const std::vector<EdgeCrossing> crossings = [&] {
    const Cancellable cancellable;
    options.progress = console.progress();
    return edge_crossings(loaded, choice.grid, options);
  }();
  options.progress = nullptr;  // and the bar with it
  if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
  with_spinner(console, "writing " + output.path().string(),
               [&] { write_crossings(output.path(), crossings, choice.grid, output.existing()); });
  tell(loaded, choice, crossings);
}

void CrossingsCommand::tell(const Mesh& loaded, const GridChoice& choice,
                            const std::vector<EdgeCrossing>& crossings) const {
  const auto count = std::ssize(crossings);
  console.say(output.path().string() + ": " + counted(count, "crossing") + " of the edges of " +
              std::to_string(choice.grid.size.x) + " x " + std::to_string(choice.grid.size.y) + " x " +
              std::to_string(choice.grid.size.z) + " samples");
  if (!console.json()) return;
  Json json = json_answer("crossings");
  json["mesh"] = {{"file", mesh.name()}, {"triangles", loaded.triangles.size()}};
  json["grid"] = json_grid(choice.grid);
  json["crossings"] = count;
  json["entering"] = std::ranges::count(crossings, true, &EdgeCrossing::enters);
  json["output"] = json_output(output.path());
  print(json, output.path());
}

}  // namespace

void add_crossings(CLI::App& program) {
  auto* verb =
      add_verb(program, "crossings", "find where the edges of a grid cross a mesh (Hermite data)", kCrossingsExamples);
  const auto command = std::make_shared<CrossingsCommand>();
  command->add_to(*verb);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
