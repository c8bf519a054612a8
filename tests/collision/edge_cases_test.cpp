// Cases that tend to be forgotten, and properties that hold whatever the bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "difi/collision.h"
#include "difi/compute.h"
#include "tests/collision/bodies.h"

namespace difi {
namespace {

using namespace difi::testing;

TEST(EdgeCases, IdenticalBodiesTouch) {
  const CollisionModel ball(ball_mesh(1, 8));
  EXPECT_TRUE(collide(ball, {}, ball, {}).hit());
  EXPECT_EQ(distance(ball, {}, ball, {}).upper, 0);
  const Swept swept = sweep(ball, {}, ball, {{}, moved({5, 0, 0}), {}});
  EXPECT_TRUE(swept.hit);
  EXPECT_EQ(swept.time, 0);
  EXPECT_TRUE(contacts(ball, {}, ball, {}).overflow);
}

TEST(EdgeCases, NestedBodiesAreFree) {
  const CollisionModel outer(ball_mesh(2, 6)), inner(ball_mesh(0.5, 4));
  EXPECT_FALSE(collide(outer, {}, inner, {}).hit());
  EXPECT_NEAR(distance(outer, {}, inner, {}).upper, 1.5, 0.15);
  EXPECT_TRUE(sweep(outer, {}, inner, {{}, moved({9, 0, 0}), {}}).hit) << "it cannot get out";
}

TEST(EdgeCases, TouchingExactlyIsAHit) {
  const CollisionModel a(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const CollisionModel b(one_triangle({0.25, 0.25, 1}, {1, 1, 3}, {-1, 1, 3}));
  EXPECT_TRUE(collide(a, {}, b, moved({0, 0, -1})).hit()) << "a corner on a face";
  EXPECT_FALSE(collide(a, {}, b, moved({0, 0, std::nextafter(-1.0, 0)})).hit()) << "one rounding above it";
  EXPECT_TRUE(collide(a, {}, a, moved({1, 0, 0})).hit()) << "corner to corner, in a plane";
  EXPECT_TRUE(collide(a, {}, a, moved({0.5, 0.5, 0})).hit()) << "an edge on an edge, in a plane";
  EXPECT_FALSE(collide(a, {}, a, moved({0.5, 0.50001, 0})).hit());
}

TEST(EdgeCases, OneTriangleThatIsAPoint) {
  const CollisionModel point(one_triangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0})), ball(ball_mesh(1, 4));
  EXPECT_FALSE(collide(ball, {}, point, {}).hit());
  EXPECT_NEAR(distance(point, moved({0, 0, 3}), ball, {}).upper, 2, 1e-12);
  EXPECT_TRUE(collide(ball, {}, point, moved({0, 0, 1})).hit());
  const Swept swept = sweep(ball, {}, point, {moved({0, 0, 3}), moved({0, 0, -3}), {}}, {1e-6});
  ASSERT_TRUE(swept.hit);
  EXPECT_NEAR(swept.time, 2 / 6.0, 1e-6);
}

TEST(EdgeCases, NoMotionAndHugeMotion) {
  const CollisionModel wall(one_triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0})), ball(ball_mesh(0.1, 3));
  EXPECT_FALSE(sweep(wall, {}, ball, {moved({0, 0, 0.2}), moved({0, 0, 0.2}), {}}).hit);
  EXPECT_TRUE(sweep(wall, {}, ball, {moved({0, 0, 0.05}), moved({0, 0, 0.05}), {}}).hit);
  for (const double far : {1e3, 1e6, 1e9}) {
    const Swept swept = sweep(wall, {}, ball, {moved({0, 0, far}), moved({0, 0, -far}), {}}, {1e-3});
    ASSERT_TRUE(swept.hit) << far;
    EXPECT_NEAR(swept.time * 2 * far, far - 0.1, 2e-3) << far;
  }
  // So far that time has no more digits: still never free.
  EXPECT_TRUE(sweep(wall, {}, ball, {moved({0, 0, 1e14}), moved({0, 0, -1e14}), {}}).hit);
  EXPECT_EQ(code_of([&] { sweep(wall, {}, ball, {moved({0, 0, 1e16}), moved({0, 0, 0}), {}}); }), ErrorCode::usage);
  EXPECT_FALSE(sweep(wall, {}, ball, {moved({5, 0, 1e9}), moved({5, 0, -1e9}), {}}).hit);
}

TEST(EdgeCases, PartingBodiesWithinTheToleranceAreFree) {
  const CollisionModel wall(one_triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0})), ball(ball_mesh(0.5, 4));
  const Pose near = moved({0, 0, 0.5 + 5e-5});
  EXPECT_FALSE(sweep(wall, {}, ball, {near, moved({0, 0, 1}), {}}).hit);
  EXPECT_TRUE(sweep(wall, {}, ball, {near, moved({0, 0, 0}), {}}).hit);
}

TEST(EdgeCases, PosesThatAreNoneAreErrors) {
  const CollisionModel ball(ball_mesh(1, 2));
  Pose nan, scaled, mirrored, sheared, infinite;
  nan.rotation[4] = std::nan("");
  scaled.rotation = {2, 0, 0, 0, 2, 0, 0, 0, 2};
  mirrored.rotation = {1, 0, 0, 0, 1, 0, 0, 0, -1};
  sheared.rotation = {1, 0.1, 0, 0, 1, 0, 0, 0, 1};
  infinite.translation.y = std::numeric_limits<double>::infinity();
  for (const Pose& bad : {nan, scaled, mirrored, sheared, infinite}) {
    EXPECT_EQ(code_of([&] { collide(ball, bad, ball, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { collide(ball, {}, ball, bad); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { distance(ball, {}, ball, bad); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { contacts(ball, bad, ball, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {bad, {}, {}}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {{}, bad, {}}); }), ErrorCode::usage);
    const std::vector<Pose> poses{{}, bad};
    EXPECT_EQ(code_of([&] { collide_all(ball, {}, ball, poses, {}); }), ErrorCode::usage);
  }
  EXPECT_EQ(code_of([&] { collide(ball, {}, ball, {}, {.margin = -1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { collide(ball, {}, ball, {}, {.margin = std::nan("")}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {}, {0}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { contacts(ball, {}, ball, {}, {.most = 0}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { CollisionModel(Mesh{}); }), ErrorCode::input);
}

TEST(EdgeCases, MarginsWiderThanTheBand) {
  const CollisionModel a(ball_mesh(1, 4)), b(ball_mesh(0.5, 3));
  const Pose pose = moved({6, 0, 0});
  ASSERT_GT(4.4, a.band());
  EXPECT_FALSE(collide(a, {}, b, pose, {.margin = 4.49}).hit());
  EXPECT_TRUE(collide(a, {}, b, pose, {.margin = 4.5 + 1e-12}).hit());
  EXPECT_TRUE(collide(a, {}, b, pose, {.margin = 1e6}).hit());
}

TEST(EdgeCases, MillionsOfContacts) {
  // Two stacks of plates through each other.
  const auto stack = [](bool upright) {
    Mesh mesh;
    for (int n = 0; n < 1200; ++n) {
      const double at = n / 1200.0;
      const auto p = [&](double u, double v) { return upright ? Vec3{at, u, v} : Vec3{u, at, v}; };
      add_triangle(mesh, p(-1, -1), p(3, -1), p(-1, 3));
    }
    return mesh;
  };
  const CollisionModel a(stack(true)), b(stack(false));
  const Contacts all = contacts(a, {}, b, {}, {.most = 2'000'000});
  EXPECT_EQ(all.contacts.size(), 1200u * 1200u);
  EXPECT_FALSE(all.overflow);
  const Contacts some = contacts(a, {}, b, {}, {.most = 1000});
  EXPECT_EQ(some.contacts.size(), 1000u);
  EXPECT_TRUE(some.overflow);
}

TEST(Properties, ALargerMarginKeepsHits) {
  const CollisionModel a(random_soup(1, 100, 1, 0.3)), b(ball_mesh(0.4, 3));
  Random random(2);
  for (int n = 0; n < 200; ++n) {
    const Pose pose = random_pose(random, 3);
    const double d = distance(a, {}, b, pose).upper;
    bool before = false;
    for (const double margin : {0.0, 0.1, 0.5, 1.0, 2.0}) {
      const bool hit = collide(a, {}, b, pose, {.margin = margin}).hit();
      ASSERT_TRUE(hit || !before);
      ASSERT_EQ(hit, d <= margin);
      const Contact certified = collide(a, {}, b, pose, {.margin = margin, .mode = CollideMode::certified}).contact;
      ASSERT_TRUE(certified == Contact::ambiguous || (certified == Contact::hit) == hit);
      before = hit;
    }
  }
}

TEST(Properties, AnswersDoNotDependOnWhereTheWorldIs) {
  const CollisionModel a(random_soup(1, 100, 1, 0.3)), b(ball_mesh(0.4, 3));
  Random random(3);
  for (int n = 0; n < 100; ++n) {
    const Pose pose = random_pose(random, 2), world = random_pose(random, 100);
    const double d = distance(a, {}, b, pose).upper;
    EXPECT_NEAR(distance(a, world, b, compose(world, pose)).upper, d, 1e-12 * 100);
    EXPECT_FALSE(d > 1e-9 && collide(a, world, b, compose(world, pose)).hit());
  }
}

TEST(Properties, LargerBodiesMeetEarlier) {
  const CollisionModel a(ball_mesh(1, 4));
  Random random(4);
  const Mesh small = ball_mesh(0.2, 3), large = ball_mesh(0.3, 3);
  const CollisionModel b(small), c(large);
  for (int n = 0; n < 200; ++n) {
    Motion motion{random_pose(random, 3), {}, {}};
    motion.to = motion.from;
    motion.to.translation = random.in_cube(3);
    const Swept of_small = sweep(a, {}, b, motion), of_large = sweep(a, {}, c, motion);
    const double length_of_way = length(motion.to.translation - motion.from.translation);
    // The larger ball holds the smaller one, up to its flat faces and the tolerance.
    EXPECT_TRUE(of_large.hit || !of_small.hit);
    EXPECT_LE(of_large.time * length_of_way, of_small.time * length_of_way + 2e-4);
  }
}

TEST(Thesis, FindsWhatIsDeepAndNothingFar) {
  const Mesh a = ball_mesh(1, 6), b = ball_mesh(0.7, 5);
  Options options;
  options.thickness = 0.4;
  const DistanceField of_a = compute(a, minimum_grid(bounds(a), 0.4, 4), options).field,
                      of_b = compute(b, minimum_grid(bounds(b), 0.4, 4), options).field;
  EXPECT_TRUE(collide_thesis(of_a, {}, of_b, moved({1, 0, 0}), 0.2).hit);
  EXPECT_FALSE(collide_thesis(of_a, {}, of_b, moved({5, 0, 0}), 0.2).hit);
  EXPECT_EQ(thesis_sum(of_a, {}, of_b, moved({50, 0, 0})), std::numeric_limits<double>::infinity());
  Random random(6);
  for (int n = 0; n < 50; ++n) {
    const Pose pose = random_pose(random, 1.5);
    const double sum = thesis_sum(of_a, {}, of_b, pose);
    EXPECT_EQ(collide_thesis(of_a, {}, of_b, pose, 0.3).hit, sum < 0.3);
    // The sum errs by the way from a sample to its neighbour.
    const double off = std::sqrt(3) / 2 * of_a.grid().max_spacing();
    EXPECT_GE(sum, distance(CollisionModel(a), {}, CollisionModel(b), pose).upper - off - 1e-5);
  }
}

}  // namespace
}  // namespace difi
