// SPDX-License-Identifier: Apache-2.0
// standoff sweep: when does a moving body first touch a resting one?
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "cli/batch_query.h"
#include "cli/console.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/parse.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

constexpr const char* kSweepExamples = R"(  standoff sweep maze.stl fly.stl --from 3,1,2 --to 9,1,2
  standoff sweep a.stl b.stl --from 0,0,5 --to 0,0,0,0,0,1,90 --json   turning as it goes
  standoff sweep bolt.stl nut.stl --screw 0,0,0,0,0,1,1170,6.5         3.25 turns about z, 2 units a turn
  standoff sweep maze.stl fly.stl --path way.csv                       from pose to pose, one on each line
  standoff sweep maze.stl fly.stl --motions motions.csv -o hits.csv    from and to on each line
)";

struct SweepCommand {
  PairInput bodies;
  RigidMotion motion;
  SweepOptions options;
  BatchQuery batch;
  bool has_end = false;
  std::vector<double> screw;  ///< a point, an axis, degrees and the way along the axis
  std::optional<std::string> path;
  Console console;

  void run();
  std::vector<RigidMotion> motions() const;
  void run_batch();
};

void SweepCommand::run_batch() {
  batch.check({bodies.name_a(), bodies.name_b()});
  const std::vector<RigidMotion> motions = read_motions(batch.file(), motion.center);
  const Body a = bodies.read_a(console), b = bodies.read_b(console);
  const auto found = batch.answers(
      console, motions.size(), [&] { return sweep_all(a, bodies.pose_a(), b, motions, options, batch.execution()); });
  Answers answers{Table("motion,result,time,x,y,z,nx,ny,nz,triangle_a,triangle_b"), {}};
  std::int64_t hits = 0, unfinished = 0;
  for (std::size_t n = 0; n < found.size(); ++n) {
    const SweepResult& it = found[n];
    hits += it.hit;
    unfinished += !it.finished;
    answers.table.cell(static_cast<std::int64_t>(n));
    answers.table.cell(it.hit ? "hit" : it.finished ? "free" : "unfinished");
    answers.table.cell(it.time);
    answers.table.point(it.hit, it.point);
    answers.table.point(it.hit, it.normal);
    answers.table.triangle(it.triangle_a);
    answers.table.triangle(it.triangle_b);
    answers.table.end_row();
  }
  answers.counts = {{"free", static_cast<std::int64_t>(found.size()) - hits - unfinished}, {"hit", hits}};
  if (options.max_steps != 0) answers.counts.push_back({"unfinished", unfinished});
  batch.deliver("sweep", answers, console);
}

// The motions that B makes one after the other.
std::vector<RigidMotion> SweepCommand::motions() const {
  if (path) {
    const std::vector<Pose> poses = read_poses(*path);
    if (poses.size() < 2)
      throw Error(ErrorCode::input, *path + ": " + std::to_string(poses.size()) +
                                        " poses; give the two or more that B goes through, one on each line");
    std::vector<RigidMotion> found;
    for (std::size_t n = 1; n < poses.size(); ++n) found.push_back({poses[n - 1], poses[n], motion.center});
    return found;
  }
  if (screw.empty()) return {motion};
  return {screw_motion(motion.start, {screw[0], screw[1], screw[2]}, {screw[3], screw[4], screw[5]},
                       screw[6] * std::numbers::pi / 180, screw[7])};
}

void SweepCommand::run() {
  bodies.check();
  if (batch.given()) return run_batch();
  if (!has_end && screw.empty() && !path)
    throw Error(ErrorCode::usage, "sweep: no --to given, where B ends; or give --screw, --path or --motions");
  const std::vector<RigidMotion> way = motions();
  const Body a = bodies.read_a(console), b = bodies.read_b(console);
  const auto [in_motion, found] = sweep_path(a, bodies.pose_a(), b, way, options);
  const std::string of_motion = path ? " of 1 in motion " + std::to_string(in_motion) : " of 1";
  if (console.json()) {
    Json json = json_answer("sweep");
    json["hit"] = found.finished ? Json(found.hit) : Json();
    if (path) json["motion"] = in_motion;
    json["time"] = found.time;
    json["point"] = found.hit ? json_point(found.point) : Json();
    json["normal"] = found.hit ? json_point(found.normal) : Json();
    json["triangle_a"] = json_triangle(found.triangle_a);
    json["triangle_b"] = json_triangle(found.triangle_b);
    return print(json);
  }
  if (!found.finished)
    return print("free until time " + exact_number(found.time) + of_motion + "; --max-steps ended the sweep there\n");
  if (!found.hit) return print(std::string("free during the whole motion\n"));
  print("hit at time " + exact_number(found.time) + of_motion + ", at " + point_text(found.point) + ": triangle " +
        std::to_string(found.triangle_a) + " of A and " + std::to_string(found.triangle_b) + " of B\n");
}

}  // namespace

void add_sweep(CLI::App& program) {
  auto* verb = add_verb(program, "sweep", "when a moving body first touches a resting one", kSweepExamples);
  const auto command = std::make_shared<SweepCommand>();
  command->bodies.add_to(*verb);
  RigidMotion& motion = command->motion;
  auto* from =
      add_pose(*verb, "--from", "where B starts: x,y,z; x,y,z,ax,ay,az,degrees; or a 3x4 matrix", motion.start);
  auto* to = add_pose(*verb, "--to", "where B ends; it turns by the shorter rotation", motion.end);
  auto* screw =
      add_parsed(*verb,
                 {"--screw", "X,Y,Z,AX,AY,AZ,DEGREES,D",
                  "instead of --to: B turns about the axis AX,AY,AZ through the\npoint X,Y,Z of the world, any "
                  "number of turns, and moves by\nD along it (default 0)",
                  "Place"},
                 [command = command.get()](S o, S t) { command->screw = parse_screw(o, t); });
  auto* path =
      add_parsed(*verb,
                 {"--path", "FILE",
                  "the poses that B goes through, two or more: a file with a pose on\neach line, - for standard "
                  "input",
                  "Place"},
                 [command = command.get()](S o, S t) {
                   if (t.empty())
                     throw Error(ErrorCode::usage, o + " '': give the name of a file, or - for standard input");
                   command->path = t;
                 });
  auto* center =
      add_parsed(*verb, {"--center", "X,Y,Z", "the point of B that moves on a straight line (default 0,0,0)", "Place"},
                 [&motion](S o, S t) { motion.center = parse_point(o, t); });
  add_parsed(*verb, {"--tolerance", "D", "as near as this is a hit (default: 3e-5 of the smaller body)", "Question"},
             [command = command.get()](S o, S t) { command->options.tolerance = parse_positive(o, t, kMaxMargin); });
  add_parsed(*verb,
             {"--max-steps", "N", "give up after so many steps, of about 1 us each (default: no limit)", "Question"},
             [command = command.get()](S o, S t) {
               command->options.max_steps = parse_count(o, t, 0, std::numeric_limits<std::int64_t>::max());
             });
  command->batch
      .add_to(*verb, "--motions",
              "where B starts and ends, many times: a file with the\nnumbers of --from and --to on each line, - for "
              "standard\ninput",
              "motion")
      ->excludes(from)
      ->excludes(to)
      ->excludes(screw)
      ->excludes(path);
  screw->excludes(to)->excludes(center)->excludes(path);
  path->excludes(from)->excludes(to);
  command->batch.add_device_to(*verb);
  command->console.add_to(*verb, Console::kMessages | Console::kJson);
  verb->callback([command, to] {
    command->has_end = to->count() > 0;
    command->run();
  });
}

}  // namespace standoff::cli
