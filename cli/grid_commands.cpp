// SPDX-License-Identifier: Apache-2.0
// standoff crossings: Hermite data of a mesh on a grid, into a file. standoff voxels: surface and solid voxels of a
// mesh, into a file.
#include <algorithm>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/crossings.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/voxels.h"

namespace standoff::cli {
namespace {

constexpr const char* kCrossingsExamples =
    R"(  standoff crossings bunny.obj                         into bunny.npz, 256 samples on the longest side
  standoff crossings part.stl -o hermite.npz --sign none   all triangles, as they are oriented
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
  const auto oriented = [](const SignMethodInfo& info) { return info.by_orientation; };
  const auto as_they_are = [](const SignMethodInfo& info) { return takes_no_shell(info) && !info.by_orientation; };
  add_sign_to(verb, takes_no_shell,
              "orient the triangles, and leave copies and inner walls out, as compute does for this sign: " +
                  sign_names(oriented, options.sign.method) +
                  "; take all as they are: " + sign_names(as_they_are, options.sign.method),
              options.sign);
  verb.add_flag("--outer", options.sign.outer, "leave out triangles inside (sign winding or auto, closed meshes)")
      ->group("Sign");
  add_threads(verb, "Work", options.execution.threads);
  add_parsed(verb,
             {"--memory-limit", "SIZE",
              "most memory for the crossings, as in 500M or 8G, or none\n(default: 80 % of the machine's)", "Work"},
             [this](const std::string& o, const std::string& t) { options.memory_limit = parse_bytes(o, t); });
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
}

void CrossingsCommand::run() {
  if (!output.given()) output.set_path(mesh.stem() + ".npz");
  check_input(mesh.name());
  output.check(crossing_formats());
  output.check_differs(mesh.name());
  const Mesh loaded = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read(); });
  validate(loaded);
  const GridChoice choice = grid.choose(bounds(loaded));
  console.say(mesh_line(mesh.name(), loaded));
  const std::vector<EdgeCrossing> crossings = naming_mesh(mesh.name(), "crossings", [&] {
    return with_progress(console, options.progress, [&] { return edge_crossings(loaded, choice.grid, options); });
  });
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
  add_command<CrossingsCommand>(program, "crossings", "find where the edges of a grid cross a mesh (Hermite data)",
                                kCrossingsExamples);
}

namespace {

constexpr const char* kVoxelsExamples =
    R"(  standoff voxels bunny.obj                             solid voxels into bunny.npz
  standoff voxels bunny.obj --surface -o shell.nrrd     those that the surface passes through
  standoff voxels part.stl --both -r 64 -o part.binvox  solid and surface
)";

const std::vector<FileFormat>& voxel_formats() {
  static const std::vector<FileFormat> all{{"npz", "NumPy array", false, true},
                                           {"nrrd", "NRRD", false, true},
                                           {"vti", "VTK image data", false, true},
                                           {"binvox", "binvox", false, true}};
  return all;
}

struct VoxelsCommand {
  MeshInput mesh;
  FileOutput output;
  GridOptions grid;
  SignOptions sign;
  Execution execution;
  Console console;
  bool surface = false, solid = false, both = false;

  void add_to(CLI::App& verb);
  void run();
  Occupancy make(const Mesh& loaded, const Grid& samples, const ProgressCallback& progress) const;
  void tell(const Mesh& loaded, const Occupancy& voxels) const;
};

void VoxelsCommand::add_to(CLI::App& verb) {
  mesh.add_to(verb);
  output.add_to(verb, "FILE",
                "the voxels: " + extensions(voxel_formats(), true) + "\n(default: the mesh's name with .npz, here)");
  auto* solid_flag = verb.add_flag("--solid", solid, "voxels whose centre is inside (default)")->group("Voxels");
  auto* surface_flag =
      verb.add_flag("--surface", surface, "voxels that a triangle touches, their faces and corners included")
          ->group("Voxels");
  verb.add_flag("--both", both, "solid and surface voxels")->group("Voxels")->excludes(solid_flag, surface_flag);
  surface_flag->excludes(solid_flag);
  grid.add_without_thickness_to(verb);
  mesh.add_scale_to(verb);
  const auto at_samples = [](const SignMethodInfo& info) { return info.at_samples; };
  add_sign_to(verb, at_samples, "what is inside. " + sign_texts(at_samples, sign.method), sign);
  add_threads(verb, "Work", execution.threads);
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
}

Occupancy VoxelsCommand::make(const Mesh& loaded, const Grid& samples, const ProgressCallback& progress) const {
  if (surface) return surface_voxels(loaded, samples, {.execution = execution, .progress = progress});
  Occupancy voxels = occupancy(loaded, samples, {.sign = sign, .execution = execution, .progress = progress});
  if (both) add_voxels(voxels, surface_voxels(loaded, samples, {.execution = execution}));
  return voxels;
}

void VoxelsCommand::run() {
  if (!output.given()) output.set_path(mesh.stem() + ".npz");
  check_input(mesh.name());
  output.check(voxel_formats());
  output.check_differs(mesh.name());
  const Mesh loaded = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read(); });
  validate(loaded);
  const GridChoice choice = grid.choose(bounds(loaded));
  const double bits = static_cast<double>(choice.grid.sample_count()) / 8 * (both ? 2 : 1);
  if (const std::int64_t limit = default_memory_limit(); limit > 0 && bits > static_cast<double>(limit))
    throw Error(ErrorCode::limit, "voxels: " + std::to_string(choice.grid.sample_count()) +
                                      " voxels take more memory than there is; take fewer samples");
  console.say(mesh_line(mesh.name(), loaded));
  console.say(grid_line(choice));
  ProgressCallback progress;
  const Occupancy voxels = naming_mesh(mesh.name(), "voxels", [&] {
    return with_progress(console, progress, [&] { return make(loaded, choice.grid, progress); });
  });
  if (!surface && voxels.sign.method == SignMethod::none)
    console.warn(mesh.name() + ": no voxel is solid: " + voxels.sign.why + "; --surface needs no inside");
  else
    say_sign(console, voxels.sign);
  with_spinner(console, "writing " + output.path().string(),
               [&] { write_voxels(output.path(), voxels, output.existing()); });
  tell(loaded, voxels);
}

void VoxelsCommand::tell(const Mesh& loaded, const Occupancy& voxels) const {
  const std::int64_t count = voxels.count();
  console.say(output.path().string() + ": " + counted(count, "voxel") + " of " + grouped(voxels.grid.sample_count()));
  if (!console.json()) return;
  Json json = json_answer("voxels");
  json["mesh"] = {{"file", mesh.name()}, {"triangles", loaded.triangles.size()}};
  json["grid"] = json_grid(voxels.grid);
  json["kind"] = both ? "both" : surface ? "surface" : "solid";
  if (!surface)
    json["sign"] = {{"method", name_of(voxels.sign.method)}, {"why", voxels.sign.why}, {"sure", voxels.sign.sure}};
  json["voxels"] = count;
  json["output"] = json_output(output.path());
  print(json, output.path());
}

}  // namespace

void add_voxels(CLI::App& program) {
  add_command<VoxelsCommand>(program, "voxels", "find the voxels on the surface of a mesh, or inside it",
                             kVoxelsExamples);
}

}  // namespace standoff::cli
