// SPDX-License-Identifier: Apache-2.0
// standoff collide: do two bodies intersect, and where?
#include <array>
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

constexpr const char* kCollideExamples = R"(  standoff collide maze.stl fly.stl --pose 3,1,2               B moved
  standoff collide maze.stl fly.stl --pose 3,1,2,0,1,0,90      turned by 90 degrees about the y axis, then moved
  standoff collide a.stl b.stl --margin 0.01                   nearer than 0.01 counts
  standoff collide a.stl b.stl --contacts 20 --json            where they intersect
  standoff collide tank.stl ball.stl --containment             hit also where one is inside the other
  standoff collide maze.stl fly.stl --poses poses.csv          a pose on each line; the answers as a table
  standoff collide maze.stl fly.stl --poses - -o hits.csv --device cuda < poses.csv
)";

struct CollideCommand {
  PairInput bodies;
  Pose pose;
  double margin = 0;
  std::int64_t contacts = 0;
  bool certified = false, containment = false;
  BatchQuery batch;
  Console console;

  CollideOptions options() const {
    return {
        .margin = margin, .mode = certified ? CollideMode::certified : CollideMode::exact, .containment = containment};
  }
  void run();
  void run_batch();
  void say_what_is_open(const Body& a, const Body& b) const;
};

Json contact_json(const ContactPoint& contact) {
  return {{"point", json_point(contact.point)},
          {"normal", json_point(contact.normal)},
          {"depth", contact.depth},
          {"triangle_a", contact.triangle_a},
          {"triangle_b", contact.triangle_b}};
}

const char* word_of(Verdict contact) {
  return contact == Verdict::free ? "free" : contact == Verdict::hit ? "hit" : "ambiguous";
}

struct ContainmentWords {
  const char *word, *sentence;
};
constexpr std::array<ContainmentWords, 4> kContainmentWords{{{"none", ""},
                                                             {"b_in_a", "B is inside A"},
                                                             {"a_in_b", "A is inside B"},
                                                             {"partly", "parts of a body are inside the other one"}}};
const ContainmentWords& words_of(Containment containment) {
  return kContainmentWords[static_cast<std::size_t>(containment)];
}

// If one body is open, nothing counts as inside it.
void CollideCommand::say_what_is_open(const Body& a, const Body& b) const {
  if (containment && a.has_inside() != b.has_inside())
    console.say(std::string(a.has_inside() ? "B" : "A") +
                " is not closed and consistently oriented, so nothing counts as inside it");
}

// The table names no triangles: which of several intersecting pairs is found depends on the device.
void CollideCommand::run_batch() {
  batch.check({bodies.name_a(), bodies.name_b()});
  if (certified && batch.execution().backend != Backend::automatic && batch.execution().backend != Backend::cpu)
    throw Error(ErrorCode::usage, "--certified: comes from the CPU alone; leave --device out");
  const std::vector<Pose> poses = read_poses(batch.file());
  const Body a = bodies.read_a(console), b = bodies.read_b(console);
  say_what_is_open(a, b);
  const auto found = batch.answers(
      console, poses.size(), [&] { return collide_all(a, bodies.pose_a(), b, poses, options(), batch.execution()); });
  Answers answers{Table(containment ? "pose,result,containment" : "pose,result"), {{"free", 0}, {"hit", 0}}};
  if (certified) answers.counts.emplace_back("ambiguous", 0);
  const std::size_t verdicts = answers.counts.size();
  if (containment)
    for (const Containment kind : {Containment::b_in_a, Containment::a_in_b, Containment::partly})
      answers.counts.emplace_back(words_of(kind).word, 0);
  for (std::size_t n = 0; n < found.size(); ++n) {
    answers.table.cell(static_cast<std::int64_t>(n));
    answers.table.cell(word_of(found[n].verdict));
    if (containment) answers.table.cell(words_of(found[n].containment).word);
    answers.table.end_row();
    ++answers.counts[static_cast<std::size_t>(found[n].verdict)].second;
    if (found[n].containment != Containment::none)
      ++answers.counts[verdicts + static_cast<std::size_t>(found[n].containment) - 1].second;
  }
  batch.deliver("collide", answers, console);
}

void CollideCommand::run() {
  bodies.check();
  if (batch.given()) return run_batch();
  const Body a = bodies.read_a(console), b = bodies.read_b(console);
  say_what_is_open(a, b);
  const CollisionResult found = collide(a, bodies.pose_a(), b, pose, options());
  const char* const word = word_of(found.verdict);
  ContactResult all;
  if (contacts > 0) all = standoff::contacts(a, bodies.pose_a(), b, pose, {.most = contacts, .margin = margin});
  if (console.json()) {
    Json json = json_answer("collide");
    json["hit"] = found.verdict == Verdict::ambiguous ? Json() : Json(found.hit());
    json["triangle_a"] = json_triangle(found.triangle_a);
    json["triangle_b"] = json_triangle(found.triangle_b);
    if (containment) json["containment"] = words_of(found.containment).word;
    if (contacts > 0) {
      json["contacts"] = Json::array();
      for (const ContactPoint& contact : all.contacts) json["contacts"].push_back(contact_json(contact));
      json["overflow"] = all.overflow;
    }
    return print(json);
  }
  std::string text = word;
  if (found.containment != Containment::none)
    text += std::string(": ") + words_of(found.containment).sentence;
  else if (found.hit() && !certified)
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
  auto* verb = add_verb(program, "collide", "do two bodies intersect, and where", kCollideExamples);
  const auto command = std::make_shared<CollideCommand>();
  command->bodies.add_to(*verb);
  auto* pose = add_pose(*verb, "--pose", "where B is: x,y,z; x,y,z,ax,ay,az,degrees; or a 3x4 matrix", command->pose);
  auto* certified = verb->add_flag("--certified", command->certified,
                                   "from the fields alone: free, hit or ambiguous, no triangle is looked at");
  certified->group("Question");
  add_parsed(*verb, {"--margin", "D", "as near as this is a hit too (default 0)", "Question"},
             [command = command.get()](S o, S t) { command->margin = parse_not_negative(o, t, kMaxMargin); });
  auto* contacts =
      add_parsed(*verb, {"--contacts", "N", "list up to N pairs of triangles that intersect", "Question"},
                 [command = command.get()](S o, S t) { command->contacts = parse_count(o, t, 1, 1'000'000'000); });
  contacts->excludes(certified);
  verb->add_flag("--containment", command->containment,
                 "a body inside the other one is a hit too; at least one must be closed")
      ->group("Question")
      ->excludes(certified);
  command->batch.add_to(*verb, "--poses", kPosesHelp, "pose")->excludes(pose)->excludes(contacts);
  command->batch.add_device_to(*verb);
  command->console.add_to(*verb, Console::kMessages | Console::kJson);
  verb->callback([command] { command->run(); });
}

}  // namespace standoff::cli
