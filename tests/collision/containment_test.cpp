// SPDX-License-Identifier: Apache-2.0
// Which body is inside the other: known answers, and winding numbers of every corner by solid angles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "standoff/collision.h"
#include "standoff/testing/emulation.h"
#include "tests/collision/expect_same.h"
#include "tests/collision/solids.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using namespace standoff::testing;

constexpr CollideOptions kContainment{.containment = true};

Containment opposite(Containment containment) {
  return containment == Containment::b_in_a   ? Containment::a_in_b
         : containment == Containment::a_in_b ? Containment::b_in_a
                                              : containment;
}

// Asks in both orders.
void expect_containment(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, Containment expected) {
  const CollisionResult found = collide(a, pose_a, b, pose_b, kContainment);
  EXPECT_EQ(found.containment, expected);
  EXPECT_EQ(found.hit(), expected != Containment::none);
  EXPECT_EQ(found.triangle_a, kNoTriangle);
  EXPECT_EQ(found.triangle_b, kNoTriangle);
  EXPECT_EQ(collide(b, pose_b, a, pose_a, kContainment).containment, opposite(expected));
  EXPECT_FALSE(collide(a, pose_a, b, pose_b).hit()) << "the surfaces intersect: not what is tested here";
}

TEST(Containment, ABallInABall) {
  const Body large(solid_ball(1, 8)), small(solid_ball(0.2, 4));
  EXPECT_TRUE(large.has_inside());
  expect_containment(large, {}, small, {}, Containment::b_in_a);
  expect_containment(large, {}, small, moved({0.3, 0.5, -0.4}), Containment::b_in_a);
  expect_containment(large, {}, small, moved({0.9, 0.9, 0.9}), Containment::none);  // in the box, not in the ball
  expect_containment(large, {}, small, moved({1.5, 0, 0}), Containment::none);
  const CollisionResult crossing = collide(large, {}, small, moved({1, 0, 0}), kContainment);
  EXPECT_TRUE(crossing.hit());
  EXPECT_EQ(crossing.containment, Containment::none);
  EXPECT_NE(crossing.triangle_a, kNoTriangle);
  // Within the margin, it is a hit of surfaces, as without containment.
  const CollisionResult near = collide(large, {}, small, moved({0.7, 0, 0}), {.margin = 0.3, .containment = true});
  EXPECT_TRUE(near.hit());
  EXPECT_EQ(near.containment, Containment::none);
  EXPECT_EQ(collide(large, {}, small, {}, {.margin = 0.3, .containment = true}).containment, Containment::b_in_a);
}

TEST(Containment, ABallInACavityIsFree) {
  const Body hollow(joined({solid_ball(2, 8), turned_inside_out(solid_ball(1, 6))}));
  const Body small(solid_ball(0.2, 4)), large(solid_ball(3, 8)), core(solid_ball(1.5, 8));
  EXPECT_TRUE(hollow.has_inside());
  expect_containment(hollow, {}, small, {}, Containment::none);
  expect_containment(hollow, {}, small, moved({0.5, 0, 0}), Containment::none);
  expect_containment(hollow, {}, small, moved({0.8, 0.8, 0.8}), Containment::b_in_a);
  expect_containment(hollow, {}, large, {}, Containment::a_in_b);
  // A ball around the cavity: it is inside the hollow ball, and the wall of the cavity is inside it.
  expect_containment(hollow, {}, core, {}, Containment::b_in_a);
}

TEST(Containment, ABallInTheHoleOfATorusIsFree) {
  const Body torus(solid_torus(2, 0.5, 40, 16)), ball(solid_ball(0.4, 5));
  expect_containment(torus, {}, ball, {}, Containment::none);
  expect_containment(torus, {}, ball, moved({0, 0, 1}), Containment::none);
  expect_containment(torus, {}, ball, moved({2, 0, 0}), Containment::b_in_a);
  expect_containment(torus, {}, ball, moved({0, -2, 0.02}), Containment::b_in_a);
}

TEST(Containment, NestedBodies) {
  const std::vector<Body> balls{Body(solid_ball(3, 6)), Body(solid_ball(2, 6)), Body(solid_ball(1, 6))};
  for (std::size_t outer = 0; outer < 3; ++outer)
    for (std::size_t inner = outer + 1; inner < 3; ++inner)
      expect_containment(balls[outer], {}, balls[inner], moved({0.01, 0.02, 0.03}), Containment::b_in_a);
  // One body of three shells with the same orientation: winding numbers 1, 2 and 3 are all inside.
  const Body shells(joined({solid_ball(3, 6), solid_ball(2, 6), solid_ball(1, 6)}));
  const Body small(solid_ball(0.2, 4));
  for (const double x : {0.0, 1.5, 2.5}) expect_containment(shells, {}, small, moved({x, 0, 0}), Containment::b_in_a);
}

TEST(Containment, SomeComponentsInside) {
  const Body ball(solid_ball(1, 6));
  const Body pair(joined({solid_ball(0.2, 4), solid_ball(0.2, 4, {3, 0, 0})}));
  expect_containment(ball, {}, pair, {}, Containment::partly);
  expect_containment(ball, {}, pair, moved({-3, 0, 0}), Containment::partly);
  expect_containment(ball, {}, pair, moved({-1.5, 0, 0}), Containment::none);
  const Body two(joined({solid_ball(0.2, 4), solid_ball(0.2, 4, {0.5, 0, 0})}));
  expect_containment(ball, {}, two, {}, Containment::b_in_a);
  // Each has a component inside the other one.
  const Body a(joined({solid_ball(1, 6), solid_ball(0.2, 4, {5, 0, 0})}));
  const Body b(joined({solid_ball(0.2, 4), solid_ball(1, 6, {5, 0, 0})}));
  expect_containment(a, {}, b, {}, Containment::partly);
}

TEST(Containment, OpenBodiesContainNothingButMayBeContained) {
  Mesh bowl = solid_ball(1, 6);
  bowl.triangles.resize(bowl.triangles.size() - 1);
  const Body open(bowl), closed(solid_ball(3, 6)), small(solid_ball(0.2, 4));
  const Body sheet(one_triangle({0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}));
  EXPECT_FALSE(open.has_inside());
  EXPECT_FALSE(Body(ball_mesh(1, 6)).has_inside()) << "its octants are not oriented alike";
  EXPECT_EQ(code_of([&] { collide(open, {}, sheet, {}, kContainment); }), ErrorCode::input);
  EXPECT_EQ(code_of([&] { collide_all(open, {}, sheet, std::vector<Pose>(2), kContainment); }), ErrorCode::input);
  expect_containment(closed, {}, sheet, moved({1, 1, 1}), Containment::b_in_a);
  expect_containment(closed, {}, open, {}, Containment::b_in_a);
  expect_containment(open, {}, small, {}, Containment::none);
  expect_containment(Body(solid_box({1, 1, 1})), {}, sheet, {}, Containment::b_in_a);
}

TEST(Containment, ABodyTurnedInsideOutHoldsNothing) {
  const Body room(turned_inside_out(solid_box({1, 1, 1}))), ball(solid_ball(0.2, 4));
  EXPECT_TRUE(room.has_inside());
  expect_containment(room, {}, ball, {}, Containment::none);
  expect_containment(room, {}, ball, moved({3, 0, 0}), Containment::none);
  expect_containment(room, {}, Body(solid_ball(3, 6)), {}, Containment::a_in_b);
}

TEST(Containment, CertifiedModeDoesNotKnowIt) {
  const Body ball(solid_ball(1, 4));
  EXPECT_EQ(code_of([&] { collide(ball, {}, ball, {}, {.mode = CollideMode::certified, .containment = true}); }),
            ErrorCode::usage);
}

// Whether all corners are inside, none, or some, by solid angles.
Containment brute_containment(const Mesh& a, const Pose& pose_a, const Mesh& b, const Pose& pose_b) {
  const auto share = [](const Mesh& container, const Pose& pose, const Mesh& content, const Pose& at) {
    int inside = 0;
    for (const Vec3& v : content.vertices) inside += winding_by_angles(container, pose, apply(at, v)) > 0.5;
    return std::pair(inside > 0, inside == static_cast<int>(content.vertices.size()));
  };
  const auto [some_b, all_b] = share(a, pose_a, b, pose_b);
  const auto [some_a, all_a] = share(b, pose_b, a, pose_a);
  if (all_b || all_a) return all_b ? Containment::b_in_a : Containment::a_in_b;
  return some_a || some_b ? Containment::partly : Containment::none;
}

std::array<int, 4> expect_as_brute_force(const Mesh& a, const Mesh& b, int poses, double half, Vec3 far, double scale,
                                         unsigned seed) {
  Mesh scaled_a = a, scaled_b = b;
  for (Vec3& v : scaled_a.vertices) v = v * scale;
  for (Vec3& v : scaled_b.vertices) v = v * scale;
  const Body model_a(scaled_a), model_b(scaled_b);
  Random random(seed);
  std::array<int, 4> counts{};
  for (int n = 0; n < poses; ++n) {
    Pose pose_a = random_pose(random, half), pose_b = random_pose(random, half);
    for (Pose* pose : {&pose_a, &pose_b}) pose->translation = (pose->translation + far) * scale;
    const CollisionResult found = collide(model_a, pose_a, model_b, pose_b, kContainment);
    if (found.triangle_a != kNoTriangle) continue;
    const Containment expected = brute_containment(scaled_a, pose_a, scaled_b, pose_b);
    EXPECT_EQ(found.containment, expected) << "pose " << n;
    EXPECT_EQ(found.hit(), expected != Containment::none) << "pose " << n;
    ++counts[static_cast<std::size_t>(found.containment)];
  }
  return counts;
}

TEST(Containment, AgreesWithTheWindingNumbersOfAllCorners) {
  const Mesh torus = solid_torus(1, 0.6, 16, 8),
             small = joined({solid_ball(0.05, 1, {-0.3, 0, 0}), solid_ball(0.05, 1, {0.3, 0, 0}),
                             solid_box({0.03, 0.03, 0.1}, {0, 0.2, 0})});
  // Winding numbers 0 to 2, and -1 where a cavity sticks out.
  const Mesh overlapping = joined(
      {solid_ball(0.7, 3), solid_ball(0.7, 3, {0.5, 0, 0}), turned_inside_out(solid_ball(0.4, 3, {-0.5, 0, 0}))});
  for (const auto& [container, scale] :
       {std::pair(torus, 1.0), std::pair(torus, 1e-6), std::pair(torus, 1e6), std::pair(overlapping, 1.0)}) {
    const auto counts = expect_as_brute_force(container, small, 120, 0.6, {}, scale, 1);
    EXPECT_GT(counts[int(Containment::none)], 10);
    EXPECT_GT(counts[int(Containment::b_in_a)], 5);
    EXPECT_GT(counts[int(Containment::partly)], 5);
  }
  expect_as_brute_force(torus, small, 60, 0.6, {2e9, -1e9, 3e9}, 1, 2);  // where corners are rounded by 5e-7
  expect_as_brute_force(torus, small, 60, 0.6, {2e3, -1e3, 3e3}, 1e6, 3);
}

// Points a unit in the last place inside and outside of the wall, where the field cannot decide.
TEST(Containment, IsExactAtTheSurface) {
  const Body box(solid_box({1, 1, 1}));
  const double inside = std::nextafter(1.0, 0.0), outside = std::nextafter(1.0, 2.0);
  for (const double x : {inside, outside}) {
    const Containment expected = x < 1 ? Containment::b_in_a : Containment::none;
    for (const double sign : {1.0, -1.0}) {
      const double at = sign * x;
      expect_containment(box, {}, Body(one_triangle({at, 0, 0}, {at, 0.3, 0}, {at, 0, 0.3})), {}, expected);
      expect_containment(box, {}, Body(one_triangle({0, at, 0}, {0.3, at, 0}, {0, at, 0.3})), {}, expected);
      expect_containment(box, {}, Body(one_triangle({0, 0, at}, {0.3, 0, at}, {0, 0.3, at})), {}, expected);
    }
  }
  // Corners and edges of the wall seen from inside: the ray meets them.
  const Body dot(one_triangle({inside, inside, inside}, {inside, 0, inside}, {inside, inside, 0}));
  expect_containment(box, {}, dot, {}, Containment::b_in_a);
}

TEST(Containment, OfLoadedBodies) {
  const TempFolder folder;
  const Body a(joined({solid_ball(2, 8), turned_inside_out(solid_ball(1, 6))})),
      b(joined({solid_ball(0.2, 4), solid_ball(0.2, 4, {1.5, 0, 0})})), open(random_soup(3, 20, 1, 0.3));
  a.save(folder.path() / "a.body");
  b.save(folder.path() / "b.body");
  open.save(folder.path() / "open.body");
  const Body loaded_a = Body::load(folder.path() / "a.body"), loaded_b = Body::load(folder.path() / "b.body");
  EXPECT_TRUE(loaded_a.has_inside());
  EXPECT_FALSE(Body::load(folder.path() / "open.body").has_inside());
  Random random(5);
  for (int n = 0; n < 100; ++n) {
    const Pose pose = random_pose(random, 0.8);
    expect_same(collide(loaded_a, {}, loaded_b, pose, kContainment), collide(a, {}, b, pose, kContainment));
  }
}

TEST(Containment, BatchesGiveTheSame) {
  const Body a(solid_torus(1, 0.45, 24, 10)), b(joined({solid_ball(0.1, 2), solid_ball(0.1, 2, {0.4, 0, 0})}));
  Random random(6);
  std::vector<Pose> poses;
  for (int n = 0; n < 300; ++n) poses.push_back(random_pose(random, 0.8));
  const Pose pose_a = make_pose({1, 2, 3}, 0.3, {0.1, 0.2, 0});
  const auto on_cpu = collide_all(a, pose_a, b, poses, kContainment, {.threads = 2, .backend = Backend::cpu}).results;
  const auto [on_device, report] =
      collide_all(a, pose_a, b, poses, kContainment, {.threads = 2, .backend = testing::kEmulated});
  EXPECT_EQ(report.on_device + report.undecided + report.overflowed > 0, true);
  ASSERT_EQ(on_cpu.size(), poses.size());
  ASSERT_EQ(on_device.size(), poses.size());
  int contained = 0;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    expect_same(on_cpu[n], collide(a, pose_a, b, poses[n], kContainment));
    EXPECT_EQ(on_device[n].verdict, on_cpu[n].verdict);
    EXPECT_EQ(on_device[n].containment, on_cpu[n].containment);
    contained += on_cpu[n].containment == Containment::b_in_a;
  }
  EXPECT_GT(contained, 5);
}

}  // namespace
}  // namespace standoff
