// SPDX-License-Identifier: Apache-2.0
// Many threads at once give what one gives.
// labels: memory threads
#include <gtest/gtest.h>

#include <thread>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

void expect_same(const CollisionResult& a, const CollisionResult& b) {
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_EQ(a.triangle_a, b.triangle_a);
  EXPECT_EQ(a.triangle_b, b.triangle_b);
}

void expect_same(const DistanceResult& a, const DistanceResult& b) {
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
  EXPECT_EQ(a.point_a, b.point_a);
  EXPECT_EQ(a.point_b, b.point_b);
  EXPECT_EQ(a.triangle_a, b.triangle_a);
  EXPECT_EQ(a.triangle_b, b.triangle_b);
}

void expect_same(const ContactResult& a, const ContactResult& b) {
  EXPECT_EQ(a.overflow, b.overflow);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    EXPECT_EQ(a.contacts[k].point, b.contacts[k].point);
    EXPECT_EQ(a.contacts[k].normal, b.contacts[k].normal);
    EXPECT_EQ(a.contacts[k].depth, b.contacts[k].depth);
    EXPECT_EQ(a.contacts[k].triangle_a, b.contacts[k].triangle_a);
    EXPECT_EQ(a.contacts[k].triangle_b, b.contacts[k].triangle_b);
  }
}

void expect_same(const SweepResult& a, const SweepResult& b) {
  EXPECT_EQ(a.hit, b.hit);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.point, b.point);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.triangle_a, b.triangle_a);
  EXPECT_EQ(a.triangle_b, b.triangle_b);
}

template <class Result>
void expect_same(const std::vector<Result>& a, const std::vector<Result>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) expect_same(a[n], b[n]);
}

struct Bodies {
  CollisionModel a, b{ball_mesh(0.4, 3)};
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
  const auto hits = collide_all(one.a, {}, one.b, one.poses, {}, {.threads = 1});
  const auto found = distance_all(one.a, {}, one.b, one.poses, {}, {.threads = 1});
  const auto touching = contacts_all(one.a, {}, one.b, one.poses, {.most = 5}, {.threads = 1});
  const auto swept = sweep_all(one.a, {}, one.b, one.motions, {}, {.threads = 1});
  for (const int threads : {0, 2, 4}) {
    expect_same(hits, collide_all(four.a, {}, four.b, four.poses, {}, {.threads = threads}));
    expect_same(found, distance_all(four.a, {}, four.b, four.poses, {}, {.threads = threads}));
    expect_same(touching, contacts_all(four.a, {}, four.b, four.poses, {.most = 5}, {.threads = threads}));
    expect_same(swept, sweep_all(four.a, {}, four.b, four.motions, {}, {.threads = threads}));
  }
  // One by one is the same too.
  for (std::size_t n = 0; n < one.poses.size(); n += 7) {
    expect_same(hits[n], collide(one.a, {}, one.b, one.poses[n]));
    expect_same(found[n], distance(one.a, {}, one.b, one.poses[n]));
    expect_same(touching[n], contacts(one.a, {}, one.b, one.poses[n], {.most = 5}));
  }
}

TEST(Threads, MayShareABody) {
  const Bodies bodies(0);
  const auto expected = collide_all(bodies.a, {}, bodies.b, bodies.poses, {}, {.threads = 1});
  std::vector<std::vector<CollisionResult>> found(4);
  std::vector<std::thread> threads;
  for (auto& mine : found)
    threads.emplace_back([&bodies, &mine] {
      const CollisionModel a = bodies.a, b = bodies.b;  // copies share
      for (const Pose& pose : bodies.poses) {
        mine.push_back(collide(a, {}, b, pose));
        distance(a, {}, b, pose, {.tolerance = 0.1});
        contacts(a, {}, b, pose, {.most = 3});
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const auto& mine : found) expect_same(expected, mine);
}

}  // namespace
}  // namespace standoff
