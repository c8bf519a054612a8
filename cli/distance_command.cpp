// difi distance: how near are two bodies?
#include <cmath>
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

constexpr const char* kExamples = R"(  difi distance a.stl b.stl --pose 0,0,5
  difi distance a.stl b.stl --tolerance 0.01 --json        faster, and within 0.01
)";

struct Command {
  PairInput bodies;
  Pose pose;
  DistanceOptions options;
  Talk talk;

  void run() const;
};

void Command::run() const {
  const CollisionModel a = bodies.read_a(talk), b = bodies.read_b(talk);
  const Distance found = distance(a, bodies.pose_a(), b, pose, options);
  if (talk.json()) {
    const bool any = std::isfinite(found.upper);
    return print(Json{{"lower", json_number(found.lower)},
                      {"upper", json_number(found.upper)},
                      {"point_a", any ? json_point(found.point_a) : Json()},
                      {"point_b", any ? json_point(found.point_b) : Json()},
                      {"triangle_a", json_triangle(found.triangle_a)},
                      {"triangle_b", json_triangle(found.triangle_b)}});
  }
  if (!std::isfinite(found.upper)) return print("at least " + exact_number(options.limit) + ", the limit\n");
  print(exact_number(found.upper) + " from " + point_text(found.point_a) + " of A to " + point_text(found.point_b) +
        " of B" + (found.lower < found.upper ? ", at least " + exact_number(found.lower) : "") + "\n");
}

}  // namespace

void add_distance(CLI::App& program) {
  auto* verb = add_verb(program, "distance", "the least distance of two bodies", kExamples);
  const auto command = std::make_shared<Command>();
  command->bodies.add_to(*verb);
  add_pose(*verb, "--pose", "where B is: x,y,z; x,y,z,ax,ay,az,degrees; or a 3x4 matrix", command->pose);
  using S = const std::string&;
  DistanceOptions& options = command->options;
  add_parsed(*verb, {"--tolerance", "D", "how wrong it may be (default 0)", "Question"},
             [&options](S o, S t) { options.tolerance = parse_not_negative(o, t); });
  add_parsed(*verb, {"--limit", "D", "look no farther than this", "Question"},
             [&options](S o, S t) { options.limit = parse_not_negative(o, t); });
  command->talk.add_to(*verb, Talk::kMessages | Talk::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace difi::cli
