// SPDX-License-Identifier: Apache-2.0
// The solids of the scenes: closed, oriented outwards, without flat triangles.
#include <gtest/gtest.h>

#include "scenes/drives.h"
#include "scenes/scenes.h"
#include "scenes/steel.h"
#include "scenes/vessels.h"
#include "tests/scenes/topology.h"

namespace standoff {
namespace {

using namespace scenes;

// Every part of a mesh is a solid; rounding may leave nearly flat splits of the largest triangles alone.
void expect_solids(const Mesh& mesh, const std::string& name) {
  ASSERT_FALSE(mesh.triangles.empty()) << name;
  EXPECT_EQ(unmatched_edges(mesh), 0) << name;
  EXPECT_EQ(flat_triangles(mesh), 0) << name;
  for (const double volume : part_volumes(mesh)) ASSERT_GT(volume, 0) << name;
}

TEST(Closed, EveryPartOfTheLibraryAtSeveralFinenesses) {
  const std::vector<std::pair<const char*, void (*)(Builder&, const Frame&)>> parts{
      {"box",
       [](Builder& b, const Frame& f) {
         box(b, f, {-1, -2, -3}, {1, 2, 3});
       }},
      {"beam",
       [](Builder& b, const Frame& f) {
         beam(b, f, {0, 0, 0}, {1, 2, 3}, 0.2, 0.3);
       }},
      {"cylinder", [](Builder& b, const Frame& f) { cylinder(b, f, 0.5, 2); }},
      {"cone", [](Builder& b, const Frame& f) { cone(b, f, 0.5, 0, 2); }},
      {"tube", [](Builder& b, const Frame& f) { tube(b, f, 0.5, 0.3, 2); }},
      {"torus", [](Builder& b, const Frame& f) { torus(b, f, 1, 0.3); }},
      {"ellipsoid",
       [](Builder& b, const Frame& f) {
         ellipsoid(b, f, {1, 0.5, 0.7});
       }},
      {"gear", [](Builder& b, const Frame& f) { gear(b, f, 1, 0.3, 15); }},
      {"pipe",
       [](Builder& b, const Frame& f) {
         pipe(b, f, {{0, 0, 0}, {2, 0, 0}, {2, 2, 1}, {0, 3, 3}}, 0.2, 0.5);
       }},
      {"coil", [](Builder& b, const Frame& f) { coil(b, f, 1, 0.1, 1, 3); }},
      {"i_beam",
       [](Builder& b, const Frame& f) {
         i_beam(b, f, {0, 0, 0}, {2, 1, 0}, 0.4, 0.3);
       }},
      {"bolts", [](Builder& b, const Frame& f) { bolt_circle(b, f, 1, 5, 0.3); }},
      {"column", [](Builder& b, const Frame& f) { column(b, f, 3, 0.3); }},
      {"truss",
       [](Builder& b, const Frame& f) {
         truss(b, f, {0, 0, 0}, {4, 0, 0}, 0.5, 6);
       }},
      {"ladder", [](Builder& b, const Frame& f) { ladder(b, f, 0.5, 4, true); }},
      {"stairs", [](Builder& b, const Frame& f) { stairs(b, f, 1, 2, 3); }},
      {"catwalk", [](Builder& b, const Frame& f) { catwalk(b, f, 1, 5, 1); }},
      {"valve", [](Builder& b, const Frame& f) { valve(b, f, 0.5); }},
      {"standing_tank", [](Builder& b, const Frame& f) { standing_tank(b, f, 1, 3); }},
      {"lying_tank", [](Builder& b, const Frame& f) { lying_tank(b, f, 1, 4); }},
      {"heat_exchanger", [](Builder& b, const Frame& f) { heat_exchanger(b, f, 0.5, 3); }},
      {"silo", [](Builder& b, const Frame& f) { silo(b, f, 1, 4); }},
      {"hopper", [](Builder& b, const Frame& f) { hopper(b, f, 1, 1.5, 2); }},
      {"motor", [](Builder& b, const Frame& f) { motor(b, f, 1); }},
      {"gear_box", [](Builder& b, const Frame& f) { gear_box(b, f, 1); }},
      {"pump", [](Builder& b, const Frame& f) { pump(b, f, 1); }},
      {"fan", [](Builder& b, const Frame& f) { fan(b, f, 1); }},
      {"roll", [](Builder& b, const Frame& f) { roll(b, f, 0.5, 3); }},
      {"wheel", [](Builder& b, const Frame& f) { wheel(b, f, 1, 0.2, 6); }},
      {"conveyor", [](Builder& b, const Frame& f) { conveyor(b, f, 4, 1, 1); }},
      {"cabinet", [](Builder& b, const Frame& f) { cabinet(b, f, 1, 2, 0.5); }},
      {"machine_tool", [](Builder& b, const Frame& f) { machine_tool(b, f, 1); }},
      {"press", [](Builder& b, const Frame& f) { press(b, f, 1); }},
      {"robot_arm", [](Builder& b, const Frame& f) { robot_arm(b, f, 1, 7); }},
  };
  const Frame tilted = Frame{{3, -2, 5}}.about_x(0.1).about_z(0.3).about_y(0.7);
  for (const auto& [name, draw] : parts)
    for (const double edge : {0.5, 0.11, 0.03}) {
      Builder counted(edge, true), made(edge, false, 1, 0.5);
      draw(counted, tilted);
      draw(made, tilted);
      const Mesh mesh = made.take();
      EXPECT_EQ(counted.triangle_count(), static_cast<std::int64_t>(mesh.triangles.size())) << name;
      if (mesh.triangles.empty()) continue;  // hidden at a coarse edge
      expect_solids(mesh, name);
    }
}

class ClosedScene : public testing::TestWithParam<std::string> {};

TEST_P(ClosedScene, AllPartsAreSolid) { expect_solids(make(GetParam()), GetParam()); }

INSTANTIATE_TEST_SUITE_P(Table, ClosedScene,
                         testing::Values("machine_1", "bender", "catapult", "process", "labyrinth", "fly", "sphere",
                                         "box"),
                         [](const auto& test) { return test.param; });

TEST(Closed, TheFactoryIsSolidAtASmallSizeToo) { expect_solids(make("factory", 300000), "factory"); }

TEST(Closed, OnlyTheNamedPartsAreOpen) {
  // The ends of four exhaust stubs, and of one chute.
  const Mesh plane = make("plane"), process = make("our_process");
  EXPECT_GT(unmatched_edges(plane), 0);
  EXPECT_LT(unmatched_edges(plane), 8 * 64);
  EXPECT_GT(unmatched_edges(process), 0);
  EXPECT_LT(unmatched_edges(process), 64);
}

}  // namespace
}  // namespace standoff
