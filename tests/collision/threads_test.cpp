// SPDX-License-Identifier: Apache-2.0
// Many threads at once give the same answers as one.
// labels: memory threads
#include <gtest/gtest.h>

#include <thread>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/expect_same.h"

namespace standoff {
namespace {

using namespace standoff::testing;

struct Bodies {
  Body a, b{ball_mesh(0.4, 3)};
  std::vector<Pose> poses;
  std::vector<RigidMotion> motions;

  explicit Bodies(int threads) : a(random_soup(1, 400, 1, 0.3), {.execution = {.threads = threads}}) {
    Random random(5);
    for (int n = 0; n < 300; ++n) poses.push_back(random_pose(random, 1.5));
    for (int n = 0; n + 1 < 300; ++n) motions.push_back({poses[n], poses[n + 1], {0.1, 0.2, 0.3}});
  }
};

TEST(Threads, DoNotShowInTheAnswers) {
  const Bodies one(1), four(4);
  const auto hits = collide_all(one.a, {}, one.b, one.poses, {}, {.threads = 1}).results;
  const auto found = distance_all(one.a, {}, one.b, one.poses, {}, {.threads = 1}).results;
  const auto touching = contacts_all(one.a, {}, one.b, one.poses, {.most = 5}, {.threads = 1}).results;
  const auto swept = sweep_all(one.a, {}, one.b, one.motions, {}, {.threads = 1}).results;
  for (const int threads : {0, 2, 4}) {
    expect_same(hits, collide_all(four.a, {}, four.b, four.poses, {}, {.threads = threads}).results);
    expect_same(found, distance_all(four.a, {}, four.b, four.poses, {}, {.threads = threads}).results);
    expect_same(touching, contacts_all(four.a, {}, four.b, four.poses, {.most = 5}, {.threads = threads}).results);
    expect_same(swept, sweep_all(four.a, {}, four.b, four.motions, {}, {.threads = threads}).results);
  }
  // Single queries give the same too.
  for (std::size_t n = 0; n < one.poses.size(); n += 7) {
    expect_same(hits[n], collide(one.a, {}, one.b, one.poses[n]));
    expect_same(found[n], distance(one.a, {}, one.b, one.poses[n]));
    expect_same(touching[n], contacts(one.a, {}, one.b, one.poses[n], {.most = 5}));
  }
}

TEST(Threads, MayShareABody) {
  const Bodies bodies(0);
  const DistanceOptions near{.tolerance = 0.1};
  const ContactOptions few{.most = 3};
  struct Answers {
    std::vector<CollisionResult> hits;
    std::vector<DistanceResult> distances;
    std::vector<ContactResult> contacts;
  };
  const Answers expected{collide_all(bodies.a, {}, bodies.b, bodies.poses, {}, {.threads = 1}).results,
                         distance_all(bodies.a, {}, bodies.b, bodies.poses, near, {.threads = 1}).results,
                         contacts_all(bodies.a, {}, bodies.b, bodies.poses, few, {.threads = 1}).results};
  std::vector<Answers> found(4);
  std::vector<std::thread> threads;
  for (auto& mine : found)
    threads.emplace_back([&, answers = &mine] {
      const Body a = bodies.a, b = bodies.b;  // copies share
      for (const Pose& pose : bodies.poses) {
        answers->hits.push_back(collide(a, {}, b, pose));
        answers->distances.push_back(distance(a, {}, b, pose, near));
        answers->contacts.push_back(contacts(a, {}, b, pose, few));
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const Answers& mine : found) {
    expect_same(expected.hits, mine.hits);
    expect_same(expected.distances, mine.distances);
    expect_same(expected.contacts, mine.contacts);
  }
}

}  // namespace
}  // namespace standoff
