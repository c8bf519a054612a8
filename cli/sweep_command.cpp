// difi sweep: when does a moving body meet a resting one?
#include <memory>

#include "cli/body_input.h"
#include "cli/commands.h"
#include "cli/option.h"
#include "cli/parse.h"
#include "cli/talk.h"
#include "cli/text.h"
#include "cli/usage.h"

namespace difi::cli {
namespace {

constexpr const char* kExamples = R"(  difi sweep maze.stl fly.stl --from 3,1,2 --to 9,1,2
  difi sweep a.stl b.stl --from 0,0,5 --to 0,0,0,0,0,1,90 --json   turning as it goes
)";

struct Command {
  PairInput bodies;
  Motion motion;
  SweepOptions options;
  Talk talk;

  void run() const;
};

void Command::run() const {
  const CollisionModel a = bodies.read_a(talk), b = bodies.read_b(talk);
  const Swept found = sweep(a, bodies.pose_a(), b, motion, options);
  if (talk.json())
    return print(Json{{"hit", found.hit},
                      {"time", found.time},
                      {"point", found.hit ? json_point(found.point) : Json()},
                      {"normal", found.hit ? json_point(found.normal) : Json()},
                      {"triangle_a", json_triangle(found.triangle_a)},
                      {"triangle_b", json_triangle(found.triangle_b)}});
  if (!found.hit) return print(std::string("free all the way\n"));
  print("hit at time " + exact_number(found.time) + " of 1, at " + point_text(found.point) + ": triangle " +
        std::to_string(found.triangle_a) + " of A and " + std::to_string(found.triangle_b) + " of B\n");
}

}  // namespace

void add_sweep(CLI::App& program) {
  auto* verb = add_verb(program, "sweep", "when a moving body first meets a resting one", kExamples);
  const auto command = std::make_shared<Command>();
  command->bodies.add_to(*verb);
  Motion& motion = command->motion;
  add_pose(*verb, "--from", "where B starts: x,y,z; x,y,z,ax,ay,az,degrees; or a 3x4 matrix", motion.from);
  add_pose(*verb, "--to", "where B ends; it turns the shorter way round", motion.to)->required();
  using S = const std::string&;
  add_parsed(*verb, {"--center", "X,Y,Z", "the point of B that goes straight (default 0,0,0)", "Place"},
             [&motion](S o, S t) { motion.center = parse_point(o, t); });
  add_parsed(*verb, {"--tolerance", "D", "as near as this is a hit (default 1e-4)", "Question"},
             [command = command.get()](S o, S t) { command->options.tolerance = parse_positive(o, t); });
  command->talk.add_to(*verb, Talk::kMessages | Talk::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace difi::cli
