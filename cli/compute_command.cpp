// SPDX-License-Identifier: Apache-2.0
// standoff compute: a mesh file into a field file.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/beside.h"
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
#include "standoff/compute.h"
#include "standoff/confidence.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/slabs.h"

namespace standoff::cli {
namespace {

constexpr const char* kComputeExamples =
    R"(  standoff compute bunny.obj                             into bunny.vti, 256 samples on the longest side
  standoff compute bunny.obj -o field.npz -t 3s -r 400   a band of 3 samples, for numpy
  standoff compute part.stl --unit mm --spacing 0.0005   metres out of millimetres, a sample every 0.5 mm
  standoff compute part.stl --size 100,100,50 -t 0.2     a grid and a thickness of your own
  standoff compute part.stl --sign auto                  negative inside, and a line that says why
  standoff compute part.stl --dry-run                    grid, memory and file size, nothing else
  standoff compute scene:factory -t 2s --json            a mesh made by code; what happened as JSON
)";

struct ComputeCommand {
  MeshInput mesh;
  FileOutput output;
  GridOptions grid;
  ComputeOptions options;
  Console console;
  Thickness shell{0};  // of --sign shell
  bool dry_run = false, uncompressed = false;
  Beside beside;
  std::optional<std::string> confidence_name;
  FileOutput confidence;  // of the sign, if it has a name

  void add_to(CLI::App& verb);
  void run();

 private:
  GridChoice choose_grid(const Box& box);
  FieldWriteOptions write_options() const;
  Outcome write_in_slabs(const Plan& plan);
  Outcome write_whole(const Plan& plan);
  SignConfidence write_confidence(const Mesh& loaded, const DistanceField& field) const;
};

// Beyond this the padding of the box or the squares of distances would be infinite.
void check_extent(const std::string& name, const Box& box) {
  for (const Vec3 corner : {box.min, box.max})
    for (const double c : {corner.x, corner.y, corner.z})
      if (std::abs(c) > kMaxCoordinate)
        throw Error(ErrorCode::input, name + ": a coordinate of " + number(c) +
                                          ", too far out for a grid; repair the mesh, or scale it down with --scale");
}

void ComputeCommand::add_to(CLI::App& verb) {
  mesh.add_to(verb);
  output.add_to(verb, "FIELD",
                "the field: " + extensions(field_formats(), true) + "\n(default: the mesh's name with .vti, here)");
  verb.add_flag(
          "--dry-run", dry_run,
          "print grid, memory and file size; compute and write nothing.\nExit code 5 where the memory would not do")
      ->group("Output");
  add_uncompressed(verb, uncompressed);
  grid.add_to(verb);
  mesh.add_scale_to(verb);

  const auto add = [&verb](const char* name, const char* value, const char* help, auto set,
                           const char* group = "Work") {
    add_parsed(verb, {name, value, help, group}, set);
  };
  add("--with", "WHAT,..",
      "store for each sample as well (docs/sidecars.md): nearest, the\nnearest triangle's index (or triangle), "
      "closest,\n"
      "barycentric, feature, gradient; several with commas between",
      [this](S o, S t) { beside.add(o, t); });
  add_sign(verb, options.sign, shell);
  add(
      "--confidence", "FIELD",
      "also write how far each sample's winding number is from the\nnext odd half, 0 to 0.5, and say how sure the sign "
      "is",
      [this](S, S t) { confidence_name = t; }, "Sign");
  add_device(verb, "Work", options.execution.backend, options.execution.device);
  add_threads(verb, "Work", options.execution.threads);
  add("--memory-limit", "SIZE",
      "most memory for the field and its making, as in 500M or 8G\n(default: 80 % of the machine's)",
      [this](S o, S t) { options.memory_limit = parse_bytes(o, t); });
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
  add(
      "--method", "NAME", "tiles: exact (default); thesis: Algorithm 1 of 2008",
      [this](S o, S t) { options.method = parse_method(o, t); }, kThesisGroup);
  add(
      "--skip", "RULE",
      "leave triangles out first: none, neighbour[:FRACTION] or\nexact (default: none; thesis: neighbour:1)",
      [this](S o, S t) { options.skip = parse_skip(o, t); }, kThesisGroup);
  grid.add_thesis_to(verb);
}

// The grid is one around the solid: a shell reaches beyond the mesh. Sets the shell's thickness in world units.
GridChoice ComputeCommand::choose_grid(const Box& box) {
  if (options.sign.method != SignMethod::shell) return grid.choose(box);
  const double spacing = shell.in_samples ? grid.choose(box).grid.max_spacing() : 1;
  GridChoice choice = grid.choose(box.grown(shell.world(spacing) / 2));
  options.sign.shell = shell.world(choice.grid.max_spacing());
  return choice;
}

void ComputeCommand::run() {
  if (!output.given()) output.set_path(mesh.stem() + ".vti");
  check_input(mesh.name());
  dry_run ? output.check_name(field_formats()) : output.check(field_formats());
  if (confidence_name) {
    if (options.sign.method == SignMethod::none)
      throw Error(ErrorCode::usage, "--confidence is for fields with a sign; give --sign too");
    confidence = output.beside(*confidence_name);
    confidence.check_differs(mesh.name());
    dry_run ? confidence.check_name(field_formats()) : confidence.check(field_formats());
  }
  beside.check(output);
  beside.prepare(options);
  if (options.memory_limit == 0) options.memory_limit = default_memory_limit();

  const auto start = std::chrono::steady_clock::now();
  MeshReadReport read;
  const Mesh loaded = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read(&read); });
  validate(loaded);
  const Box box = bounds(loaded);
  check_extent(mesh.name(), box);
  Plan plan{mesh.name(), loaded, choose_grid(box), output.path().string(), output.in_the_way()};
  plan.load_seconds = seconds_since(start);
  plan.in_slabs = output.is_written_in_slabs(field_formats()) && beside.empty() && !confidence_name;
  if (dry_run) return tell(plan, options, console);
  console.say(mesh_line(mesh.name(), loaded));
  for (const std::string& note : notes(read)) console.detail(mesh.name() + ": " + note);
  console.say(grid_line(plan.choice));

  Outcome outcome = plan.in_slabs ? write_in_slabs(plan) : write_whole(plan);
  std::error_code ignored;  // a pipe has no size
  const auto size = std::filesystem::file_size(output.path(), ignored);
  outcome.written_bytes = ignored ? 0 : static_cast<std::int64_t>(size);
  say(outcome, console);
  if (console.json()) print(outcome_json(outcome), output.path());
}

FieldWriteOptions ComputeCommand::write_options() const {
  return {.existing = output.existing(), .compress = !uncompressed, .threads = options.execution.threads};
}

// The field is computed while it is written, so that no more than a slab of it is held.
Outcome ComputeCommand::write_in_slabs(const Plan& plan) {
  ProgressCallback bar = console.progress();
  double computed = 0;
  options.progress = [&](const Progress& progress) {
    computed = progress.fraction;
    return !bar || bar(progress);
  };
  const auto start = std::chrono::steady_clock::now();
  std::optional<SlabComputation> slabs;
  {
    const Cancellable cancellable;
    slabs.emplace(plan.mesh, plan.choice.grid, plan.choice.thickness, options);
  }
  if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
  const auto write = [&] { write_field(output.path(), *slabs, write_options()); };
  if (computed < 1) {
    write();
  } else {  // one slab, which is there
    bar = nullptr;
    with_spinner(console, "writing " + output.path().string(), write);
  }
  options.progress = nullptr;
  Outcome outcome{plan, slabs->report(), slabs->provenance().mesh_hash};
  const auto& seconds = outcome.report.seconds;
  outcome.write_seconds = std::max(0.0, seconds_since(start) - seconds.prepare - seconds.compute - seconds.sign);
  return outcome;
}

Outcome ComputeCommand::write_whole(const Plan& plan) {
  ComputeResult computed = [&] {
    const Cancellable cancellable;
    options.progress = console.progress();
    return compute(plan.mesh, plan.choice.grid, plan.choice.thickness, options);
  }();
  options.progress = nullptr;  // and the bar with it
  if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
  const std::vector<Sidecar> sidecars = [&] {
    const Cancellable cancellable;
    return beside.make(plan.mesh, computed.field, options.execution, console.progress());
  }();

  const auto start = std::chrono::steady_clock::now();
  FieldWriteOptions written = write_options();
  written.sidecars = sidecars;
  if (confidence_name) last_file_is(confidence.path().string());
  with_spinner(console, "writing " + output.path().string(),
               [&] { write_field(output.path(), computed.field, written); });
  Outcome outcome{plan, computed.report, computed.field.provenance().mesh_hash};
  outcome.write_seconds = seconds_since(start);
  if (confidence_name) outcome.confidence = write_confidence(plan.mesh, computed.field);
  return outcome;
}

SignConfidence ComputeCommand::write_confidence(const Mesh& loaded, const DistanceField& field) const {
  return with_spinner(console, "writing " + confidence.path().string(), [&] {
    const std::vector<float> margins = winding_margins(loaded, field.grid(), options.sign, {options.execution.threads});
    write_field(confidence.path(), DistanceField::from_dense(field.grid(), 0.5, margins), write_options());
    return sign_confidence(loaded, field, margins, {options.execution.threads});
  });
}

}  // namespace

void add_compute(CLI::App& program) {
  auto* verb = add_verb(program, "compute", "compute the distance field of a mesh", kComputeExamples);
  const auto command = std::make_shared<ComputeCommand>();
  command->add_to(*verb);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
