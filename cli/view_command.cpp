// SPDX-License-Identifier: Apache-2.0
// standoff view: meshes and fields as a page for a browser.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "cli/view_server.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/page.h"

namespace standoff::cli {
namespace {

constexpr const char* kViewExamples =
    R"(  standoff view bunny.obj -o bunny.html                the mesh and its field, computed now
  standoff view bunny.obj bunny.vti -o bunny.html      the mesh and a field that you have
  standoff view bunny.obj old.vti new.vti -o both.html two fields side by side, and their difference
  standoff view scene:factory -r 256 -o factory.html
)";

// This is enough to look at, and small enough for a mail.
constexpr std::int64_t kSamples = 128;

// Returns the name without its folders, which mean nothing to those who get the page.
std::string shown_name(const std::string& file) {
  return file.starts_with("scene:") ? file.substr(6) : std::filesystem::path(file).filename().string();
}

using Subject = ViewSubject;

struct ViewCommand {
  std::vector<std::string> files;
  FileOutput output;
  GridOptions grid{kSamples};
  ComputeOptions compute_options;
  FieldArgument field_argument;
  PageOptions page;
  bool no_field = false;
  ServeOptions server;
  Console console;

  void add_to(CLI::App& verb);
  void run();

 private:
  Subject read();
  void compute_field(Subject& subject);
  GridChoice choose_grid(const Mesh& mesh) const;
  void check_options() const;
  void serve(Subject subject);
};

void ViewCommand::add_to(CLI::App& verb) {
  verb.add_option("FILES", files,
                  "meshes (" + extensions(mesh_formats(), false) + "),\nscene:NAME[:TRIANGLES], and fields (" +
                      extensions(field_formats(), false) + ")")
      ->required();
  output.add_to(verb, "PAGE",
                "write the page, a single .html file; without it, the program\nserves the page and computes what you "
                "change there");
  const auto add = [&verb](const char* name, const char* value, const char* help, auto set) {
    return add_parsed(verb, {name, value, help, "Page"}, set);
  };
  add("--title", "TEXT", "the page's title (default: the names of the files)", [this](S, S t) { page.title = t; });
  add("--up", "A", kUpHelp, [this](S o, S t) { page.up = parse_up(o, t); });
  add("--length-unit", "NAME", "what the legend calls the unit of lengths, such as mm",
      [this](S, S t) { page.unit = t; });
  add("--most-samples", "N", "thin out fields that store more samples (default 16777216)",
      [this](S o, S t) { page.most_samples = parse_count(o, t, 512, std::int64_t{1} << 27); });
  add("--most-triangles", "N", "simplify meshes that have more triangles (default 5000000)",
      [this](S o, S t) { page.most_triangles = parse_count(o, t, 1000, 50'000'000); });
  verb.add_flag("--no-field", no_field, "compute no field for a mesh that comes without one")->group("Page");
  grid.add_to(verb);
  add_sign_to(
      verb, takes_no_shell,
      "how inside is decided, as in standoff compute: " + sign_names(takes_no_shell, compute_options.sign.method),
      compute_options.sign);
  verb.add_flag("--nearest", compute_options.nearest, "keep which triangle is nearest to each sample")->group("Sign");
  add_device(verb, "Work", compute_options.execution.backend, compute_options.execution.device);
  add_threads(verb, "Work", compute_options.execution.threads);
  server.add_to(verb);
  field_argument.add_to(verb, "each field");
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
}

Subject ViewCommand::read() {
  Subject subject;
  for (const std::string& name : files) {
    if (kind_of(name) == FileKind::field) {
      subject.fields.push_back(field_argument.read_fitting(name, console));
      subject.field_names.push_back(shown_name(name));
      continue;
    }
    MeshInput input;
    input.set_name(name);
    auto [mesh, read] = with_spinner(console, "reading " + name, [&] { return input.read_with_report(); });
    console.say(mesh_line(name, mesh));
    subject.meshes.push_back({shown_name(name), std::move(mesh), read.up});
  }
  return subject;
}

GridChoice ViewCommand::choose_grid(const Mesh& mesh) const {
  validate(mesh);
  const Box box = bounds(mesh);
  if (const double far = std::max(max_norm(box.min), max_norm(box.max)); far > kMaxCoordinate)
    throw Error(ErrorCode::input, files.front() + ": a coordinate of " + number(far) +
                                      ", too far out for a grid; repair the mesh, or show it alone with --no-field");
  if (const std::string doubt = grid.doubt_of_thickness(box); !doubt.empty()) console.warn(doubt);
  return grid.choose(box);
}

// Computes the field of the first mesh alone: several fields would be drawn over each other.
void ViewCommand::compute_field(Subject& subject) {
  const auto& [name, mesh, up] = subject.meshes.front();
  const GridChoice choice = choose_grid(mesh);
  compute_options.memory_limit = field_argument.memory_limit();
  compute_options.up = up;
  ComputeResult computed = naming_mesh(files.front(), "view", [&] {
    return with_progress(console, compute_options.progress, [&] {
      return compute(subject.meshes.front().mesh, choice.grid, choice.thickness, compute_options);
    });
  });
  console.say("field: " + size_text(choice.grid.size) + " samples");
  say_sign(console, computed.report.sign);
  subject.fields.push_back(std::move(computed.field));
  subject.field_names.push_back("field of " + name);
}

void ViewCommand::serve(Subject subject) {
  std::optional<view::LiveSettings> live;
  if (subject.fields.empty() && !no_field) {
    const GridChoice choice = choose_grid(subject.meshes.front().mesh);
    const Size3 size = choice.grid.size;
    live = {std::max({size.x, size.y, size.z}), choice.thickness, false, compute_options.sign,
            compute_options.execution};
  }
  ViewServer view(std::move(subject), page, live, field_argument.memory_limit(), console);
  server.serve(console, view.watch(), [&](auto&&... asked) { view.answer(asked...); });
}

// Refuses options that would have no effect. Errors: usage.
void ViewCommand::check_options() const {
  if (output.given()) return server.check_unused("with -o nothing is served");
  const char* const option = grid.shape_given()        ? "--size, --spacing, --bounds and --padding"
                             : compute_options.nearest ? "--nearest"
                             : console.json()          ? "--json"
                                                       : nullptr;
  if (option)
    throw Error(ErrorCode::usage,
                std::string(option) + ": only for pages that are written; give -o PAGE, or leave it out");
}

void ViewCommand::run() {
  for (const std::string& name : files) check_input(name);
  check_options();
  if (output.given()) {
    output.check({{"html", "a page", false, true}});
    for (const std::string& name : files) output.check_differs(name);
  }
  if (page.title.empty())
    for (const std::string& name : files) page.title += (page.title.empty() ? "" : ", ") + shown_name(name);
  Subject subject = read();
  if (!output.given()) return serve(std::move(subject));
  if (subject.fields.empty() && !no_field) compute_field(subject);

  const std::vector<PageMesh> meshes = subject.page_meshes();
  const std::vector<PageField> fields = subject.page_fields();
  std::vector<PageItem> held;
  with_spinner(console, "writing " + output.path().string(),
               [&] { write_page(output.path(), meshes, fields, page, &held, output.existing()); });
  const Json written = json_output(output.path());
  console.say(output.path().string() + ": " + bytes_text(written["bytes"].get<std::int64_t>()));
  if (!console.json()) return;
  Json json = json_answer("view");
  json["holds"] = Json::array();
  for (const PageItem& item : held) {
    Json one = {{"name", item.name}, {"bytes", item.bytes}, {"error", json_number(item.error)}};
    if (item.every > 0)
      one["every"] = item.every;
    else
      one.update({{"triangles", item.triangles}, {"proxy_triangles", item.proxy_triangles}});
    json["holds"].push_back(one);
  }
  json["output"] = written;
  print(json, output.path());
}

}  // namespace

void add_view(CLI::App& program) {
  add_command<ViewCommand>(program, "view", "show meshes and fields in a browser", kViewExamples);
}

}  // namespace standoff::cli
