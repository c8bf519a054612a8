// difi collide: do two bodies touch, and where?
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

constexpr const char* kExamples = R"(  difi collide maze.stl fly.stl --pose 3,1,2               B moved
  difi collide maze.stl fly.stl --pose 3,1,2,0,1,0,90      turned by 90 degrees about the y axis, then moved
  difi collide a.stl b.stl --margin 0.01                   nearer than 0.01 counts
  difi collide a.stl b.stl --contacts 20 --json            where they touch
)";

struct Command {
  PairInput bodies;
  Pose pose;
  double margin = 0;
  std::int64_t contacts = 0;
  bool certified = false;
  Talk talk;

  void run() const;
};

Json contact_json(const ContactPoint& contact) {
  return {{"point", json_point(contact.point)},
          {"normal", json_point(contact.normal)},
          {"depth", contact.depth},
          {"triangle_a", contact.triangle_a},
          {"triangle_b", contact.triangle_b}};
}

void Command::run() const {
  const CollisionModel a = bodies.read_a(talk), b = bodies.read_b(talk);
  const CollideMode mode = certified ? CollideMode::certified : CollideMode::exact;
  const Collided found = collide(a, bodies.pose_a(), b, pose, {.margin = margin, .mode = mode});
  const char* const word = found.contact == Contact::free ? "free" : found.hit() ? "hit" : "ambiguous";
  Contacts all;
  if (contacts > 0) all = difi::contacts(a, bodies.pose_a(), b, pose, {.most = contacts, .margin = margin});
  if (talk.json()) {
    Json json{{"result", word},
              {"triangle_a", json_triangle(found.triangle_a)},
              {"triangle_b", json_triangle(found.triangle_b)}};
    if (contacts > 0) {
      json["contacts"] = Json::array();
      for (const ContactPoint& contact : all.contacts) json["contacts"].push_back(contact_json(contact));
      json["overflow"] = all.overflow;
    }
    return print(json);
  }
  std::string text = word;
  if (found.hit() && !certified)
    text +=
        ": triangle " + std::to_string(found.triangle_a) + " of A and " + std::to_string(found.triangle_b) + " of B";
  text += '\n';
  for (const ContactPoint& contact : all.contacts)
    text += "at " + point_text(contact.point) + ", depth " + number(contact.depth) + " along " +
            point_text(contact.normal) + ": triangles " + std::to_string(contact.triangle_a) + " and " +
            std::to_string(contact.triangle_b) + "\n";
  if (all.overflow) text += "and more contacts than --contacts " + std::to_string(contacts) + " asks for\n";
  print(text);
}

}  // namespace

void add_collide(CLI::App& program) {
  auto* verb = add_verb(program, "collide", "do two bodies touch, and where", kExamples);
  const auto command = std::make_shared<Command>();
  command->bodies.add_to(*verb);
  add_pose(*verb, "--pose", "where B is: x,y,z; x,y,z,ax,ay,az,degrees; or a 3x4 matrix", command->pose);
  using S = const std::string&;
  auto* certified = verb->add_flag("--certified", command->certified,
                                   "from the fields alone: free, hit or ambiguous, no triangle is looked at");
  certified->group("Question");
  add_parsed(*verb, {"--margin", "D", "as near as this is a hit too (default 0)", "Question"},
             [command = command.get()](S o, S t) { command->margin = parse_not_negative(o, t); });
  add_parsed(*verb, {"--contacts", "N", "list up to N pairs of triangles that touch", "Question"},
             [command = command.get()](S o, S t) { command->contacts = parse_count(o, t, 1, 1'000'000'000); })
      ->excludes(certified);
  command->talk.add_to(*verb, Talk::kMessages | Talk::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace difi::cli
