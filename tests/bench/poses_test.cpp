// SPDX-License-Identifier: Apache-2.0
// Poses of the benchmarks: where they say they are, and always the same ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <tuple>

#include "bench/collision_workload.h"
#include "bench/conforming.h"
#include "scenes/scenes.h"

namespace {

using namespace standoff;
using namespace standoff::bench;

class Poses : public testing::Test {
 protected:
  std::vector<Pose> of(const std::string& question) { return drawn_.of(parse_question(question)); }

  CollisionSettings settings_;
  Body a_{scenes::make("bender", 0)}, b_{scenes::make("fly", 1000)};
  PosesDrawn drawn_{settings_, a_, b_};
};

TEST_F(Poses, AtAGap) {
  for (const double gap : {0.01, 5.0}) {
    const auto poses = of("distance@poses=20,gap=" + std::to_string(gap));
    EXPECT_EQ(poses.size(), 20u);
    for (const Pose& pose : poses) {
      const double apart = distance(a_, {}, b_, pose).upper;
      EXPECT_GE(apart, gap * (1 - 1e-9));
      EXPECT_LE(apart, gap * 1.01);
    }
  }
}

TEST_F(Poses, DeepAndInTheBox) {
  const auto touching = [&](const Pose& pose) { return collide(a_, {}, b_, pose).hit(); };
  const auto deep = of("contacts@depth=0.1,poses=20");
  EXPECT_EQ(std::count_if(deep.begin(), deep.end(), touching), 20);
  for (const int count : {20, 16, 12, 8, 4}) {  // the share holds for each count, not for the largest alone
    const auto some = of("collide@hits=0.25,poses=" + std::to_string(count));
    EXPECT_EQ(std::count_if(some.begin(), some.end(), touching), count / 4);
  }
}

TEST_F(Poses, TurnedInPlace) {
  for (const Pose& pose : of("collide@turn=30,poses=20")) {
    const Vec3 off = apply(pose, b_.bounds().center()) - a_.bounds().center();
    EXPECT_LE(std::sqrt(dot(off, off)), 1e-12);
    const double cosine = (pose.rotation[0] + pose.rotation[4] + pose.rotation[8] - 1) / 2;
    EXPECT_GE(cosine, std::cos(30 * 3.14159265358979 / 180) - 1e-12);
  }
}

TEST_F(Poses, SpunInPlace) {
  bool moved = false;
  for (const Pose& pose : of("collide@spin=30,dx=0.5,poses=20")) {
    EXPECT_EQ(pose.rotation[4], 1);  // about y
    EXPECT_GE(pose.rotation[0], std::cos(30 * 3.14159265358979 / 180) - 1e-12);
    EXPECT_LE(std::abs(pose.translation.x), 0.5);
    EXPECT_EQ(pose.translation.y, 0);
    moved |= pose.translation.x != 0;
  }
  EXPECT_TRUE(moved);
  EXPECT_THROW(parse_question("collide@gap=1,dx=0.5"), std::invalid_argument);
}

TEST_F(Poses, TurnDuringASweep) {
  const Question question = parse_question("sweep@gap=1,poses=3,way=0,rotate=90");
  for (const RigidMotion& motion : make_motions(settings_, question, drawn_.of(question))) {
    EXPECT_EQ(motion.start.translation, motion.end.translation);
    const Vec3 axis = rotate(motion.start, {0, 1, 0}), end = rotate(motion.end, {0, 1, 0});
    EXPECT_LE(length(axis - end), 1e-12);
    EXPECT_NEAR(dot(rotate(motion.start, {1, 0, 0}), rotate(motion.end, {1, 0, 0})), 0, 1e-12);
  }
}

TEST_F(Poses, AreTheSameForEveryQuestion) {
  const auto many = of("collide@gap=0.1,poses=9"), few = of("sweep@gap=0.1,poses=4,way=2");
  ASSERT_EQ(few.size(), 4u);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
  EXPECT_EQ(of("distance@hits=0,poses=3").size(), 3u);
  EXPECT_EQ(of("distance@hits=0,poses=5").size(), 5u);
  const Question question = parse_question("sweep@gap=0.1,poses=4,way=2");
  for (const RigidMotion& motion : make_motions(settings_, question, few)) {
    const Vec3 way = motion.end.translation - motion.start.translation;
    EXPECT_NEAR(std::sqrt(dot(way, way)), 2, 1e-12);
  }
}

TEST_F(Poses, ThatDoNotExist) { EXPECT_THROW(of("collide@depth=1000,poses=1"), std::runtime_error); }

// What they are called by is the distance at which they lie side by side.
TEST(Bodies, Conform) {
  const auto apart = [](const std::string& a, const std::string& b, Vec3 moved) {
    Pose pose{.translation = moved};
    return distance(Body(make_body({a, 6000})), {}, Body(make_body({b, 6000})), pose).upper;
  };
  EXPECT_NEAR(apart("sleeve:0.01", "shaft", {}), 0.01, 1e-4);
  EXPECT_NEAR(apart("plate", "plate", {0, 0.101, 0}), 0.001, 1e-12);
  EXPECT_NEAR(apart("fan:-1", "fan", {0, 0.25, 0}), 0.25, 1e-12);
  EXPECT_NEAR(apart("stack", "stack", {0, 0.25, 0}), 0.25, 0.01);
  for (const auto& [a, b, most] :
       {std::tuple{"shell:1", "shell:0.97", 0.02}, {"nut:0.05", "bolt", 0.05}, {"chain:0", "chain:1", 0.12}}) {
    const double found = apart(a, b, {});
    EXPECT_GT(found, 0) << a;
    EXPECT_LE(found, most) << a;
  }
  for (const std::string name : {"gear", "knot"}) EXPECT_TRUE(Body(make_body({name, 2000})).has_inside()) << name;
  EXPECT_THROW(make_conforming("spoon", 0), std::invalid_argument);
}

TEST(Bodies, OfFilesAreSplitAndScaled) {
  const std::string file = testing::TempDir() + "/poses_test.obj";
  std::ofstream(file) << "v 1 2 3\nv 5 2 3\nv 1 4 3\nv 1 2 4\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const Mesh mesh = make_body({file, 1000, 7});
  EXPECT_EQ(mesh.triangles.size(), 1000u);
  const Box box = bounds(mesh);
  const Vec3 extent = box.extent(), off = box.center();
  EXPECT_NEAR(std::max({extent.x, extent.y, extent.z}), 7, 1e-12);
  EXPECT_NEAR(std::sqrt(dot(off, off)), 0, 1e-12);
  EXPECT_EQ(make_body({"fly", 1000}).triangles.size(), scenes::make("fly", 1000).triangles.size());
}

}  // namespace
