// SPDX-License-Identifier: Apache-2.0
// A catapult of timbers, wheels and ropes. Its triangles are large: beams are boxes that are not divided.
#include "scenes/drives.h"
#include "scenes/families.h"

namespace standoff::scenes {
namespace {

// A carriage wheel: rim of felloes, iron tyre, hub and spokes; its axle lies along z.
void carriage_wheel(Builder& b, const Frame& f) {
  const Frame lying = f.y_to_z();
  tube(b, lying.at(0, -0.07, 0), 0.56, 0.44, 0.14, 24);
  tube(b, lying.at(0, -0.05, 0), 0.58, 0.56, 0.1, 24);
  const std::vector<Point2> hub{{0, -0.16}, {0.08, -0.16}, {0.13, -0.06}, {0.13, 0.06}, {0.08, 0.16}, {0, 0.16}};
  lathe(b, lying, hub, 12);
  for (int i = 0; i < 10; ++i) beam(b, lying.about_y(i / 10.0), {0.1, 0, 0}, {0.46, 0, 0}, 0.05, 0.06);
}

// The square head of a forged nail.
void nail(Builder& b, const Frame& f) { box(b, f, {-0.03, -0.02, -0.03}, {0.03, 0.02, 0.03}); }

void carriage(Builder& b) {
  const Frame f;
  for (const double z : {-0.8, 0.8}) {
    box(b, f, {-2.1, 0.5, z - 0.13}, {2.1, 0.85, z + 0.13});
    box(b, f, {-1.9, 0.85, z - 0.09}, {-0.2, 0.95, z + 0.09});
  }
  for (const double x : {-1.95, -1.1, -0.1, 0.9, 1.95}) box(b, f, {x - 0.11, 0.55, -0.95}, {x + 0.11, 0.8, 0.95});
  for (int i = 0; i < 18; ++i) {
    const double x = -1.85 + i * 0.1;
    box(b, f, {x, 0.8, -0.67}, {x + 0.09, 0.85, 0.67});
    for (const double z : {-0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6}) nail(b, f.at(x + 0.045, 0.85, z));
  }
  for (const double z : {-0.8, 0.8})
    for (int i = 0; i < 11; ++i) {
      const double x = -2 + 0.4 * i;
      box(b, f, {x - 0.03, 0.49, z - 0.14}, {x + 0.03, 0.86, z + 0.14});
      for (const double side : {-0.15, 0.15}) nail(b, f.at(x, 0.6, z + side));
    }
  for (const double x : {-1.5, 1.5}) {
    rod(b, f, {x, 0.56, -1.4}, {x, 0.56, 1.4}, 0.06, 10);
    for (const double z : {-1.2, 1.2}) carriage_wheel(b, f.at(x, 0.58, z));
    for (const double z : {-1.36, 1.36}) cylinder(b, f.at(x, 0.56, z).y_to_z().at(0, -0.03, 0), 0.1, 0.06, 8);
  }
}

// Uprights with braces and the padded crossbar that stops the arm.
void tower(Builder& b) {
  const Frame f;
  for (const double z : {-0.8, 0.8}) {
    box(b, f, {0.15, 0.85, z - 0.11}, {0.45, 3.1, z + 0.11});
    beam(b, f, {-1.2, 0.85, z}, {0.25, 2.7, z}, 0.16, 0.16);
    beam(b, f, {1.7, 0.85, z}, {0.4, 2.5, z}, 0.16, 0.16);
    box(b, f, {-0.5, 1.6, z - 0.07}, {1.05, 1.75, z + 0.07});
    for (const double y : {1.1, 1.68, 2.6}) box(b, f, {0.12, y - 0.06, z - 0.14}, {0.48, y + 0.06, z + 0.14});
  }
  box(b, f, {0.12, 2.75, -1.05}, {0.48, 3.05, 1.05});
  for (int i = 0; i < 6; ++i) torus(b, f.at(0.3, 2.9, -0.25 + i * 0.1).y_to_z(), 0.25, 0.055, 10);
  box(b, f, {0.18, 1.2, -0.7}, {0.42, 1.35, 0.7});
}

// The arm, held down at its back, with its spoon and the stone in it; the twisted ropes that throw it.
void arm(Builder& b) {
  const Vec3 foot{0.35, 1.0, 0}, tip{-2.05, 2.2, 0};
  const Frame f;
  beam(b, f, foot, tip, 0.18, 0.2);
  const Vec3 step = (tip - foot) * (1.0 / 8);
  for (int i = 1; i < 8; ++i) beam(b, f, foot + step * (i - 0.1), foot + step * (i + 0.1), 0.21, 0.23);
  const Frame spoon = f * along(foot, tip).at(0, length(tip - foot), 0);
  const Frame bowl = f.at(tip + Vec3{-0.18, 0.12, 0});
  const std::vector<Point2> cup{{0, -0.18},   {0.16, -0.15}, {0.3, 0},      {0.34, 0.14},
                                {0.28, 0.14}, {0.24, 0.02},  {0.12, -0.08}, {0, -0.1}};
  lathe(b, bowl, cup, 16);
  ellipsoid(b, bowl.at(0, 0.1, 0), {0.22, 0.22, 0.22}, 12);
  for (const double x : {-0.06, 0.06}) rod(b, spoon, {x, -0.3, 0}, {x, 0.12, 0.06}, 0.03, 6);
  for (int i = 0; i < 12; ++i) {
    const auto [c, s] = circle(i / 12.0);
    rod(b, f, {0.35 + 0.1 * c, 1.0 + 0.1 * s, -0.98}, {0.35 - 0.1 * c, 1.0 - 0.1 * s, 0.98}, 0.035, 6);
  }
  for (const double z : {-0.95, 0.95}) {
    tube(b, f.at(0.35, 1.0, z).y_to_z().at(0, -0.04, 0), 0.24, 0.14, 0.08, 16);
    beam(b, f, {0.35, 0.7, z * 1.04}, {0.35, 1.3, z * 1.04}, 0.05, 0.05);
  }
}

// Ropes that stay the tower: long, thin and aslant, they have the largest boxes of all.
void stays(Builder& b) {
  for (const double z : {-1.0, 1.0})
    for (const double x : {-2.05, 2.05}) {
      const Vec3 top{0.3, 3.08, z}, foot{x, 0.86, 0.8 * z};
      rod(b, {}, foot, top, 0.025, 6);
      torus(b, Frame{}.at(foot), 0.07, 0.03, 8);
    }
}

// The windlass that pulls the arm down, and its rope.
void windlass(Builder& b) {
  const Frame f = Frame{}.at(-1.75, 1.15, 0);
  for (const double z : {-0.8, 0.8}) {
    box(b, f, {-0.14, -0.3, z - 0.1}, {0.14, 0.2, z + 0.1});
    gear(b, f.at(0, 0, z * 1.2).y_to_z(), 0.2, 0.06, 12);
    for (int i = 0; i < 4; ++i) {
      const auto [c, s] = circle(0.07 + i / 4.0);
      rod(b, f.at(0, 0, z * 1.38), {0, 0, 0}, {0.5 * c, 0.5 * s, 0}, 0.03, 6);
    }
  }
  cylinder(b, f.at(0, 0, -1.2).y_to_z(), 0.11, 2.4, 12);
  for (int i = 0; i < 7; ++i) torus(b, f.at(0, 0, -0.12 + i * 0.04).y_to_z(), 0.13, 0.02, 10);
  pipe(b, Frame{}, {{-1.75, 1.28, 0}, {-1.8, 1.6, 0}, {-1.95, 2.1, 0}}, 0.02, 0, 6);
}

// Iron plates with nails at the joints.
void joints(Builder& b) {
  const Frame f;
  for (const double side : {-0.94, 0.94}) {
    for (const double x : {-1.95, -1.1, -0.1, 0.9, 1.95}) {
      box(b, f, {x - 0.15, 0.55, side - 0.01}, {x + 0.15, 0.8, side + 0.01});
      for (const double dx : {-0.1, 0.1})
        for (const double y : {0.6, 0.75}) nail(b, f.at(x + dx, y, side));
    }
    for (const double y : {1.1, 1.68, 2.6})
      for (const double dx : {-0.12, 0.0, 0.12}) nail(b, f.at(0.3 + dx, y, side));
  }
}

}  // namespace

void draw_catapult(Builder& b) {
  carriage(b);
  tower(b);
  arm(b);
  stays(b);
  windlass(b);
  joints(b);
}

}  // namespace standoff::scenes
