// SPDX-License-Identifier: Apache-2.0
// A paper machine along z: head box, wire, presses, drying cylinders, calender, reel. machine_2 is the same machine
// with its hood, its piping and its small parts.

#include "scenes/drives.h"
#include "scenes/families.h"
#include "scenes/steel.h"
#include "scenes/vessels.h"

namespace standoff::scenes {
namespace {

constexpr double kHalf = 1.6;  // half the width of the web; rolls lie along x between the side frames

// A roll whose middle is at (y, z).
void web_roll(Builder& b, double y, double z, double r) { roll(b, Frame{}.at(-kHalf, y, z), r, 2 * kHalf); }

// A sheet of paper or felt that runs over the given points of the (y, z) plane.
void web(Builder& b, const std::vector<Point2>& path) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3 from{0, path[i - 1].u, path[i - 1].v}, to{0, path[i].u, path[i].v};
    const Vec3 y = normalized(to - from);
    const Frame f{from, {1, 0, 0}, y, cross({1, 0, 0}, y)};
    box(b, f, {-0.95 * kHalf, 0, -0.008}, {0.95 * kHalf, length(to - from), 0.008});
  }
}

// Both side frames from z0 to z1: sole plates, posts, beams on top.
void side_frames(Builder& b, double z0, double z1, double height, int posts) {
  const Frame f;
  for (const double side : {-1.0, 1.0}) {
    const double x = side * (kHalf + 0.28);
    box(b, f, {x - 0.18, 0, z0}, {x + 0.18, 0.12, z1});
    box(b, f, {x - 0.12, height - 0.2, z0}, {x + 0.12, height, z1});
    for (int i = 0; i <= posts; ++i) {
      const double z = z0 + 0.15 + (z1 - z0 - 0.3) * i / posts;
      box(b, f, {x - 0.1, 0.12, z - 0.12}, {x + 0.1, height - 0.2, z + 0.12});
      bolt_circle(b, f.at(x, 0.12, z), 0.16, 4, 0.05);
      bolt_circle(b, f.at(x, height, z), 0.09, 6, 0.04);
    }
  }
}

void head_box(Builder& b) {
  const Frame f;
  const std::vector<Point2> outline{{-0.9, 0}, {0.7, 0}, {0.9, 0.35}, {0.1, 1.5}, {-0.4, 1.8}, {-0.9, 1.5}};
  // The outline lies in the (z, y) plane, the box along x.
  const Frame across{{kHalf, 1.2, -10.3}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}};
  extrude(b, across, outline, 2 * kHalf);
  for (int i = 0; i < 9; ++i) {
    const double x = -kHalf + 0.2 + i * (2 * kHalf - 0.4) / 8;
    const std::vector<Vec3> path{{x, 0.4, -10.9}, {x, 0.9, -11.25}, {x, 2.0, -11.25}, {x, 2.2, -10.9}};
    flanged_pipe(b, f, path, 0.07);
  }
  cylinder(b, f.at(-kHalf - 0.6, 0.4, -10.9).y_to_x(), 0.22, 2 * kHalf + 1.2, 16);
  side_frames(b, -11.3, -9.2, 1.2, 3);
}

void wire_section(Builder& b) {
  side_frames(b, -9.1, -5.2, 1.9, 5);
  web_roll(b, 2.1, -9.0, 0.32);
  web_roll(b, 2.0, -5.5, 0.4);
  for (int i = 0; i < 9; ++i) web_roll(b, 2.27, -8.4 + i * 0.3, 0.09);
  for (int i = 0; i < 5; ++i) {
    web_roll(b, 0.7, -8.6 + i * 0.7, 0.14);
    box(b, Frame{}, {-kHalf, 2.1, -5.95 - i * 0.12}, {kHalf, 2.34, -5.88 - i * 0.12});
  }
  web(b, {{2.43, -9.0}, {2.4, -5.5}});
  web(b, {{1.6, -5.4}, {0.56, -5.9}, {0.56, -8.6}, {1.8, -9.1}});
  std::vector<Point2> outline{{-1.5, -0.4}, {1.5, -0.4}, {1.5, 0.4}, {-1.5, 0.4}};
  extrude(b, Frame{}.at(0, 0.15, -7.2), outline, 0.25);
}

void press_section(Builder& b) {
  side_frames(b, -5.0, -1.6, 2.6, 4);
  for (int i = 0; i < 3; ++i) {
    const double z = -4.5 + i * 1.15;
    web_roll(b, 1.4, z, 0.38);
    web_roll(b, 2.18, z + 0.05, 0.38);
    web_roll(b, 2.9, z + 0.3, 0.12);
    web_roll(b, 0.7, z + 0.4, 0.12);
    web_roll(b, 3.1, z - 0.2, 0.12);
    web(b, {{1.8, z - 0.5}, {1.8, z + 0.6}});
    web(b, {{2.6, z}, {3.02, z + 0.3}, {3.22, z - 0.2}, {2.5, z - 0.3}});
    for (const double side : {-1.0, 1.0}) {
      const Frame arm = Frame{}.at(side * (kHalf + 0.3), 2.6, z);
      cylinder(b, arm, 0.11, 0.7, 12);
      cylinder(b, arm.at(0, 0.7, 0), 0.05, 0.35);
      box(b, arm, {-0.14, 0, -0.25}, {0.14, 0.15, 0.25});
      bolt_circle(b, arm.at(0, 0.7, 0), 0.08, 6, 0.03);
    }
  }
}

// Two tiers of drying cylinders with the web winding between them, gears on the drive side.
void drying_section(Builder& b, bool detailed) {
  constexpr int kCylinders = 9;
  side_frames(b, -1.4, 7.6, 3.1, 10);
  std::vector<Point2> path;
  for (int i = 0; i < kCylinders; ++i) {
    const double z = -0.9 + i * 0.98;
    web_roll(b, 1.15, z, 0.44);
    path.push_back({0.72, z});
    if (i + 1 < kCylinders) {
      web_roll(b, 2.3, z + 0.49, 0.44);
      path.push_back({2.73, z + 0.49});
    }
    web_roll(b, 3.3, z + 0.49, 0.1);
    web_roll(b, 0.35, z + 0.49, 0.1);
    const double x = kHalf + 0.62;
    gear(b, Frame{}.at(x, 1.15, z).y_to_x(), 0.5, 0.1, 48);
    gear(b, Frame{}.at(x, 2.3, z + 0.49).y_to_x(), 0.5, 0.1, 48);
    gear(b, Frame{}.at(x, 1.72, z + 0.24).y_to_x(), 0.2, 0.1, 20);
    const Frame joint = Frame{}.at(-kHalf - 0.75, 1.15, z).y_to_x().y_to_minus_y();
    nozzle(b, joint, 0.1, 0.2);
    const std::vector<Vec3> steam{
        Vec3{-kHalf - 0.95, 1.15, z}, {-kHalf - 1.15, 1.15, z}, {-kHalf - 1.15, 0.3, z}, {-kHalf - 1.4, 0.3, z}};
    flanged_pipe(b, Frame{}, steam, 0.05);
    if (!detailed) continue;
    valve(b, Frame{}.at(-kHalf - 1.15, 0.7, z).about_z(0.25), 0.055);
    bolt_circle(b, Frame{}.at(kHalf + 0.01, 1.15, z).y_to_x(), 0.36, 24, 0.035);
    bolt_circle(b, Frame{}.at(kHalf + 0.01, 2.3, z + 0.49).y_to_x(), 0.36, 24, 0.035);
    beam(b, Frame{}, {-kHalf, 0.62, z - 0.35}, {kHalf, 0.62, z - 0.35}, 0.04, 0.16);  // doctor blade
  }
  web(b, path);
  cylinder(b, Frame{}.at(-kHalf - 1.4, 0.3, -1.4).y_to_z(), 0.12, 9, 16);
}

void calender_and_reel(Builder& b) {
  side_frames(b, 7.8, 9.2, 3.4, 2);
  for (int i = 0; i < 6; ++i) web_roll(b, 0.6 + i * 0.5, 8.5, i % 2 == 0 ? 0.26 : 0.2);
  side_frames(b, 9.4, 11.4, 1.2, 3);
  web_roll(b, 1.5, 9.8, 0.35);
  web_roll(b, 1.75, 10.75, 0.6);
  web(b, {{3.3, 8.5}, {2.4, 9.4}, {1.85, 9.8}});
}

void drives(Builder& b, bool detailed) {
  for (int i = 0; i < 11; ++i) {
    const double z = -9 + i * 1.95;
    const Frame f = Frame{}.at(kHalf + 1.05, 0, z);
    gear_box(b, f.at(0, 0.3, 0), 0.32);
    box(b, f, {-0.35, 0, -0.25}, {1.75, 0.3, 0.25});
    motor(b, f.at(0.55, 0.3, 0), 0.22);
    tube(b, f.at(0.4, 0.5, 0).y_to_x(), 0.1, 0.04, 0.14, 12);
    if (detailed) bolt_circle(b, f.at(0.54, 0.5, 0).y_to_x(), 0.07, 8, 0.02);
  }
}

void walkways(Builder& b) {
  for (const double side : {-1.0, 1.0}) {
    const double x = side < 0 ? -kHalf - 1.15 : kHalf + 0.65;
    catwalk(b, Frame{}.at(x, 3.45, -5.2), 0.5, 13, 0.5);
    for (int i = 0; i < 9; ++i)
      i_beam(b, Frame{}, {x + 0.25, 0, -5 + i * 1.58}, {x + 0.25, 3.35, -5 + i * 1.58}, 0.12, 0.1);
    stairs(b, Frame{}.at(x + 0.25, 0, -8.7), 0.45, 3.45, 3.4);
  }
}

// The hood above the drying section, of frames and ducts.
void hood(Builder& b) {
  const Frame f;
  for (int i = 0; i < 7; ++i) {
    const double z = -1.3 + i * 1.48;
    for (const double side : {-1.0, 1.0}) i_beam(b, f, {side * 1.9, 3.1, z}, {side * 1.9, 4.5, z}, 0.1, 0.08);
    truss(b, f, {-1.9, 4.5, z}, {1.9, 4.5, z}, 0.3, 10);
  }
  for (const double x : {-1.2, 0.0, 1.2}) {
    cylinder(b, f.at(x, 5.05, -1.4).y_to_z(), 0.22, 9.2, 16);
    for (int i = 0; i < 9; ++i) tube(b, f.at(x, 5.05, -1.2 + i).y_to_z(), 0.25, 0.21, 0.05, 16);
    for (int i = 0; i < 4; ++i) cone(b, f.at(x, 4.4, -0.2 + i * 2.2), 0.35, 0.16, 0.5, 12);
  }
}

void small_piping(Builder& b) {
  for (int i = 0; i < 40; ++i) {
    const double z = -10.5 + i * 0.53, r = 0.02 + 0.01 * (i % 3);
    const std::vector<Vec3> path{{-kHalf - 0.5, 0.15, z},
                                 {-kHalf - 0.9, 0.15, z},
                                 {-kHalf - 0.9, 1.0 + 0.1 * (i % 5), z},
                                 {-kHalf - 0.5, 1.0 + 0.1 * (i % 5), z},
                                 {-kHalf - 0.5, 1.0 + 0.1 * (i % 5), z + 0.3}};
    flanged_pipe(b, Frame{}, path, r);
    if (i % 2 == 0) valve(b, Frame{}.at(-kHalf - 0.9, 0.6, z).about_z(0.25), 1.3 * r);
  }
  for (int i = 0; i < 12; ++i)
    coil(b, Frame{}.at(kHalf + 0.75, 0.2 + 0.05 * (i % 4), -9.8 + i * 1.8), 0.09, 0.015, 0.35, 8);
}

void paper_machine(Builder& b, bool detailed) {
  head_box(b);
  wire_section(b);
  press_section(b);
  drying_section(b, detailed);
  calender_and_reel(b);
  drives(b, detailed);
  walkways(b);
  hood(b);
  if (detailed) small_piping(b);
  const Builder::Coarser flat(b, 2);
  for (int i = 0; i < 4; ++i) cabinet(b, Frame{}.at(-2.9, 0, 9.2 + i * 0.55).about_y(-0.25), 0.5, 1.1, 0.3);
}

}  // namespace

void draw_machine_1(Builder& b) { paper_machine(b, false); }
void draw_machine_2(Builder& b) { paper_machine(b, true); }

}  // namespace standoff::scenes
