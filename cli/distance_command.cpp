// SPDX-License-Identifier: Apache-2.0
// standoff distance: how near are two bodies?
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "cli/batch_query.h"
#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"

namespace standoff::cli {
namespace {

constexpr const char* kDistanceExamples = R"(  standoff distance a.stl b.stl --pose 0,0,5
  standoff distance a.stl b.stl --tolerance 0.01 --json        faster, and within 0.01
  standoff distance a.stl b.stl --max-steps 100                bounds, soon
  standoff distance a.stl b.stl --poses poses.csv -o near.csv        a pose on each line, a distance for each
)";

struct DistanceCommand {
  PairInput bodies;
  Pose pose;
  DistanceOptions options;
  BatchQuery batch;
  Console console;

  // The library's limit is exclusive, the program's is inclusive.
  DistanceOptions inclusive() const {
    return {options.tolerance, std::nextafter(options.limit, std::numeric_limits<double>::infinity()),
            options.max_steps};
  }
  double lower(const DistanceResult& found) const { return std::min(found.lower, options.limit); }
  void run();
  void run_batch();
};

void DistanceCommand::run_batch() {
  batch.check({bodies.name_a(), bodies.name_b()});
  const std::vector<Pose> poses = read_poses(batch.file());
  const Body a = bodies.read_a(console), b = bodies.read_b(console);
  const auto found = batch.answers(console, poses.size(), [&] {
    return distance_all(a, bodies.pose_a(), b, poses, inclusive(), batch.execution());
  });
  const bool may_end_early = options.max_steps != 0;
  Answers answers{Table(may_end_early ? "pose,lower,upper,ax,ay,az,bx,by,bz,triangle_a,triangle_b,finished"
                                      : "pose,lower,upper,ax,ay,az,bx,by,bz,triangle_a,triangle_b"),
                  {}};
  std::int64_t touching = 0, beyond = 0, unfinished = 0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const DistanceResult& it = found[n];
    const bool any = std::isfinite(it.upper);
    touching += it.upper == 0, beyond += !any && it.finished, unfinished += !it.finished;
    answers.table.cell(static_cast<std::int64_t>(n));
    answers.table.cell(lower(it));
    answers.table.cell(it.upper);
    answers.table.point(any, it.point_a);
    answers.table.point(any, it.point_b);
    answers.table.triangle(it.triangle_a);
    answers.table.triangle(it.triangle_b);
    if (may_end_early) answers.table.cell(std::int64_t{it.finished});
    answers.table.end_row();
  }
  answers.counts = {{"touching", touching}, {"beyond_limit", beyond}};
  if (may_end_early) answers.counts.push_back({"unfinished", unfinished});
  batch.deliver("distance", answers, console);
}

void DistanceCommand::run() {
  bodies.check();
  if (batch.given()) return run_batch();
  const Body a = bodies.read_a(console), b = bodies.read_b(console);
  const DistanceResult found = distance(a, bodies.pose_a(), b, pose, inclusive());
  if (console.json()) {
    const bool any = std::isfinite(found.upper);
    Json json = json_answer("distance");
    json["lower"] = json_number(lower(found));
    json["upper"] = json_number(found.upper);
    json["point_a"] = any ? json_point(found.point_a) : Json();
    json["point_b"] = any ? json_point(found.point_b) : Json();
    json["triangle_a"] = json_triangle(found.triangle_a);
    json["triangle_b"] = json_triangle(found.triangle_b);
    json["finished"] = found.finished;
    return print(json);
  }
  if (!found.finished)
    return print("from " + exact_number(lower(found)) +
                 (std::isfinite(found.upper) ? " to " + exact_number(found.upper) : " upwards") +
                 "; --max-steps ended the search there\n");
  if (!std::isfinite(found.upper)) return print("more than " + exact_number(options.limit) + ", the limit\n");
  print(exact_number(found.upper) + " from " + point_text(found.point_a) + " of A to " + point_text(found.point_b) +
        " of B" + (found.lower < found.upper ? ", at least " + exact_number(found.lower) : "") + "\n");
}

}  // namespace

void add_distance(CLI::App& program) {
  auto* verb = add_verb(program, "distance", "the least distance of two bodies", kDistanceExamples);
  const auto command = std::make_shared<DistanceCommand>();
  command->bodies.add_to(*verb);
  auto* pose = add_pose(*verb, "--pose", "where B is: x,y,z; x,y,z,ax,ay,az,degrees; or a 3x4 matrix", command->pose);
  DistanceOptions& options = command->options;
  add_parsed(*verb, {"--tolerance", "D", "how wrong it may be (default 0)", "Question"},
             [&options](S o, S t) { options.tolerance = parse_not_negative(o, t); });
  add_parsed(*verb, {"--limit", "D", "look no farther than this", "Question"},
             [&options](S o, S t) { options.limit = parse_not_negative(o, t); });
  add_parsed(
      *verb, {"--max-steps", "N", "give up after so many steps, with bounds (default: no limit)", "Question"},
      [&options](S o, S t) { options.max_steps = parse_count(o, t, 0, std::numeric_limits<std::int64_t>::max()); });
  command->batch.add_to(*verb, "--poses", kPosesHelp, "pose")->excludes(pose);
  command->batch.add_device_to(*verb);
  command->console.add_to(*verb, Console::kMessages | Console::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
