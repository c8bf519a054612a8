// SPDX-License-Identifier: Apache-2.0
// standoff compute: a mesh file into a field file.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/console.h"
#include "cli/field_options.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/process.h"
#include "cli/sidecar_options.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "files/atomic_file.h"
#include "standoff/compute.h"
#include "standoff/confidence.h"
#include "standoff/error.h"
#include "standoff/field.h"
#include "standoff/field_cache.h"
#include "standoff/io.h"
#include "standoff/mesh.h"
#include "standoff/sidecars.h"
#include "standoff/sign_decision.h"
#include "standoff/slabs.h"
#include "standoff/windows.h"

namespace standoff::cli {
namespace {

/// A computation before it starts.
struct Plan {
  std::string mesh_name;
  const Mesh& mesh;
  GridChoice choice;
  std::optional<WindowText> window;  ///< of the choice's grid
  std::string output;
  bool in_the_way = false;  ///< the output exists, and may not be overwritten
  double load_seconds = 0;
  bool in_slabs = false;          ///< the field is written while it is computed
  bool sparse = false;            ///< FileFormat::sparse of the output
  bool folder = false;            ///< FileFormat::folder of the output
  bool compressed = false;        ///< samples are, and need not be
  std::int64_t bytes_beside = 0;  ///< of sidecars, for each sample of a stored tile

  bool has_known_size() const { return !sparse && !folder && !compressed; }

  Grid grid() const { return window ? choice.grid.window(window->first, window->size) : choice.grid; }
};

/// A computation that has written its field.
struct Outcome {
  Plan plan;
  ComputeReport report;
  std::uint64_t mesh_hash = 0;
  double write_seconds = 0;
  double write_processor_seconds = 0;  ///< of all threads, where nothing else ran while the field was written
  std::int64_t written_bytes = 0;
  std::optional<SignConfidence> confidence = {};
  bool cached = false;  ///< it was computed before, and the report is of that time
};

std::int64_t tile_count(Size3 samples) { return DistanceField::tiles_of(samples).count(); }

// What a file of the output's format takes at most, but for a header of less than 4 KiB: it has the samples as they
// are, or packs them. Trees have whole tiles and tables of them, and stores whole chunks in shards.
double most_file_bytes(const Plan& plan, const ComputeOptions& options) {
  if (plan.sparse) {
    const auto tiles = static_cast<double>(tile_count(plan.grid().size));
    return 2300 * tiles + 40'000 * (tiles / 512 + 1) + 300'000 * (tiles / 262'144 + 1);
  }
  const double bytes = (options.nearest ? 8.0 : 4.0) + static_cast<double>(plan.bytes_beside);
  const Size3 size = plan.grid().size;
  if (plan.folder) {
    const auto up = [](std::int64_t samples) { return static_cast<double>((samples + 31) / 32 * 32); };
    return bytes * 1.001 * up(size.x) * up(size.y) * up(size.z) + 4096;
  }
  return bytes * static_cast<double>(size.count());
}

Json description(const Plan& plan) {
  const Box box = bounds(plan.mesh);
  Json json = json_answer("compute");
  json["mesh"] = {{"file", plan.mesh_name},
                  {"triangles", plan.mesh.triangles.size()},
                  {"vertices", plan.mesh.vertices.size()},
                  {"bounds", json_box(box)}};
  json["grid"] = json_grid(plan.grid());
  json["thickness"] = json_number(plan.choice.thickness);
  return json;
}

std::string confidence_line(const SignConfidence& found) {
  const auto percent = [](double share) { return number(100 * share) + " %"; };
  return "confidence: of " + counted(found.samples, "sample") + " in the band " + percent(found.doubtful) +
         " are doubtful, lines along the three axes disagree about " + percent(found.axes_disagree) +
         ", and a flood from outside about " + percent(found.flood_disagrees);
}

// Throws where a window is not within a grid of so many samples.
void check_window(const WindowText& window, const Size3& grid) {
  const auto& [first, size] = window;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (first[axis] > grid[axis] - size[axis])
      throw Error(ErrorCode::usage, std::string("--window: ") + std::to_string(size[axis]) + " samples from sample " +
                                        std::to_string(first[axis]) + " on along " + "xyz"[axis] +
                                        " are not within the grid, which has " + std::to_string(grid[axis]) +
                                        " there; give a window within it");
}

// Requires a window.
std::string window_line(const Plan& plan) {
  const auto& [first, size] = *plan.window;
  return "window of " + size_text(size) + " samples, from sample " + std::to_string(first.x) + "," +
         std::to_string(first.y) + "," + std::to_string(first.z) + " on";
}

// What the field takes at most, and the sidecars.
std::int64_t memory_needed(const Plan& plan, const ComputeOptions& options) {
  const auto& [grid, thickness] = plan.choice;
  const auto with_beside = [&](std::int64_t field, std::int64_t samples) {
    const double beside = static_cast<double>(samples) * static_cast<double>(plan.bytes_beside);
    return static_cast<std::int64_t>(std::min(static_cast<double>(field) + beside, 0x1p62));
  };
  if (plan.window)
    return with_beside(estimate_window(plan.mesh, grid, thickness, plan.window->size, options),
                       DistanceField::kTileSamples * tile_count(plan.window->size));
  const MemoryEstimate found = estimate(plan.mesh, grid, thickness, options);
  return plan.in_slabs ? found.slabs : with_beside(found.whole, found.stored_samples);
}

std::string shown_bytes(double bytes) { return bytes_text(static_cast<std::int64_t>(std::min(bytes, 0x1p62))); }

// "; its disk has 69.0 GiB free" where that is less than these bytes; else nothing.
std::string lack_of_room(double bytes, std::optional<std::uint64_t> room) {
  if (!room || bytes <= static_cast<double>(*room)) return "";
  return "; its disk has " + bytes_text(static_cast<std::int64_t>(*room)) + " free";
}

// Before the work rather than at its end. Errors: output, where the file has a known size. Compressed files have none:
// of full fields, which most often stay nearly as large as they are, it is a warning; bands become much smaller.
void check_room(const Plan& plan, const ComputeOptions& options, const Console& console) {
  const double bytes = most_file_bytes(plan, options);
  const auto room = room_for(plan.output);
  if (plan.has_known_size()) return expect_room(plan.output, bytes, room);
  const std::string lack = lack_of_room(bytes, room);
  if (lack.empty() || plan.sparse || std::isfinite(plan.choice.thickness)) return;
  console.warn(plan.output + " may take " + shown_bytes(bytes) + lack +
               "; free some, write to another one, or take fewer samples");
}

// What --dry-run prints. Throws Error{limit} after it where the real run would be refused for its memory.
void tell(const Plan& plan, const FieldOptions& field, const Console& console) {
  const ComputeOptions& options = field.compute;
  const Grid grid = plan.grid();
  const std::int64_t needed = memory_needed(plan, options), limit = field.memory_limit();
  const std::string memory = "needs at most " + bytes_text(needed) + " beside the mesh";
  const std::string over = ", more than the limit of " + bytes_text(limit);
  const double file_bytes = most_file_bytes(plan, options);
  const auto room = room_for(plan.output);
  if (console.json()) {
    Json json = description(plan);
    json["samples"] = {{"total", grid.sample_count()}};
    json["tiles"] = {{"total", tile_count(grid.size)}};
    json["seconds"] = {{"load", plan.load_seconds}};
    json["memory_needed_bytes"] = needed;
    json["memory_limit_bytes"] = options.memory_limit < 0 ? Json() : Json(limit);
    json["dry_run"] = true;
    json["output"] = {{"file", plan.output},
                      {"bytes", static_cast<std::int64_t>(std::min(file_bytes, 0x1p62))},
                      {"in_the_way", plan.in_the_way}};
    json["output"]["free_bytes"] = room ? Json(*room) : Json();
    print(json);
  } else {
    print(mesh_line(plan.mesh_name, plan.mesh) + "\n" + grid_line(plan.choice) + "\n" +
          (plan.window ? window_line(plan) + "\n" : "") +  //
          "from " + point_text(grid.corner()) + " to " + point_text(grid.bounds().max) + ", " +
          counted(grid.sample_count(), "sample") + " in " + counted(tile_count(grid.size), "tile") + "\n" +  //
          memory + (needed > limit ? over : "") + "\n" +                                                     //
          "would write " + plan.output + ", at most " + shown_bytes(file_bytes) + lack_of_room(file_bytes, room) +
          (plan.in_the_way ? "; it exists: give -f to overwrite it" : "") + "\n");
  }
  if (needed > limit)
    throw Error(ErrorCode::limit, "compute: the field " + memory + over +
                                      "; take fewer samples, a smaller thickness, or a larger --memory-limit");
}

// Errors: limit. Of a field without sidecars the computation says the same.
void check_memory(const Plan& plan, const FieldOptions& field) {
  if (const std::int64_t needed = memory_needed(plan, field.compute), limit = field.memory_limit(); needed > limit)
    throw Error(ErrorCode::limit,
                "compute: the field and what stands beside it may need " + bytes_text(needed) +
                    ", more than the limit of " + bytes_text(limit) +
                    "; take fewer samples, a smaller thickness, less with --with, or a larger --memory-limit",
                {.bytes_needed = needed, .bytes_limit = limit});
}

void say(const Outcome& outcome, const Console& console) {
  const ComputeReport& report = outcome.report;
  const double load = outcome.plan.load_seconds, prepare = report.seconds.prepare, compute = report.seconds.compute,
               sign = report.seconds.sign, write = outcome.write_seconds;
  say_sign(console, report.sign);
  if (outcome.confidence) console.say(confidence_line(*outcome.confidence));
  if (report.sign.internal > 0) console.say(counted(report.sign.internal, "triangle") + " inside the union left out");
  if (report.sign.cut > 0)
    console.warn(counted(report.sign.cut, "triangle") +
                 " that others cut are kept: distances inside, near them, are too small");
  if (report.skipped > 0) console.say(counted(report.skipped, "triangle") + " skipped");
  console.detail(counted(report.samples_band, "sample") + " in the band, " + grouped(report.tiles_stored) + " of " +
                 counted(report.tiles, "tile") + " stored, " + counted(report.samples_examined, "distance") +
                 " computed");
  console.detail("load " + seconds_text(load) + ", prepare " + seconds_text(prepare) + ", compute " +
                 seconds_text(compute) + (sign > 0 ? ", sign " + seconds_text(sign) : "") + ", write " +
                 seconds_text(write) + "; peak memory " + bytes_text(peak_memory_bytes()));
  if (outcome.cached)
    return console.say(outcome.plan.output + ": " + bytes_text(outcome.written_bytes) + ", computed before");
  const double computing = prepare + compute + sign;
  console.say(outcome.plan.output + ": " + bytes_text(outcome.written_bytes) + " in " +
              seconds_text(load + computing + write) + ", " + seconds_text(computing) + " of it compute and " +
              seconds_text(write) + " write; " + report.method + " on " + report.backend + " (" + report.device +
              "), " + counted(report.threads, "thread"));
  // Where the threads wait for the disk, a larger file would take longer.
  constexpr double kLong = 1, kBusy = 0.7;  // seconds that are worth a hint; processors, of which one compresses
  if (outcome.plan.compressed && write > std::max(kLong, computing) && outcome.write_processor_seconds > kBusy * write)
    console.say("most of that was compression; --uncompressed writes a larger file sooner");
}

Json outcome_json(const Outcome& outcome) {
  const ComputeReport& report = outcome.report;
  Json json = description(outcome.plan);
  json["mesh"]["skipped"] = report.skipped;
  json["mesh"]["hash"] = hash_text(outcome.mesh_hash);
  json["sign"] = {{"method", name_of(report.sign.method)},
                  {"why", report.sign.why},
                  {"sure", report.sign.sure},
                  {"flipped", report.sign.flipped},
                  {"left_out", report.sign.left_out},
                  {"boundary_edges", report.sign.boundary_edges},
                  {"internal", report.sign.internal},
                  {"cut", report.sign.cut}};
  if (const auto& found = outcome.confidence)
    json["sign"]["confidence"] = {{"samples", found->samples},
                                  {"doubtful", found->doubtful},
                                  {"axes_disagree", found->axes_disagree},
                                  {"flood_disagrees", found->flood_disagrees}};
  json["samples"] = {{"total", report.samples}, {"examined", report.samples_examined}, {"band", report.samples_band}};
  json["tiles"] = {{"total", report.tiles}, {"stored", report.tiles_stored}};
  json["seconds"] = {{"load", outcome.plan.load_seconds},
                     {"prepare", report.seconds.prepare},
                     {"compute", report.seconds.compute},
                     {"sign", report.seconds.sign},
                     {"write", outcome.write_seconds}};
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["method"] = report.method;
  json["device"] = report.backend;
  json["device_name"] = report.device;
  json["threads"] = report.threads;
  json["dry_run"] = false;
  json["cached"] = outcome.cached;
  json["output"] = {{"file", outcome.plan.output}, {"bytes", outcome.written_bytes}};
  return json;
}

constexpr const char* kComputeExamples =
    R"(  standoff compute bunny.obj                             into bunny.vti, 256 samples on the longest side
  standoff compute bunny.obj -o field.npz -t 3s -r 400   a band of 3 samples, for numpy
  standoff compute part.stl --unit mm --spacing 0.0005   metres out of millimetres, a sample every 0.5 mm
  standoff compute part.stl --size 100,100,50 -t 0.2     a grid and a thickness of your own
  standoff compute part.stl --sign none                  distances without a sign
  standoff compute part.stl --dry-run                    grid, memory and file size, nothing else
  standoff compute scene:factory -t 2s --json            a mesh made by code; what happened as JSON
)";

struct ComputeCommand {
  MeshInput mesh;
  FileOutput output;
  FieldOptions field;
  ComputeOptions& options = field.compute;
  Console console;
  std::optional<WindowText> window;
  std::optional<std::filesystem::path> decision;  // a file, of the sign
  bool dry_run = false, uncompressed = false;
  int levels = 1;  // of a store
  SidecarOptions beside;
  CacheOption cache;
  std::optional<FieldCache> kept;  ///< of the cache, if it is given
  std::optional<std::string> confidence_name;
  FileOutput confidence;  // of the sign, if it has a name

  void add_to(CLI::App& verb);
  void run();

 private:
  FieldWriteOptions write_options() const;
  Outcome write_or_fetch(const Plan& plan);
  Outcome write_in_slabs(const Plan& plan);
  void check_decision() const;
  WindowComputation decided_windows(const Plan& plan);
  ComputeResult compute_window(const Plan& plan);
  Outcome write_whole(const Plan& plan);
  SignConfidence write_confidence(const Mesh& loaded, const DistanceField& computed) const;
};

void ComputeCommand::add_to(CLI::App& verb) {
  mesh.add_to(verb);
  output.add_to(verb, "FIELD",
                "the field: " + extensions(field_formats(), true) + "\n(default: the mesh's name with .vti, here)");
  verb.add_flag(
          "--dry-run", dry_run,
          "print grid, memory and file size; compute and write nothing.\nExit code 5 where the memory would not do")
      ->group("Output");
  add_uncompressed(verb, uncompressed);
  add_levels(verb, levels);
  cache.add_to(verb, "Output");
  field.add_grid_to(verb);
  add_parsed(
      verb,
      {"--window", "I,J,K,NX,NY,NZ",
       "compute NX x NY x NZ samples of the grid from sample I,J,K on:\nthe values that the whole field has there "
       "(docs/scale.md)",
       "Grid"},
      [this](S o, S t) { window = parse_window(o, t); });
  add_parsed(
      verb,
      {"--decision", "FILE",
       "with --window: take from this file how the sign is decided, or\nwrite it there if it is missing, for all "
       "windows of the field",
       "Grid"},
      [this](S, S t) { decision = t; });
  mesh.add_scale_to(verb);

  const auto add = [&verb](const char* name, const char* value, const char* help, const char* group, auto set) {
    add_parsed(verb, {name, value, help, group}, set);
  };
  add("--with", "WHAT,..",
      "store for each sample as well (docs/sidecars.md): nearest, the\nnearest triangle's index (or triangle), "
      "closest,\n"
      "barycentric, feature, gradient; several with commas between",
      "Work", [this](S o, S t) { beside.add(o, t); });
  field.add_sign_to(verb);
  add("--confidence", "FIELD",
      "also write how far each sample's winding number is from the\nnext odd half, 0 to 0.5, and say how sure the sign "
      "is",
      "Sign", [this](S, S t) { confidence_name = t; });
  field.add_work_to(verb);
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
  field.add_thesis_to(verb);
}

void ComputeCommand::run() {
  if (!output.given()) output.set_path(mesh.stem() + ".vti");
  check_input(mesh.name());
  dry_run ? output.check_name(field_formats()) : output.check(field_formats());
  if (confidence_name) {
    if (options.sign.method == SignMethod::none)
      throw Error(ErrorCode::usage, "--confidence is for fields with a sign; leave out --sign none");
    confidence = output.beside(*confidence_name);
    confidence.check_differs(mesh.name());
    dry_run ? confidence.check_name(field_formats()) : confidence.check(field_formats());
  }
  if (window)
    if (const auto known = field.known_size()) check_window(*window, *known);
  check_decision();
  beside.check(output);
  beside.prepare(options);
  output.check_levels(levels);
  if (cache.given() && output.format(field_formats()).folder)
    throw Error(ErrorCode::usage, "--cache keeps files, and " + output.path().string() +
                                      " is a folder; write a file, or leave the cache out");
  if (cache.given()) {
    if (!beside.empty() || confidence_name)
      throw Error(ErrorCode::usage, "--cache: it keeps distances alone; leave it out, or --with and --confidence");
    std::error_code ignored;
    if (const auto status = std::filesystem::status(output.path(), ignored);
        std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
      throw Error(ErrorCode::usage,
                  "--cache: " + output.path().string() + " is no file that can be kept; leave it out");
    if (!dry_run) kept.emplace(cache.open());
  }

  const auto start = std::chrono::steady_clock::now();
  const auto [loaded, read] = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read_with_report(); });
  validate(loaded);
  Plan plan{mesh.name(),        loaded, field.choose_grid(mesh.name(), bounds(loaded)), window, output.path().string(),
            output.in_the_way()};
  if (window) check_window(*window, plan.choice.grid.size);
  if (const std::string doubt = field.doubt_of_thickness(bounds(loaded)); !doubt.empty()) console.warn(doubt);
  plan.load_seconds = seconds_since(start);
  plan.in_slabs = !window && output.format(field_formats()).slabs && beside.empty() && !confidence_name;
  plan.sparse = output.format(field_formats()).sparse;
  plan.folder = output.format(field_formats()).folder;
  plan.compressed = !uncompressed && !plan.sparse && !plan.folder;
  plan.bytes_beside = beside.bytes_per_sample();
  if (dry_run) return tell(plan, field, console);
  console.say(mesh_line(mesh.name(), loaded));
  options.up = read.up;
  for (const std::string& note : notes(read)) console.detail(mesh.name() + ": " + note);
  console.say(grid_line(plan.choice));
  if (plan.window) console.say(window_line(plan));

  if (plan.bytes_beside > 0) check_memory(plan, field);
  check_room(plan, options, console);
  Outcome outcome = naming_mesh(mesh.name(), "compute", [&] {
    return cache.given() ? write_or_fetch(plan) : plan.in_slabs ? write_in_slabs(plan) : write_whole(plan);
  });
  outcome.written_bytes = written_bytes(output.path());
  say(outcome, console);
  if (console.json()) print(outcome_json(outcome), output.path());
}

FieldWriteOptions ComputeCommand::write_options() const {
  return {
      .existing = output.existing(), .compress = !uncompressed, .threads = options.execution.threads, .levels = levels};
}

Outcome ComputeCommand::write_or_fetch(const Plan& plan) {
  const auto start = std::chrono::steady_clock::now();
  FieldCache::File file{output.format(field_formats()).extension, !uncompressed};
  if (window) file.window = {window->first, window->size};
  const FieldCache::Key key = FieldCache::key(plan.mesh, plan.choice.grid, plan.choice.thickness, options, file);
  const FieldCache::Fetched found = kept->fetch(key, output.path(), output.existing());
  if (!found.problem.empty()) console.warn(found.problem);
  if (found.report) {
    Outcome outcome{plan, *found.report, found.report->provenance.mesh_hash};
    outcome.write_seconds = seconds_since(start);
    outcome.cached = true;
    return outcome;
  }
  Outcome outcome = plan.in_slabs ? write_in_slabs(plan) : write_whole(plan);
  outcome.report.provenance.mesh_hash = outcome.mesh_hash;
  const std::string problem = kept->store(key, output.path(), outcome.report);
  if (!problem.empty()) console.warn(problem);
  return outcome;
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Computes the field while it is written, so that no more than a slab of it is held.
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
  double processor = 0;
  const auto write = [&] { write_field(output.path(), *slabs, write_options()); };
  if (computed < 1) {
    write();
  } else {  // there is one slab, and it is computed
    bar = nullptr;
    const double before = processor_seconds();
    with_spinner(console, "writing " + output.path().string(), write);
    processor = processor_seconds() - before;
  }
  options.progress = nullptr;
  Outcome outcome{plan, slabs->report(), slabs->provenance().mesh_hash};
  const auto& seconds = outcome.report.seconds;
  outcome.write_processor_seconds = processor;
  outcome.write_seconds = std::max(0.0, seconds_since(start) - seconds.prepare - seconds.compute - seconds.sign);
  return outcome;
}

void ComputeCommand::check_decision() const {
  if (!decision) return;
  if (!window)
    throw Error(ErrorCode::usage, "--decision: it is for the windows of a field; give --window, or leave it out");
  if (cache.given())
    throw Error(ErrorCode::usage,
                "--decision and --cache cannot go together: a field of the cache is decided already; leave one out");
  std::error_code ignored;
  if (const auto status = std::filesystem::status(*decision, ignored);
      std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw Error(ErrorCode::usage, "--decision: " + decision->string() + " is no file; name a file, or a new one");
  output.beside(*decision).check_differs(mesh.name());
}

// Windows by the decision of a file, which is written if there is none.
WindowComputation ComputeCommand::decided_windows(const Plan& plan) {
  const auto make = [&] {
    return WindowComputation(plan.mesh, plan.choice.grid, plan.choice.thickness, plan.window->size, options);
  };
  if (!decision) return make();
  std::error_code ignored;
  if (!std::filesystem::exists(*decision, ignored)) {
    WindowComputation windows = make();
    const std::vector<std::byte> bytes = windows.decision().bytes();
    write_text(*decision, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return windows;
  }
  const std::string bytes = read_text(*decision);
  try {
    options.decision = SignDecision::from_bytes(std::as_bytes(std::span(bytes)));
    return make();
  } catch (const Error& error) {
    const std::string_view words = error.what();
    if (words.find("sign decision") == words.npos) throw;
    throw Error(error.code(), decision->string() + ": " + error.what());
  }
}

ComputeResult ComputeCommand::compute_window(const Plan& plan) {
  const auto& [first, size] = *plan.window;
  WindowComputation windows = decided_windows(plan);
  ComputeResult made;
  windows.compute(first, size, made.field);
  made.report = windows.report();
  return made;
}

Outcome ComputeCommand::write_whole(const Plan& plan) {
  ComputeResult computed = with_progress(console, options.progress, [&] {
    return plan.window ? compute_window(plan) : compute(plan.mesh, plan.choice.grid, plan.choice.thickness, options);
  });
  const std::vector<Sidecar> sidecars = [&] {
    const Cancellable cancellable;
    return beside.make(plan.mesh, computed.field, options.execution, console.progress());
  }();

  const auto start = std::chrono::steady_clock::now();
  FieldWriteOptions written = write_options();
  written.sidecars = sidecars;
  if (confidence_name) last_file_is(confidence.path().string());
  const double before = processor_seconds();
  with_spinner(console, "writing " + output.path().string(),
               [&] { write_field(output.path(), computed.field, written); });
  Outcome outcome{plan, computed.report, computed.field.provenance().mesh_hash};
  outcome.write_seconds = seconds_since(start);
  outcome.write_processor_seconds = processor_seconds() - before;
  if (confidence_name) outcome.confidence = write_confidence(plan.mesh, computed.field);
  return outcome;
}

SignConfidence ComputeCommand::write_confidence(const Mesh& loaded, const DistanceField& computed) const {
  return with_spinner(console, "writing " + confidence.path().string(), [&] {
    const ConfidenceOptions asked{.sign = options.sign, .execution = {options.execution.threads}};
    const std::vector<float> margins = winding_margins(loaded, computed.grid(), asked);
    write_field(confidence.path(), DistanceField::from_dense(computed.grid(), 0.5, margins), write_options());
    return sign_confidence(loaded, computed, margins, asked);
  });
}

}  // namespace

void add_compute(CLI::App& program) {
  add_command<ComputeCommand>(program, "compute", "compute the distance field of a mesh", kComputeExamples);
}

}  // namespace standoff::cli
