// SPDX-License-Identifier: Apache-2.0
// Cases that are often forgotten, and properties that hold for all bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "standoff/collision.h"
#include "standoff/compute.h"
#include "standoff/thesis.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

TEST(EdgeCases, IdenticalBodiesTouch) {
  const Body ball(ball_mesh(1, 8));
  EXPECT_TRUE(collide(ball, {}, ball, {}).hit());
  EXPECT_EQ(distance(ball, {}, ball, {}).upper, 0);
  const SweepResult swept = sweep(ball, {}, ball, {{}, moved({5, 0, 0}), {}});
  EXPECT_TRUE(swept.hit);
  EXPECT_EQ(swept.time, 0);
  EXPECT_TRUE(contacts(ball, {}, ball, {}).overflow);
  // Anywhere, all pairs are found: each triangle with itself and with all its neighbours.
  Random random(1);
  const Mesh small = ball_mesh(1, 3);
  const Body of_small(small);
  const Pose pose = random_pose(random, 10);
  EXPECT_TRUE(collide(of_small, pose, of_small, pose).hit());
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < small.triangles.size(); ++i)
    for (std::size_t j = 0; j < small.triangles.size(); ++j)
      pairs += triangles_intersect(corners_at(small, i, pose), corners_at(small, j, pose));
  const ContactResult all = contacts(of_small, pose, of_small, pose, {.most = 1'000'000});
  EXPECT_EQ(all.contacts.size(), pairs);
  for (const ContactPoint& c : all.contacts) EXPECT_TRUE(is_finite(c.point) && is_finite(c.normal) && c.depth >= 0);
}

TEST(EdgeCases, NestedBodiesAreFree) {
  const Body outer(ball_mesh(2, 6)), inner(ball_mesh(0.5, 4));
  EXPECT_FALSE(collide(outer, {}, inner, {}).hit());
  EXPECT_NEAR(distance(outer, {}, inner, {}).upper, 1.5, 0.15);
  EXPECT_TRUE(sweep(outer, {}, inner, {{}, moved({9, 0, 0}), {}}).hit) << "it cannot get out";
  EXPECT_TRUE(contacts(outer, {}, inner, {}).contacts.empty());
  EXPECT_EQ(collide(outer, {}, inner, {}, {.mode = CollideMode::certified}).verdict, Verdict::free);
  EXPECT_FALSE(sweep(outer, {}, inner, {{}, make_pose({1, 2, 3}, 3, {0.3, 0.2, 0.1}), {}}).hit) << "it may turn inside";
}

// A sheet with a hole, one triangle thick.
TEST(EdgeCases, OpenSurfacesStopWhatMeetsThem) {
  Mesh sheet;
  for (int i = -4; i < 4; ++i)
    for (int j = -4; j < 4; ++j) {
      if (i >= -1 && i < 1 && j >= -1 && j < 1) continue;
      const Vec3 at{double(i), double(j), 0}, x{1, 0, 0}, y{0, 1, 0};
      add_triangle(sheet, at, at + x, at + x + y);
      add_triangle(sheet, at, at + x + y, at + y);
    }
  const Body open(sheet), small(ball_mesh(0.9, 6)), large(ball_mesh(1.5, 6));
  EXPECT_FALSE(collide(open, {}, small, {}).hit()) << "in the hole";
  EXPECT_TRUE(collide(open, {}, large, {}).hit());
  EXPECT_NEAR(distance(open, {}, small, {}).upper, 0.1, 0.02);
  const auto through = [&](const Body& ball, Vec3 at) {
    return sweep(open, {}, ball, {moved(at + Vec3{0, 0, 5}), moved(at - Vec3{0, 0, 5}), {}}).hit;
  };
  EXPECT_FALSE(through(small, {}));
  EXPECT_TRUE(through(large, {}));
  EXPECT_TRUE(through(small, {2.5, 0, 0}));
  EXPECT_TRUE(through(small, {-0.5, 0.5, 0}));
  EXPECT_FALSE(through(small, {9, 0, 0})) << "beside it";
}

TEST(EdgeCases, TouchingExactlyIsAHit) {
  const Body a(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const Body b(one_triangle({0.25, 0.25, 1}, {1, 1, 3}, {-1, 1, 3}));
  EXPECT_TRUE(collide(a, {}, b, moved({0, 0, -1})).hit()) << "a corner on a face";
  EXPECT_FALSE(collide(a, {}, b, moved({0, 0, std::nextafter(-1.0, 0)})).hit()) << "one rounding above it";
  EXPECT_TRUE(collide(a, {}, a, moved({1, 0, 0})).hit()) << "corner to corner, in a plane";
  EXPECT_TRUE(collide(a, {}, a, moved({0.5, 0.5, 0})).hit()) << "an edge on an edge, in a plane";
  EXPECT_FALSE(collide(a, {}, a, moved({0.5, 0.50001, 0})).hit());
}

TEST(EdgeCases, TouchingExactlyForAllQueries) {
  const Body a(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const Body b(one_triangle({0.25, 0.25, 1}, {1, 1, 3}, {-1, 1, 3}));
  const Pose touching = moved({0, 0, -1});
  EXPECT_EQ(distance(a, {}, b, touching).upper, 0);
  const ContactResult at = contacts(a, {}, b, touching);
  ASSERT_EQ(at.contacts.size(), 1u);
  EXPECT_NEAR(length(at.contacts[0].point - Vec3{0.25, 0.25, 0}), 0, 1e-12);
  EXPECT_NEAR(at.contacts[0].depth, 0, 1e-12);
  EXPECT_EQ(sweep(a, {}, b, {touching, moved({0, 0, 5}), {}}).time, 0) << "they touch at the start";
  EXPECT_TRUE(sweep(a, {}, b, {touching, touching, {}}).hit);
  EXPECT_TRUE(sweep(a, {}, b, {moved({0, 0, 2}), touching, {}}).hit) << "they touch at the end";
  // In one plane, edge to edge and corner to corner.
  for (const Vec3 from : {Vec3{3, 0, 0}, Vec3{0.2, -4, 0}, Vec3{5, 5, 0}}) {
    const SweepResult swept = sweep(a, {}, a, {moved(from), moved(from * -1.0), {}}, {1e-6});
    EXPECT_TRUE(swept.hit);
    EXPECT_LE(distance(a, {}, a, moved(from * (1 - 2 * swept.time))).upper, 1e-6);
    EXPECT_FALSE(collide(a, {}, a, moved(from * (1 - 2 * swept.time))).hit());
  }
}

TEST(EdgeCases, OneTriangleAgainstOneTriangle) {
  Random random(3);
  int hits = 0, swept_hits = 0;
  for (int n = 0; n < 300; ++n) {
    SCOPED_TRACE(n);
    const auto triangle = [&] {
      const Vec3 p = random.in_cube(1), q = n % 5 == 0 ? p : random.in_cube(1);
      return one_triangle(p, q, n % 7 == 0 ? q : n % 3 == 0 ? p + (q - p) * 0.5 : random.in_cube(1));
    };
    const Mesh a = triangle(), b = triangle();
    const Body model_a(a), model_b(b);
    const Pose pose = random_pose(random, 0.5), end = random_pose(random, 2);
    const bool expected = brute_touch(a, {}, b, pose);
    EXPECT_EQ(collide(model_a, {}, model_b, pose).hit(), expected);
    EXPECT_EQ(contacts(model_a, {}, model_b, pose).contacts.size(), expected);
    EXPECT_NEAR(distance(model_a, {}, model_b, pose).upper, brute_pair_distance(a, {}, b, pose), 1e-13);
    const RigidMotion motion{pose, end, {}};
    const SweepResult swept = sweep(model_a, {}, model_b, motion, {1e-4});
    for (int k = 0; k < 50; ++k) {
      if (swept.hit && swept.time == 0) break;
      EXPECT_FALSE(brute_touch(a, {}, b, pose_at(motion, swept.time * k / 50)));
    }
    hits += expected, swept_hits += swept.hit;
  }
  EXPECT_GT(hits, 10);
  EXPECT_GT(swept_hits, hits);
}

TEST(EdgeCases, OneTriangleThatIsAPoint) {
  const Body point(one_triangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0})), ball(ball_mesh(1, 4));
  EXPECT_FALSE(collide(ball, {}, point, {}).hit());
  EXPECT_NEAR(distance(point, moved({0, 0, 3}), ball, {}).upper, 2, 1e-12);
  EXPECT_TRUE(collide(ball, {}, point, moved({0, 0, 1})).hit());
  const SweepResult swept = sweep(ball, {}, point, {moved({0, 0, 3}), moved({0, 0, -3}), {}}, {1e-6});
  ASSERT_TRUE(swept.hit);
  EXPECT_NEAR(swept.time, 2 / 6.0, 1e-6);
}

TEST(EdgeCases, NoMotionAndHugeMotion) {
  const Body wall(one_triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0})), ball(ball_mesh(0.1, 3));
  EXPECT_FALSE(sweep(wall, {}, ball, {moved({0, 0, 0.2}), moved({0, 0, 0.2}), {}}).hit);
  EXPECT_TRUE(sweep(wall, {}, ball, {moved({0, 0, 0.05}), moved({0, 0, 0.05}), {}}).hit);
  for (const double far : {1e3, 1e6, 1e9}) {
    const SweepResult swept = sweep(wall, {}, ball, {moved({0, 0, far}), moved({0, 0, -far}), {}}, {1e-3});
    ASSERT_TRUE(swept.hit) << far;
    EXPECT_NEAR(swept.time * 2 * far, far - 0.1, 2e-3) << far;
  }
  // So far that time runs out of digits: it is still never free.
  EXPECT_TRUE(sweep(wall, {}, ball, {moved({0, 0, 1e14}), moved({0, 0, -1e14}), {}}).hit);
  EXPECT_EQ(code_of([&] { sweep(wall, {}, ball, {moved({0, 0, 1e16}), moved({0, 0, 0}), {}}); }), ErrorCode::usage);
  // Farther still, each step of the time jumps over the wall: once such a sweep did not come back.
  const RigidMotion too_far{moved({0, 0, 6e14}), moved({0, 0, -6e14}), {}};
  EXPECT_EQ(code_of([&] { sweep(wall, {}, ball, too_far); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { sweep_all(wall, {}, ball, std::vector{too_far}, SweepOptions{}, {.threads = 1}); }),
            ErrorCode::usage);
  EXPECT_FALSE(sweep(wall, {}, ball, {moved({5, 0, 1e9}), moved({5, 0, -1e9}), {}}).hit);
}

// Matrices may have errors of a millionth, different ones at both ends: if only the last one makes the bodies touch,
// this is a hit.
TEST(EdgeCases, WhatARoundedMatrixMakesTouchAtTheEndIsAHit) {
  const Body wall(one_triangle({1000.0002, -1, -1}, {1000.0002, 1, -1}, {1000.0002, 0, 1}));
  const Body rod(one_triangle({0, 0, 0}, {1000, 0, 0}, {0, 1, 0}));
  for (const double turn : {0.0, 1e-7}) {
    RigidMotion motion;
    motion.end = make_pose({0, 0, 1}, turn, {});
    EXPECT_FALSE(sweep(wall, {}, rod, motion, {1e-6}).hit);
    for (double& r : motion.end.rotation) r *= 1 + 4e-7;
    ASSERT_TRUE(collide(wall, {}, rod, motion.end).hit());
    const SweepResult swept = sweep(wall, {}, rod, motion, {1e-6});
    ASSERT_TRUE(swept.hit);
    EXPECT_EQ(swept.time, 1);
    EXPECT_EQ(swept.triangle_a, 0u);
    EXPECT_EQ(swept.triangle_b, 0u);
    EXPECT_NEAR(length(swept.normal), 1, 1e-9);
  }
}

TEST(EdgeCases, PartingBodiesWithinTheToleranceAreFree) {
  const Body wall(one_triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0})), ball(ball_mesh(0.5, 4));
  const Pose near = moved({0, 0, 0.5 + 5e-5});
  EXPECT_FALSE(sweep(wall, {}, ball, {near, moved({0, 0, 1}), {}}).hit);
  EXPECT_TRUE(sweep(wall, {}, ball, {near, moved({0, 0, 0}), {}}).hit);
}

TEST(EdgeCases, PosesThatAreNoneAreErrors) {
  const Body ball(ball_mesh(1, 2));
  Pose nan, scaled, mirrored, sheared, infinite;
  nan.rotation[4] = std::nan("");
  scaled.rotation = {2, 0, 0, 0, 2, 0, 0, 0, 2};
  mirrored.rotation = {1, 0, 0, 0, 1, 0, 0, 0, -1};
  sheared.rotation = {1, 0.1, 0, 0, 1, 0, 0, 0, 1};
  infinite.translation.y = std::numeric_limits<double>::infinity();
  for (const Pose& bad : {nan, scaled, mirrored, sheared, infinite}) {
    EXPECT_EQ(code_of([&] { collide(ball, bad, ball, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { collide(ball, {}, ball, bad); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { distance(ball, bad, ball, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { distance(ball, {}, ball, bad); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { contacts(ball, bad, ball, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { contacts(ball, {}, ball, bad); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { sweep(ball, bad, ball, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {bad, {}, {}}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {{}, bad, {}}); }), ErrorCode::usage);
    const std::vector<Pose> poses{{}, bad};
    EXPECT_EQ(code_of([&] { collide_all(ball, bad, ball, poses, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { collide_all(ball, {}, ball, poses, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { distance_all(ball, {}, ball, poses, {}); }), ErrorCode::usage);
    EXPECT_EQ(code_of([&] { contacts_all(ball, {}, ball, poses, {}); }), ErrorCode::usage);
    const std::vector<RigidMotion> motions{{}, {{}, bad, {}}};
    EXPECT_EQ(code_of([&] { sweep_all(ball, {}, ball, motions, {}); }), ErrorCode::usage);
    try {
      collide_all(ball, {}, ball, poses, {});
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("(pose 1)"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {{}, {}, {0, std::nan(""), 0}}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { make_pose({0, 0, 0}, 1, {}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { make_pose({0, 0, 1}, std::nan(""), {}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { collide(ball, {}, ball, {}, {.margin = -1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { collide(ball, {}, ball, {}, {.margin = std::nan("")}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { distance(ball, {}, ball, {}, {.tolerance = -1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { distance(ball, {}, ball, {}, {.tolerance = std::nan("")}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { distance(ball, {}, ball, {}, {.limit = std::nan("")}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { contacts(ball, {}, ball, {}, {.margin = -1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {}, {-1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { sweep(ball, {}, ball, {}, {std::nan("")}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { contacts(ball, {}, ball, {}, {.most = 0}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { Body(Mesh{}); }), ErrorCode::input);
}

TEST(EdgeCases, NoPosesAndTooFewThreads) {
  const Body ball(ball_mesh(1, 2));
  EXPECT_TRUE(collide_all(ball, {}, ball, {}, {}).results.empty());
  EXPECT_TRUE(distance_all(ball, {}, ball, {}, {}).results.empty());
  EXPECT_TRUE(contacts_all(ball, {}, ball, {}, {}).results.empty());
  EXPECT_TRUE(sweep_all(ball, {}, ball, {}, {}).results.empty());
  EXPECT_EQ(code_of([&] { collide_all(ball, {}, ball, {}, {}, {.threads = -1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { Body(ball_mesh(1, 2), {.execution = {.threads = -1}}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { Body(ball_mesh(1, 2), {.spacing = -1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { Body(ball_mesh(1, 2), {.spacing = 1e-9}); }), ErrorCode::limit);
}

TEST(EdgeCases, MarginsWiderThanTheBand) {
  const Body a(ball_mesh(1, 4)), b(ball_mesh(0.5, 3));
  const Pose pose = moved({6, 0, 0});
  ASSERT_GT(4.4, a.thickness());
  EXPECT_FALSE(collide(a, {}, b, pose, {.margin = 4.49}).hit());
  EXPECT_TRUE(collide(a, {}, b, pose, {.margin = 4.5 + 1e-12}).hit());
  EXPECT_TRUE(collide(a, {}, b, pose, {.margin = 1e6}).hit());
  EXPECT_NE(collide(a, {}, b, pose, {.margin = 1e6, .mode = CollideMode::certified}).verdict, Verdict::free);
  EXPECT_NE(collide(a, {}, b, pose, {.margin = 4.49, .mode = CollideMode::certified}).verdict, Verdict::hit);
  EXPECT_TRUE(contacts(a, {}, b, pose, {.margin = 4.49}).contacts.empty());
  const ContactResult one = contacts(a, {}, b, pose, {.margin = 4.5 + 1e-12});
  ASSERT_FALSE(one.contacts.empty());
  EXPECT_NEAR(one.contacts[0].depth, -4.5, 1e-9);
  EXPECT_EQ(contacts(a, {}, b, pose, {.most = 1'000'000, .margin = 1e6}).contacts.size(), 128u * 72u);
  EXPECT_TRUE(sweep(a, {}, b, {pose, moved({5, 0, 0}), {}}, {4.0}).hit) << "a tolerance wider than the band";
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
  const Body a(stack(true)), b(stack(false));
  const ContactResult all = contacts(a, {}, b, {}, {.most = 2'000'000});
  EXPECT_EQ(all.contacts.size(), 1200u * 1200u);
  EXPECT_FALSE(all.overflow);
  const ContactResult some = contacts(a, {}, b, {}, {.most = 1000});
  EXPECT_EQ(some.contacts.size(), 1000u);
  EXPECT_TRUE(some.overflow);
}

// At the thickness inside, a value is clamped, and is no distance.
TEST(Thesis, TakesValuesOfSignedFieldsWithinTheThickness) {
  const Grid grid{{24, 24, 24}, {}, {1, 1, 1}};
  std::vector<float> values;
  for (int n = 0; n < 24 * 24 * 24; ++n) {
    const double x = n % 24 - 11.5, y = n / 24 % 24 - 11.5, z = n / 576 - 11.5;
    values.push_back(static_cast<float>(std::clamp(std::sqrt(x * x + y * y + z * z) - 9, -2.0, 2.0)));
  }
  const DistanceField ball = DistanceField::from_dense(grid, 2, values);
  float least = 0;
  for (const float value : values)
    if (value > -2) least = std::min(least, value);
  EXPECT_EQ(thesis_sum(ball, {}, ball, {}), 2 * double{least});
}

TEST(Thesis, FindsWhatIsDeepAndNothingFar) {
  const Mesh a = ball_mesh(1, 6), b = ball_mesh(0.7, 5);
  const DistanceField of_a = compute(a, minimum_grid(bounds(a), 0.4, 4), 0.4, {.sign = {SignMethod::none}}).field,
                      of_b = compute(b, minimum_grid(bounds(b), 0.4, 4), 0.4, {.sign = {SignMethod::none}}).field;
  EXPECT_TRUE(collide_thesis(of_a, {}, of_b, moved({1, 0, 0}), 0.2).hit);
  EXPECT_FALSE(collide_thesis(of_a, {}, of_b, moved({5, 0, 0}), 0.2).hit);
  EXPECT_EQ(thesis_sum(of_a, {}, of_b, moved({50, 0, 0})), std::numeric_limits<double>::infinity());
  Random random(6);
  for (int n = 0; n < 50; ++n) {
    const Pose pose = random_pose(random, 1.5);
    const double sum = thesis_sum(of_a, {}, of_b, pose);
    EXPECT_EQ(collide_thesis(of_a, {}, of_b, pose, 0.3).hit, sum < 0.3);
    // The sum errs by the distance from a sample to its neighbour.
    const double off = std::sqrt(3) / 2 * of_a.grid().max_spacing();
    EXPECT_GE(sum, distance(Body(a), {}, Body(b), pose).upper - off - 1e-5);
  }
}

}  // namespace
}  // namespace standoff
