// SPDX-License-Identifier: Apache-2.0
#include "collision_contest.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>
#include <limits>
#include <numbers>
#include <span>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "agreement.h"
#include "child.h"
#include "measure.h"

namespace standoff::bench {
namespace {

/// Turns are whole rounds: in shorter turns, each program would first have to refill its caches.
constexpr int kRounds = 5;
/// A single pose is repeated for at least this time, so that microseconds can be measured. Random poses are visited
/// once per turn: otherwise the faster program would find them in its caches.
constexpr double kLeastTurn_s = 0.2;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Contest {
  CollisionSettings settings;
  std::vector<std::string> questions{"collide"};
  double limit_s = 120;  // FCL may take minutes where surfaces conform
  double enough_s = 10;  // no new round after this time of both: queries that take seconds need no median of five
};

/// A question that all programs answer with a number.
struct Asked {
  const CollisionSettings& settings;
  const Question& question;
  std::vector<Pose> poses;
  std::vector<RigidMotion> motions;
  double reach;  ///< the largest distance of b's corners from its y axis
};

double ask_standoff(const Asked& asked, const Body& a, const Body& b, std::size_t n) {
  const Pose& pose = asked.poses[n];
  switch (asked.question.query) {
    case Query::collide:
      return collide(a, {}, b, pose).hit();
    case Query::contacts:
      return static_cast<double>(contacts(a, {}, b, pose, {kContacts}).contacts.size());
    case Query::all_contacts:
      return static_cast<double>(contacts(a, {}, b, pose, {kAllContacts}).contacts.size());
    case Query::distance:
      return distance(a, {}, b, pose).upper;
    case Query::sweep:
      break;
  }
  const SweepResult swept = sweep(a, {}, b, asked.motions[n], {asked.settings.tolerance});
  return swept.hit ? swept.time : kFree;
}

/// Conservative advancement: the length of the way and of the turn bounds the speed of all points.
double advance(const CollisionPeer& peer, const RigidMotion& motion, double turn, double tolerance) {
  const Vec3 way = motion.end.translation - motion.start.translation;
  const double speed = std::sqrt(dot(way, way)) + turn;
  for (double t = 0; t <= 1;) {
    const double apart = peer.distance(pose_at(motion, t));
    if (apart <= tolerance) return t;
    t += (apart - tolerance / 2) / speed;
  }
  return kFree;
}

double ask_peer(const Asked& asked, const CollisionPeer& peer, std::size_t n) {
  const Pose& pose = asked.poses[n];
  switch (asked.question.query) {
    case Query::collide:
      return peer.collide(pose);
    case Query::contacts:
      return static_cast<double>(peer.contacts(pose, kContacts));
    case Query::all_contacts:
      return static_cast<double>(peer.contacts(pose, kAllContacts));
    case Query::distance:
      return peer.distance(pose);
    case Query::sweep:
      break;
  }
  const double turn = asked.question.rotate_degrees.value_or(0) * std::numbers::pi / 180 * asked.reach;
  return advance(peer, asked.motions[n], turn, asked.settings.tolerance);
}

/// The turns of one program.
struct Side {
  std::vector<double> seconds;   ///< for all poses once, by round
  std::vector<double> of_poses;  ///< the least wall-clock seconds of each
  std::vector<double> answers;
  double spent = 0;
  bool late = false;  ///< it was stopped at the limit, which then counts as its time
};

/// Asks about all poses, again and again for a minimum time. What is told: seconds, passes, answers, and the least
/// seconds of each pose.
template <class Ask>
void take_turn(Side& side, std::size_t poses, double least_s, double limit_s, Ask&& ask) {
  const auto turn = run_in_child(limit_s, [&] {
    std::vector<double> told(2 + 2 * poses, std::numeric_limits<double>::infinity());
    told[0] = told[1] = 0;
    const double start = cpu_seconds();
    do {
      auto before = std::chrono::steady_clock::now();
      for (std::size_t n = 0; n < poses; ++n) {
        told[2 + n] = ask(n);
        const auto now = std::chrono::steady_clock::now();
        double& least = told[2 + poses + n];
        least = std::min(least, std::chrono::duration<double>(now - before).count());
        before = now;
      }
      ++told[1];
      told[0] = cpu_seconds() - start;
    } while (told[0] < least_s);
    return told;
  });
  side.late = !turn;
  side.spent += turn ? (*turn)[0] : limit_s;
  side.seconds.push_back(turn ? (*turn)[0] / (*turn)[1] : limit_s);
  if (!turn) return;
  const auto answers = turn->begin() + 2, of_poses = answers + static_cast<std::ptrdiff_t>(poses);
  side.answers.assign(answers, of_poses);
  if (side.of_poses.empty()) side.of_poses.assign(of_poses, turn->end());
  std::ranges::transform(side.of_poses, std::span(of_poses, turn->end()), side.of_poses.begin(), std::ranges::min);
}

void write(nlohmann::json& line, const std::string& who, const Side& side) {
  line[who + "_s"] = median(side.seconds);
  line[who + "_late"] = side.late;
  if (!side.of_poses.empty()) {
    line[who + "_median_s"] = median(side.of_poses);
    line[who + "_slowest_s"] = std::ranges::max(side.of_poses);
  }
  if (side.answers.size() == 1) line[who + "_answer"] = side.answers[0];
}

nlohmann::json measure_question(const Asked& asked, const Body& a, const Body& b, const CollisionPeer& peer,
                                const Contest& contest) {
  const std::size_t poses = asked.poses.size();
  const double least_s = asked.question.place ? kLeastTurn_s : 0;
  Side ours, theirs;
  do {
    take_turn(ours, poses, least_s, contest.limit_s, [&](std::size_t n) { return ask_standoff(asked, a, b, n); });
    take_turn(theirs, poses, least_s, contest.limit_s, [&](std::size_t n) { return ask_peer(asked, peer, n); });
  } while (ours.seconds.size() < kRounds && ours.spent + theirs.spent < contest.enough_s && !ours.late && !theirs.late);

  const Query query = asked.question.query;
  std::int64_t hits = 0, differ = 0;
  for (const double answer : ours.answers) hits += is_hit(query, answer);
  if (!ours.late && !theirs.late)
    for (std::size_t n = 0; n < poses; ++n)
      differ += query == Query::sweep ? !agree_on_sweep(peer, asked.motions[n], asked.settings.tolerance,
                                                        ours.answers[n], theirs.answers[n])
                                      : !agree(query, ours.answers[n], theirs.answers[n]);
  nlohmann::json line{{"query", asked.question.name},
                      {"poses", poses},
                      {"rounds", ours.seconds.size()},
                      {"hits", hits},
                      {"differ", differ},
                      {"ratio", median(theirs.seconds) / median(ours.seconds)}};
  if (!ours.of_poses.empty() && !theirs.of_poses.empty())
    line["ratio_of_medians"] = median(theirs.of_poses) / median(ours.of_poses);
  write(line, "standoff", ours);
  write(line, "peer", theirs);
  return line;
}

void run(const Contest& contest, const std::string& peer_name, const MakePeer& make_peer) {
  std::vector<Question> questions;
  for (const std::string& text : contest.questions) questions.push_back(parse_question(text));
  const CollisionSettings& settings = contest.settings;
  const Mesh mesh_a = make_body(settings.a), mesh_b = make_body(settings.b);
  double start = cpu_seconds();
  const Body a(mesh_a), b(mesh_b);
  const double build = cpu_seconds() - start;
  start = cpu_seconds();
  const std::unique_ptr<CollisionPeer> peer = make_peer(mesh_a, mesh_b);
  const double peer_build = cpu_seconds() - start;
  double reach = 0;
  for (const Vec3& corner : mesh_b.vertices) reach = std::max(reach, std::hypot(corner.x, corner.z));
  PosesDrawn drawn(settings, a, b);
  for (std::size_t n = 0; n < questions.size(); ++n) {
    if (questions.size() > 1) std::cerr << "    " << contest.questions[n] << std::endl;  // some take minutes
    Asked asked{settings, questions[n], drawn.of(questions[n]), {}, reach};
    asked.motions = make_motions(settings, questions[n], asked.poses);
    nlohmann::json line = measure_question(asked, a, b, *peer, contest);
    line.update({{"peer", peer_name},
                 {"a", settings.a.name},
                 {"b", settings.b.name},
                 {"triangles", {mesh_a.triangles.size(), mesh_b.triangles.size()}},
                 {"standoff_build_s", build},
                 {"peer_build_s", peer_build}});
    std::cout << line.dump() << std::endl;
  }
}

}  // namespace

int run_collision_contest(int argc, char** argv, const std::string& peer_name, const MakePeer& make_peer) {
  CLI::App app("collision queries beside " + peer_name + ", in turns; processor time of one thread", argv[0]);
  Contest contest;
  add_options(app, contest.settings);
  app.add_option("--query", contest.questions,
                 "collide, contacts, all_contacts, distance or sweep, of poses drawn; QUERY@X,Y,Z: with b moved so far "
                 "from its own place; QUERY@KEY=NUMBER,..: gap, depth, turn, hits or spin, poses, way and more "
                 "(bench/question.h)");
  app.add_option("--limit", contest.limit_s, "processor time a turn may take, seconds")->check(CLI::Range(0.001, 1e6));
  app.add_option("--enough", contest.enough_s, "no new round after this much processor time of both, seconds")
      ->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    run(contest, peer_name, make_peer);
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace standoff::bench
