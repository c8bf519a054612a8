// SPDX-License-Identifier: Apache-2.0
// standoff points: exact answers at the points of a file. Points are read, answered and written a block at a time: all
// three at once, in memory that does not grow.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <future>
#include <limits>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "io/points/answers.h"
#include "io/points/points.h"
#include "standoff/error.h"
#include "standoff/execution.h"
#include "standoff/points.h"
#include "standoff/progress.h"

namespace standoff::cli {
namespace {

struct PointCounts {
  std::int64_t points = 0;   ///< all
  std::int64_t invalid = 0;  ///< of which were marked as invalid
  std::int64_t inside = 0;   ///< of negative distance
  double least = 0;          ///< distance; the smallest and the largest, with sign
  double largest = 0;
};

// Points in one block share work. Blocks are smaller where answers take more memory.
std::size_t block_size(const AskedAnswers& asked) { return std::size_t{1} << (asked.needs_closest() ? 19 : 20); }
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class Answering {
 public:
  Answering(const MeshQuery& query, const AskedAnswers& asked, const Execution& execution)
      : query_(query), asked_(asked), execution_(execution) {}

  // Fills in the answers at the block's points.
  void answer(AnswerBlock& block, const ProgressCallback& progress) {
    const std::vector<std::size_t> invalid = take_out_invalid(block.points);
    const std::size_t count = block.size();
    if (asked_.needs_closest()) {
      block.closest.resize(count);
      query_.closest(block.points, block.closest, {.execution = execution_, .progress = progress});
    } else {
      block.distances.resize(count);
      query_.distances(block.points, block.distances, {.execution = execution_, .progress = progress});
    }
    if (asked_.gradient)
      for (std::size_t n = 0; n < count; ++n)
        block.gradients.push_back(query_.gradient(block.points[n], block.closest[n]));
    if (asked_.winding) {
      block.windings.resize(count);
      query_.winding_numbers(block.points, block.windings,
                             {.execution = {.threads = execution_.threads}, .progress = progress});  // the CPU's
    }
    for (const std::size_t n : invalid) put_nothing(block, n);
    count_block(block, static_cast<std::int64_t>(invalid.size()));
  }

  const PointCounts& counts() const { return counts_; }

 private:
  // Returns which points are NaN, and replaces each by a corner of the mesh, because the query knows no invalid points.
  std::vector<std::size_t> take_out_invalid(std::vector<Vec3>& points) const {
    std::vector<std::size_t> invalid;
    for (std::size_t n = 0; n < points.size(); ++n)
      if (std::isnan(points[n].x)) {
        invalid.push_back(n);
        points[n] = query_.mesh().corner(0, 0);
      }
    return invalid;
  }

  static void put_nothing(AnswerBlock& block, std::size_t n) {
    const Vec3 nothing{kNan, kNan, kNan};
    block.points[n] = nothing;
    if (!block.distances.empty()) block.distances[n] = kNan;
    if (!block.closest.empty())
      block.closest[n] = {
          .distance = kNan, .point = nothing, .triangle = kNoTriangle, .barycentric = {kNan, kNan, kNan}};
    if (!block.gradients.empty()) block.gradients[n] = nothing;
    if (!block.windings.empty()) block.windings[n] = kNan;
  }

  void count_block(const AnswerBlock& block, std::int64_t invalid) {
    for (std::size_t n = 0; n < block.size(); ++n) {
      const double distance = asked_.needs_closest() ? block.closest[n].distance : block.distances[n];
      counts_.inside += distance < 0;
      counts_.least = std::fmin(counts_.least, distance);
      counts_.largest = std::fmax(counts_.largest, distance);
    }
    counts_.points += static_cast<std::int64_t>(block.size());
    counts_.invalid += invalid;
  }

  const MeshQuery& query_;
  const AskedAnswers& asked_;
  const Execution& execution_;
  PointCounts counts_{.least = kNan, .largest = kNan};
};

std::vector<Vec3> next_points(PointReader& reader, const AskedAnswers& asked) {
  std::vector<Vec3> points(block_size(asked));
  points.resize(reader.read(points));
  return points;
}

// Runs `work` on a thread of its own if one can be started, else when its result is taken.
template <class Work>
auto beside(Work work) {
  return std::async(std::launch::async | std::launch::deferred, std::move(work));
}

// Answers all points. Errors: those of the reader, the query and the writer, which is not finished then.
PointCounts answer_points(const MeshQuery& query, PointReader& reader, AnswerWriter& writer, const AskedAnswers& asked,
                          const Execution& execution, const ProgressCallback& progress) {
  Answering answering(query, asked, execution);
  // At most three blocks: one is read, one is answered, one is written.
  AnswerBlock written;
  std::future<std::vector<Vec3>> reading = beside([&] { return next_points(reader, asked); });
  std::future<void> writing;
  for (;;) {
    AnswerBlock block;
    block.points = reading.get();
    const double before = reader.fraction();
    if (block.points.empty()) break;
    if (progress && !progress({"points", before})) throw Error(ErrorCode::interrupted, "interrupted");
    reading = beside([&] { return next_points(reader, asked); });
    answering.answer(block, {});
    if (writing.valid()) writing.get();
    written = std::move(block);
    writing = beside([&] { writer.write(written); });
  }
  if (writing.valid()) writing.get();
  writer.finish();
  return answering.counts();
}

constexpr const char* kPointsExamples =
    R"(  standoff points bunny.obj points.csv                         a distance for each line, on stdout
  standoff points part.stl cloud.ply -o near.ply --sign none   without a sign; the cloud with answers
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
  bool skip_invalid = false, sign_given = false;
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
    bool* const all[] = {&asked.point,   &asked.closest,  &asked.triangle, &asked.barycentric,
                         &asked.feature, &asked.gradient, &asked.winding};
    *all[parse_choice(option, word,
                      {"point", "closest", "triangle", "barycentric", "feature", "gradient", "winding"})] = true;
  }
}

void PointsCommand::add_to(CLI::App& verb) {
  mesh.add_query_to(verb);
  verb.add_option("POINTS", points, "a file of points (.csv, .ply, .npy or .npz),\nor - for CSV from standard input")
      ->required();
  output.add_to(verb, "ANSWERS",
                "the answers: " + extensions(answer_formats(), true) + "\n(default: CSV on standard output)");
  add_parsed(verb,
             {"--with", "WHAT",
              "also answer, with commas between: point (as given),\nclosest, triangle, barycentric, feature, gradient, "
              "winding",
              "Question"},
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

// Checks the arguments before any work.
void PointsCommand::check() {
  check_input(mesh.name());
  if (prepared_before() && (mesh.scaled() || sign_given))
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
  output.check(answer_formats());
  output.check_differs(mesh.name());
  output.check_differs(points == "-" ? "/dev/stdin" : points);
}

MeshQuery PointsCommand::query() const {
  if (prepared_before())
    return with_spinner(console, "reading " + mesh.name(), [&] { return MeshQuery::load(mesh.name()); });
  const Mesh loaded = with_spinner(console, "reading " + mesh.name(), [&] { return mesh.read(); });
  console.say(mesh_line(mesh.name(), loaded));
  return naming_mesh(mesh.name(), "points", [&] {
    return with_spinner(console, "preparing " + mesh.name(), [&] {
      return MeshQuery(loaded, {options.sign, {.threads = options.execution.threads}});
    });
  });
}

void PointsCommand::run() {
  check();
  // The points' file first: what is wrong with its beginning is said before the mesh is prepared.
  const auto reader = open_points(points, invalid);
  auto start = std::chrono::steady_clock::now();
  const MeshQuery prepared = query();
  const double build_seconds = seconds_since(start);
  say_sign(console, prepared.sign());
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
  verb->callback([command, verb] {
    command->sign_given = is_sign_given(*verb);
    command->run();
  });
}

}  // namespace standoff::cli
