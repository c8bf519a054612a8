// SPDX-License-Identifier: Apache-2.0
// When two programs give the same answer: a peer of ours, so that what it sees is known.
#include "bench/agreement.h"

#include <gtest/gtest.h>

namespace {

using namespace standoff;
using namespace standoff::bench;

TEST(Agreement, OfNumbers) {
  EXPECT_TRUE(agree(Query::distance, 1, 1 + 1e-7));
  EXPECT_FALSE(agree(Query::distance, 1, 1 + 1e-5));
  EXPECT_FALSE(agree(Query::distance, 0, 1e-3));
  EXPECT_TRUE(agree(Query::contacts, 99, 100));
  EXPECT_FALSE(agree(Query::contacts, 0, 1));
  EXPECT_FALSE(agree(Query::collide, 1, 0));
}

/// A wall from x = 10 to 11 and a point in the place of the pose.
class Wall : public CollisionPeer {
 public:
  bool collide(const Pose& pose) const override { return distance(pose) == 0; }
  std::size_t contacts(const Pose& pose, std::size_t) const override { return collide(pose); }
  double distance(const Pose& pose) const override {
    const double x = pose.translation.x;
    return x < 10 ? 10 - x : x > 11 ? x - 11 : 0;
  }
};

TEST(Agreement, OfSweeps) {
  constexpr double kTolerance = 0.1;
  RigidMotion motion;
  motion.end.translation = {20, 0, 0};  // touches the wall from 0.5 to 0.55
  const auto same = [&](double ours, double theirs) {
    return agree_on_sweep(Wall{}, motion, kTolerance, ours, theirs);
  };
  EXPECT_TRUE(same(0.497, 0.499));
  EXPECT_TRUE(same(0.499, 0.497));
  EXPECT_FALSE(same(0.49, 0.499)) << "ended where the bodies are farther apart than the tolerance";
  EXPECT_FALSE(same(0.552, 0.499)) << "went through the wall first";
  EXPECT_FALSE(same(kFree, 0.499)) << "missed the wall";
  motion.end.translation = {5, 0, 0};
  EXPECT_TRUE(same(kFree, kFree));
  EXPECT_FALSE(same(1, kFree)) << "a hit of nothing";
}

TEST(Agreement, OfHits) {
  EXPECT_TRUE(is_hit(Query::distance, 0));
  EXPECT_FALSE(is_hit(Query::distance, 1e-9));
  EXPECT_TRUE(is_hit(Query::sweep, 1));
  EXPECT_FALSE(is_hit(Query::sweep, kFree));
  EXPECT_FALSE(is_hit(Query::all_contacts, 0));
}

}  // namespace
