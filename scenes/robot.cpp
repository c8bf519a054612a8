// SPDX-License-Identifier: Apache-2.0
// A standing robot with spread arms: barrel body, domed head with antenna and visor, ribbed hoses for limbs.
#include "scenes/families.h"
#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

// A ribbed hose: its radius goes up and down along the path.
void hose(Builder& b, const Frame& f, Vec3 from, Vec3 sag, Vec3 to, double radius, int ribs) {
  std::vector<Vec3> path;
  std::vector<double> radii;
  for (int i = 0; i <= 2 * ribs; ++i) {
    const double t = i / (2.0 * ribs), s = 1 - t;
    path.push_back(from * (s * s) + sag * (2 * s * t) + to * (t * t));
    radii.push_back(radius * (i % 2 == 0 ? 1.0 : 0.86));
  }
  sweep(b, f, path, radii, b.sides(radius, 10));
}

void hand(Builder& b, const Frame& f) {  // the arm arrives along the y axis
  cone(b, f, 0.2, 0.32, 0.35, 12);
  cylinder(b, f.at(0, 0.35, 0), 0.32, 0.1, 12);
  for (int finger = 0; finger < 3; ++finger) {
    const auto [c, s] = circle(finger / 3.0 + 0.05);
    const std::vector<Vec3> path{{0.16 * c, 0.4, 0.16 * s},
                                 {0.26 * c, 0.62, 0.26 * s},
                                 {0.27 * c, 0.8, 0.27 * s},
                                 {0.22 * c, 0.95, 0.22 * s},
                                 {0.2 * c, 1.0, 0.2 * s}};
    sweep(b, f, path, {0.1, 0.11, 0.105, 0.09, 0.03}, b.sides(0.1, 8));
  }
}

void head(Builder& b, const Frame& f) {
  std::vector<Point2> shell{{0, 0}, {0.52, 0}, {0.52, 0.06}, {0.48, 0.1}, {0.48, 0.9}};
  append_dome(shell, 0.48, 0.9, 0.42, b.segments(0.7, 5), true);
  shell.erase(shell.begin() + 5);  // the dome starts where the cylinder ends
  lathe(b, f, shell, b.sides(0.5, 16));
  const std::vector<Point2> antenna{{0, 1.28},     {0.14, 1.28}, {0.1, 1.36},  {0.05, 1.4},
                                    {0.028, 1.85}, {0.07, 1.88}, {0.07, 1.96}, {0, 1.99}};
  lathe(b, f, antenna, b.sides(0.1, 10));
  // Visor with two eyes, and a barred mouth.
  const Frame face = f.at(0, 0.78, 0.36).y_to_z();
  const std::vector<Point2> oval{{-0.34, -0.15}, {0.34, -0.15}, {0.44, -0.08}, {0.44, 0.08},
                                 {0.34, 0.15},   {-0.34, 0.15}, {-0.44, 0.08}, {-0.44, -0.08}};
  extrude(b, face, oval, 0.3);
  for (const double side : {-1.0, 1.0}) {
    ellipsoid(b, f.at(0.19 * side, 0.78, 0.64), {0.13, 0.13, 0.06}, 10);
    cylinder(b, f.at(0.19 * side, 0.78, 0.69).y_to_z(), 0.035, 0.03, 8);
  }
  box(b, f, {-0.3, 0.22, 0.36}, {0.3, 0.46, 0.5});
  for (int i = 0; i < 4; ++i) box(b, f, {-0.26 + 0.16 * i, 0.2, 0.49}, {-0.22 + 0.16 * i, 0.48, 0.53});
  box(b, f, {-0.32, 0.33, 0.49}, {0.32, 0.36, 0.53});
}

}  // namespace

void draw_bender(Builder& b) {
  const Frame f = Frame{}.at(0, 1.75, 0);
  const std::vector<Point2> barrel{{0, 0},      {0.7, 0},    {0.72, 0.05}, {0.95, 1.75},
                                   {0.93, 1.8}, {0.5, 2.05}, {0.42, 2.06}, {0, 2.06}};
  lathe(b, f, barrel, b.sides(0.9, 18));
  tube(b, f.at(0, 2.0, 0), 0.44, 0.36, 0.12, 16);
  head(b, f.at(0, 2.1, 0));
  // The door in the chest leans forward as the barrel does.
  const Frame door = f.at(0, 0.5, 0.74).about_x(0.0215);
  box(b, door, {-0.42, 0.05, -0.3}, {0.42, 1.0, 0.12});
  for (const double y : {0.0, 1.0}) box(b, door, {-0.46, y, -0.3}, {0.46, y + 0.05, 0.15});
  for (const double x : {-0.46, 0.42}) box(b, door, {x, 0.05, -0.3}, {x + 0.04, 1.0, 0.15});
  cylinder(b, door.at(0.28, 0.52, 0.11).y_to_z(), 0.07, 0.08, 10);
  for (const double side : {-1.0, 1.0}) {
    cylinder(b, side > 0 ? f.at(0.75, 1.5, 0).y_to_x() : f.at(-0.75, 1.5, 0).y_to_x().y_to_minus_y(), 0.3, 0.32, 14);
    hose(b, f, {1.0 * side, 1.5, 0}, {1.9 * side, 1.75, 0.05}, {2.85 * side, 1.55, 0}, 0.21, 11);
    hand(b, f * along({2.75 * side, 1.56, 0}, {3.75 * side, 1.4, 0}));
    hose(b, f, {0.36 * side, 0.1, 0}, {0.42 * side, -0.75, 0.04}, {0.5 * side, -1.45, 0}, 0.22, 9);
    std::vector<Point2> foot{{0, 0}, {0.46, 0}, {0.46, 0.05}};
    append_dome(foot, 0.44, 0.05, 0.36, b.segments(0.6, 4), true);
    lathe(b, Frame{}.at(0.5 * side, 0, 0.05).scaled(1, 1, 1.25), foot, b.sides(0.46, 14));
  }
}

}  // namespace standoff::scenes
