// SPDX-License-Identifier: Apache-2.0
// Batches of collision queries with one thread and with two, in turns; wall-clock seconds.
#include <iostream>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "collision_workload.h"
#include "measure.h"

namespace {

using namespace standoff;

struct Batches {
  bench::CollisionSettings settings;
  std::vector<std::string> queries{"collide", "contacts", "distance", "sweep"};
  int threads = 2;
  int rounds = 9;
};

/// Answers a batch and drops the answers.
void answer(bench::Query query, const Body& a, const Body& b, const std::vector<Pose>& poses,
            const std::vector<RigidMotion>& motions, double tolerance, int threads) {
  const Execution execution{.threads = threads, .backend = Backend::cpu};
  switch (query) {
    case bench::Query::collide:
      collide_all(a, {}, b, poses, {}, execution).results;
      return;
    case bench::Query::contacts:
      contacts_all(a, {}, b, poses, {bench::kContacts}, execution).results;
      return;
    case bench::Query::all_contacts:
      contacts_all(a, {}, b, poses, {bench::kAllContacts}, execution).results;
      return;
    case bench::Query::distance:
      distance_all(a, {}, b, poses, {}, execution).results;
      return;
    case bench::Query::sweep:
      sweep_all(a, {}, b, motions, {tolerance}, execution).results;
      return;
  }
}

/// Seconds of a batch. A turn repeats it until the time is long enough to be measured.
template <class Batch>
double turn(Batch&& batch) {
  constexpr double kLeast_s = 0.2;
  int batches = 0;
  const auto start = std::chrono::steady_clock::now();
  for (double seconds = 0;;) {
    batch();
    ++batches;
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (seconds >= kLeast_s) return seconds / batches;
  }
}

void run(const Batches& batches) {
  const bench::CollisionSettings& settings = batches.settings;
  const Body a(bench::make_body(settings.a)), b(bench::make_body(settings.b));
  for (const std::string& text : batches.queries) {
    const bench::Question question = bench::parse_question(text);
    const std::vector<Pose> poses = bench::PosesDrawn(settings, a, b).of(question);
    const std::vector<RigidMotion> motions = bench::make_motions(settings, question, poses);
    std::vector<double> one_s, many_s, ratios;
    for (int round = 0; round < batches.rounds; ++round) {
      for (auto& [threads, seconds] : {std::pair{1, &one_s}, {batches.threads, &many_s}})
        seconds->push_back(turn([&] { answer(question.query, a, b, poses, motions, settings.tolerance, threads); }));
      ratios.push_back(one_s.back() / many_s.back());
    }
    const nlohmann::json line{{"query", question.name},        {"poses", poses.size()},
                              {"threads", batches.threads},    {"rounds", batches.rounds},
                              {"one_s", bench::median(one_s)}, {"many_s", bench::median(many_s)},
                              {"ratio", bench::median(ratios)}};
    std::cout << line.dump() << std::endl;
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("batches of collision queries with one thread and with many, in turns", "bench_collision");
  Batches batches;
  bench::add_options(app, batches.settings);
  app.add_option("--query", batches.queries, "as peer_fcl takes them");
  app.add_option("--threads", batches.threads);
  app.add_option("--rounds", batches.rounds);
  CLI11_PARSE(app, argc, argv);
  try {
    run(batches);
  } catch (const std::exception& error) {
    std::cerr << "bench_collision: " << error.what() << "\n";
    return 1;
  }
}
