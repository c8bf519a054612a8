// SPDX-License-Identifier: Apache-2.0
// standoff points: exact answers at the points of a file, a block at a time.
#include <algorithm>
#include <chrono>
#include <memory>
#include <sstream>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/point_answers.h"
#include "cli/sign_options.h"
#include "cli/spinner.h"
#include "cli/text.h"
#include "cli/usage.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

constexpr const char* kPointsExamples =
    R"(  standoff points bunny.obj points.csv                         a distance for each line, on stdout
  standoff points part.stl cloud.ply -o near.ply --sign auto   negative inside; the cloud with answers
  standoff points part.stl points.npy -o near.npz --with closest,triangle
  producer | standoff points part.query - -o near.csv              a query that standoff build prepared
)";

struct PointsCommand {
  MeshInput mesh;
  std::string points;
  FileOutput output;
  MeshQueryOptions options;
  Thickness shell{0};
  AskedAnswers asked;
  InvalidPoints invalid = InvalidPoints::reject;
  bool skip_invalid = false;
  Console console;

  void add_to(CLI::App& verb);
  void run();

 private:
  bool prepared_before() const { return kind_of(mesh.name()) == FileKind::query; }
  bool to_stdout() const { return !output.given() || output.path() == "-"; }
  void check();
  MeshQuery query() const;
};

void parse_asked(const std::string& option, const std::string& text, AskedAnswers& asked) {
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    bool* const all[] = {&asked.closest, &asked.triangle, &asked.barycentric,
                         &asked.feature, &asked.gradient, &asked.winding};
    *all[parse_choice(option, word, {"closest", "triangle", "barycentric", "feature", "gradient", "winding"})] = true;
  }
}

void PointsCommand::add_to(CLI::App& verb) {
  mesh.add_query_to(verb);
  verb.add_option("POINTS", points, "a file of points (.csv, .ply, .npy or .npz),\nor - for CSV from standard input")
      ->required();
  output.add_to(verb, "ANSWERS", "the answers: .csv, .ply, .npy or .npz\n(default: CSV on standard output)");
  add_parsed(
      verb,
      {"--with", "WHAT",
       "also answer, with commas between: closest, triangle,\nbarycentric, feature, gradient, winding", "Question"},
      [this](S o, S t) { parse_asked(o, t, asked); });
  verb.add_flag("--skip-invalid", skip_invalid,
                "answer nan for points that are not finite or too far out;\nthey are an error otherwise")
      ->group("Question");
  mesh.add_scale_to(verb);
  add_sign(verb, options.sign, shell);
  add_device(verb, "Work", options.execution.backend, options.execution.device);
  add_threads(verb, "Work", options.execution.threads);
  console.add_to(verb, Console::kMessages | Console::kJson | Console::kProgress);
}

// Tells before any work what is wrong.
void PointsCommand::check() {
  check_input(mesh.name());
  if (prepared_before() && (mesh.scaled() || is_given(options.sign)))
    throw Error(ErrorCode::usage,
                mesh.name() + ": a query has its scale and sign; give these options to standoff build");
  if (points != "-") check_input(points);
  if (shell.in_samples)
    throw Error(ErrorCode::usage, "--sign shell: points have no samples; give its thickness in world units");
  options.sign.shell = shell.value;
  if (asked.winding && options.sign.method == SignMethod::none && !prepared_before())
    throw Error(ErrorCode::usage, "--with winding is for signs by winding numbers; give --sign winding too");
  if (skip_invalid) invalid = InvalidPoints::mark;
  if (to_stdout()) return;
  output.check({{"csv", "", false, true, false},
                {"ply", "", false, true, false},
                {"npy", "", false, true, false},
                {"npz", "", false, true, false}});
  output.check_differs(mesh.name());
  output.check_differs(points == "-" ? "/dev/stdin" : points);
}

MeshQuery PointsCommand::query() const {
  if (prepared_before())
    return with_spinner(console, "reading " + mesh.name(), [&] { return read_query(mesh.name()); });
  const Mesh loaded = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read(); });
  console.say(mesh_line(mesh.name(), loaded));
  try {
    return with_spinner(console, "preparing " + mesh.name(), [&] {
      return MeshQuery(loaded, {options.sign, {.threads = options.execution.threads}});
    });
  } catch (const Error& error) {
    throw Error(error.code(), mesh.name() + ": " + error.what(), error.details());
  }
}

void PointsCommand::run() {
  check();
  // The points' file first: what is wrong with its beginning is said before the mesh is prepared.
  const auto reader = open_points(points, invalid);
  auto start = std::chrono::steady_clock::now();
  const MeshQuery prepared = query();
  const double build_seconds = seconds_since(start);
  start = std::chrono::steady_clock::now();
  const std::string file = to_stdout() ? "" : output.path().string();
  const auto writer = !to_stdout() ? create_answers(output.path(), asked, output.existing())
                                   : csv_answers(
                                         [this](std::string_view text) {
                                           if (!console.json()) print(std::string(text));
                                         },
                                         asked);
  const PointCounts counts = answer_points(prepared, *reader, *writer, asked, options.execution, console.progress());
  const double seconds = seconds_since(start);
  const bool has_sign = prepared.sign().method != SignMethod::none;
  if (counts.points == 0) warn_of_none(console, points, "point");
  console.say((file.empty() ? "" : file + ": ") + counted(counts.points, "point") +
              (has_sign ? ", " + grouped(counts.inside) + " of them inside" : "") +
              (skip_invalid ? ", " + grouped(counts.invalid) + " invalid" : "") + "; in " + seconds_text(seconds));
  if (!console.json()) return;
  Json json = json_answer("points");
  json["points"] = counts.points;
  json["invalid"] = counts.invalid;
  if (has_sign) {
    json["inside"] = counts.inside;
    add_sign_report(json, prepared.sign());
  }
  json["distance"] = {{"least", json_number(counts.least)}, {"largest", json_number(counts.largest)}};
  json["memory_bytes"] = prepared.memory_bytes();
  json["seconds"] = {{"prepare", build_seconds}, {"points", seconds}};
  if (to_stdout()) return print(json);
  json["output"] = json_output(output.path());
  print(json, output.path());
}

}  // namespace

void add_points(CLI::App& program) {
  auto* verb =
      add_verb(program, "points", "exact distances and closest points at the points of a file", kPointsExamples);
  const auto command = std::make_shared<PointsCommand>();
  command->add_to(*verb);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
