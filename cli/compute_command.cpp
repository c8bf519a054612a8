// difi compute: a mesh file into a field file.
#include <chrono>
#include <memory>

#include "cli/commands.h"
#include "cli/files.h"
#include "cli/grid_options.h"
#include "cli/memory.h"
#include "cli/option.h"
#include "cli/parse.h"
#include "cli/signals.h"
#include "cli/talk.h"
#include "cli/text.h"
#include "cli/usage.h"
#include "difi/compute.h"
#include "difi/error.h"
#include "difi/io.h"
#include "difi/version.h"

namespace difi::cli {
namespace {

constexpr const char* kExamples =
    R"(  difi compute bunny.obj                             into bunny.vti, 256 samples on the longest side
  difi compute bunny.obj -o field.npz -t 3s -r 400   a band of 3 samples, for numpy
  difi compute part.stl --unit mm --spacing 0.0005   metres out of millimetres, a sample every 0.5 mm
  difi compute part.stl --size 100,100,50 -t 0.2     a grid and a thickness of your own
  difi compute part.stl --minimum 2 -t 0.1           the smallest grid for collision
  difi compute part.stl --dry-run                    grid and memory, nothing else
  difi compute scene:factory -t 2s --json            a mesh made by code; what happened as JSON
)";

struct Command {
  MeshInput mesh;
  FileOutput output;
  GridOptions grid;
  Options options;
  Talk talk;
  bool dry_run = false;

  void add_to(CLI::App& verb);
  void run();

 private:
  void plan(const Mesh& mesh, const GridChoice& choice, double load_seconds) const;
  Json description(const Mesh& mesh, const GridChoice& choice) const;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Command::add_to(CLI::App& verb) {
  mesh.add_to(verb);
  output.add_to(verb, "FIELD",
                "the field: " + extensions(field_formats(), true) + "\n(default: the mesh's name with .vti, here)");
  verb.add_flag("--dry-run", dry_run, "print grid, tiles and memory; compute and write nothing")->group("Output");
  grid.add_to(verb);
  mesh.add_scale_to(verb);

  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    add_parsed(verb, {name, value, help, "Method"}, set);
  };
  using S = const std::string&;
  add("--method", "NAME", "tiles: exact (default); thesis: Algorithm 1 of 2008",
      [this](S o, S t) { options.method = parse_method(o, t); });
  add("--skip", "RULE",
      "leave triangles out first: none, neighbour[:FRACTION] or\nexact (default: none; thesis: neighbour:1)",
      [this](S o, S t) { options.skip = parse_skip(o, t); });
  add("--with", "WHAT", "triangle: store the nearest triangle's index as well", [this](S o, S t) {
    parse_choice(o, t, {"triangle"});
    options.nearest_triangle = true;
  });
  add("--device", "NAME", "auto (default), cpu or cuda", [this](S o, S t) { options.backend = parse_backend(o, t); });
  add("-j,--threads", "N", "threads (default: all)",
      [this](S o, S t) { options.threads = static_cast<int>(parse_count(o, t, 1, 4096)); });
  add("--memory-limit", "SIZE",
      "most memory for the field and its making, as in 500M or 8G\n(default: 80 % of the machine's)",
      [this](S o, S t) { options.memory_limit = parse_bytes(o, t); });
  talk.add_to(verb, Talk::kMessages | Talk::kJson | Talk::kProgress);
}

std::int64_t tile_count(Size3 size) {
  constexpr std::int64_t side = DistanceField::kTileSide;
  return ((size.x + side - 1) / side) * ((size.y + side - 1) / side) * ((size.z + side - 1) / side);
}

std::string grid_line(const GridChoice& choice) {
  const std::string band =
      std::isinf(choice.thickness) ? "full field" : "band of thickness " + number(choice.thickness);
  return "grid " + size_text(choice.grid.size) + ", spacing " + spacing_text(choice.grid.spacing) + ", " + band;
}

Json Command::description(const Mesh& loaded, const GridChoice& choice) const {
  const Box box = bounds(loaded);
  const Grid& g = choice.grid;
  return {{"version", version()},
          {"mesh",
           {{"file", mesh.name()},
            {"triangles", loaded.triangles.size()},
            {"vertices", loaded.vertices.size()},
            {"bounds", {json_point(box.min), json_point(box.max)}}}},
          {"grid", {{"size", json_size(g.size)}, {"origin", json_point(g.origin)}, {"spacing", json_point(g.spacing)}}},
          {"thickness", json_number(choice.thickness)}};
}

void Command::plan(const Mesh& loaded, const GridChoice& choice, double load_seconds) const {
  const auto triangles = static_cast<std::int64_t>(loaded.triangles.size());
  const std::int64_t needed = memory_needed(triangles, choice.grid, options);
  const std::int64_t tiles = tile_count(choice.grid.size);
  const bool fits = needed <= options.memory_limit;
  if (talk.json()) {
    Json json = description(loaded, choice);
    json["samples"] = {{"total", choice.grid.sample_count()}};
    json["tiles"] = {{"total", tiles}};
    json["seconds"] = {{"load", load_seconds}};
    json["memory_needed_bytes"] = needed;
    json["memory_limit_bytes"] = options.memory_limit;
    json["output"] = {{"file", output.path().string()}};
    json["dry_run"] = true;
    return print(json);
  }
  const Grid& g = choice.grid;
  print(mesh_line(mesh.name(), loaded) + "\n" + grid_line(choice) + "\n" + "from " + point_text(g.origin) + " to " +
        point_text(g.bounds().max) + "; " + counted(g.sample_count(), "sample") + " in " + counted(tiles, "tile") +
        "\n" + "needs at most " + bytes_text(needed) + " beside the mesh" +
        (fits ? "" : ", more than the limit of " + bytes_text(options.memory_limit)) + "; would write " +
        output.path().string() + "\n");
}

void Command::run() {
  if (!output.given()) output.set_path(mesh.stem() + ".vti");
  output.check(field_formats());
  if (options.memory_limit == 0) options.memory_limit = default_memory_limit();

  auto start = std::chrono::steady_clock::now();
  const Mesh loaded = mesh.read();
  validate(loaded);
  const GridChoice choice = grid.choose(bounds(loaded));
  options.thickness = choice.thickness;
  const double load_seconds = seconds_since(start);
  if (dry_run) return plan(loaded, choice, load_seconds);
  talk.detail(mesh_line(mesh.name(), loaded) + ", read in " + seconds_text(load_seconds));
  talk.detail(grid_line(choice) + ", from " + point_text(choice.grid.origin));

  Computed computed = [&] {
    const Cancellable cancellable;
    options.progress = talk.progress();
    return compute(loaded, choice.grid, options);
  }();
  options.progress = nullptr;  // and the bar with it
  if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
  const Report& report = computed.report;
  computed.field.provenance.mesh_hash = content_hash(loaded);

  start = std::chrono::steady_clock::now();
  write_field(output.path(), computed.field);
  const double write_seconds = seconds_since(start);
  std::error_code ignored;  // a pipe has no size
  const auto size = std::filesystem::file_size(output.path(), ignored);
  const auto written = ignored ? 0 : static_cast<std::int64_t>(size);

  if (!talk.verbose()) talk.say(mesh_line(mesh.name(), loaded));
  talk.say(grid_line(choice) + "; " + report.method + " on " + report.backend + " (" + report.device + "), " +
           counted(report.threads, "thread"));
  if (report.skipped > 0) talk.say(counted(report.skipped, "triangle") + " skipped");
  talk.detail(counted(report.samples_band, "sample") + " in the band, " + counted(report.tiles_stored, "tile") +
              " of " + grouped(report.tiles) + " stored, " + grouped(report.samples_examined) + " distances computed");
  const double total = load_seconds + report.seconds.prepare + report.seconds.compute + write_seconds;
  talk.say(output.path().string() + ": " + bytes_text(written) + " in " + seconds_text(total) + " (load " +
           seconds_text(load_seconds) + ", compute " + seconds_text(report.seconds.prepare + report.seconds.compute) +
           ", write " + seconds_text(write_seconds) + ")");
  if (!talk.json()) return;
  Json json = description(loaded, choice);
  json["mesh"]["skipped"] = report.skipped;
  json["mesh"]["hash"] = hash_text(computed.field.provenance.mesh_hash);
  json["samples"] = {{"total", report.samples}, {"examined", report.samples_examined}, {"band", report.samples_band}};
  json["tiles"] = {{"total", report.tiles}, {"stored", report.tiles_stored}};
  json["seconds"] = {{"load", load_seconds},
                     {"prepare", report.seconds.prepare},
                     {"compute", report.seconds.compute},
                     {"write", write_seconds}};
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["method"] = report.method;
  json["device"] = report.backend;
  json["device_name"] = report.device;
  json["threads"] = report.threads;
  json["output"] = {{"file", output.path().string()}, {"bytes", written}};
  print(json);
}

}  // namespace

void add_compute(CLI::App& program) {
  auto* verb = add_verb(program, "compute", "compute the distance field of a mesh", kExamples);
  const auto command = std::make_shared<Command>();
  command->add_to(*verb);
  verb->callback([command] { command->run(); });
}

}  // namespace difi::cli
