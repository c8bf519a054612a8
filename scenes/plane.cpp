// SPDX-License-Identifier: Apache-2.0
// An aeroplane with two propellers that flies along +z; its wings lie along x.
#include "scenes/drives.h"
#include "scenes/families.h"
#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

constexpr double kFine = 0.25;  // the target edge of engines, wheels and windows, as a part of that of the hull

// An aerofoil in the (y, z) plane, its leading edge at z = +chord/2, listed so that sections along +x face outwards.
std::vector<Vec3> aerofoil(double x, double y, double z, double chord, double thickness, int n) {
  std::vector<Vec3> section;
  for (int i = 0; i < n; ++i) {
    const auto [c, s] = circle(double(i) / n);
    const double t = 0.5 * (1 - c);  // 0 at the leading edge
    const double half = 2.6 * thickness * chord * (std::sqrt(t) - t) * (1 - 0.35 * t) + 0.002 * chord;
    section.push_back({x, y + (s >= 0 ? -half : half), z + chord * (0.5 - t)});
  }
  return section;
}

// A wing, tailplane or fin from root to tip; `up` turns it upright.
void surface(Builder& b, const Frame& f, Vec3 root, double root_chord, Vec3 tip, double tip_chord, double thickness) {
  const int spans = b.segments(length(tip - root), 4), n = 2 * b.segments(0.5 * (root_chord + tip_chord), 8);
  std::vector<std::vector<Vec3>> sections;
  for (int i = 0; i <= spans; ++i) {
    const double t = double(i) / spans;
    const Vec3 at = root + (tip - root) * t;
    sections.push_back(aerofoil(at.x, at.y, at.z, root_chord + (tip_chord - root_chord) * t, thickness, n));
  }
  loft(b, f, sections);
}

// A surface of revolution without ends: the exhaust stubs are the only open parts of the aeroplane.
void open_stub(Builder& b, const Frame& f, double r, double length) {
  const int sides = b.sides(r, 10), rows = b.segments(length);
  Ring below{};
  for (int row = 0; row <= rows; ++row) {
    const Ring above = b.ring(sides, true, [&](int i) {
      const auto [c, s] = circle(double(i) / sides);
      return f({r * s, length * row / rows, r * c});
    });
    if (row > 0) b.stitch(below, above);
    below = above;
  }
  b.end_part();
}

void fuselage(Builder& b, const Frame& f) {
  std::vector<Point2> profile{{0, -3.3},   {0.05, -3.28}, {0.12, -2.9}, {0.3, -1.8}, {0.44, -0.6}, {0.47, 0.6},
                              {0.47, 1.8}, {0.42, 2.4},   {0.3, 2.85},  {0.16, 3.1}, {0, 3.2}};
  lathe(b, f.y_to_z(), profile, b.sides(0.45, 20));
  for (const double side : {-1.0, 1.0}) {
    const Builder::Coarser fine(b, kFine);
    for (int i = 0; i < 9; ++i) {
      const Frame pane = f.at(0.49 * side, 0.14, -0.5 + i * 0.3).y_to_x();
      tube(b, side > 0 ? pane : pane.y_to_minus_y(), 0.075, 0.055, 0.04, 12);
    }
  }
  // Cockpit panes.
  for (int i = -2; i <= 2; ++i) {
    const auto [c, s] = circle(0.25 + i * 0.055);
    beam(b, f, {0.47 * c, 0.47 * s, 2.3}, {0.27 * c, 0.29 * s, 2.92}, 0.03, 0.03);
  }
  torus(b, f.at(0, 0, 2.3).y_to_z(), 0.485, 0.012, 24);
}

void engine(Builder& b, const Frame& f, double phase) {
  const Builder::Coarser fine(b, kFine);
  std::vector<Point2> nacelle{{0, -1.0},   {0.06, -0.98}, {0.2, -0.4}, {0.25, 0.2},
                              {0.25, 0.7}, {0.2, 0.85},   {0.1, 0.86}, {0, 0.86}};
  lathe(b, f.y_to_z(), nacelle, b.sides(0.25, 16));
  std::vector<Point2> spinner{{0, 0.88}, {0.1, 0.88}, {0.09, 1.0}, {0.05, 1.1}, {0, 1.14}};
  lathe(b, f.y_to_z(), spinner, b.sides(0.1, 12));
  for (int blade = 0; blade < 4; ++blade) {
    std::vector<std::vector<Vec3>> sections;
    const int rows = b.segments(0.7, 6), n = 10;
    for (int i = 0; i <= rows; ++i) {
      const double t = double(i) / rows, half = 0.05 + 0.05 * t * (1 - t) * 4 - 0.02 * t, twist = 0.14 - 0.09 * t;
      const auto [tc, ts] = circle(twist);
      std::vector<Vec3> section;
      for (int k = 0; k < n; ++k) {
        const auto [c, s] = circle(double(k) / n);
        const double u = half * c, v = 0.012 * s;
        section.push_back({u * tc - v * ts, 0.07 + 0.68 * t, -(u * ts + v * tc)});
      }
      sections.push_back(section);
    }
    loft(b, f.at(0, 0, 0.96).about_z(phase + blade / 4.0), sections);
  }
  for (const double side : {-1.0, 1.0})
    open_stub(b, f.at(0.22 * side, -0.08, -0.1) * along({0, 0, 0}, {0.3 * side, -0.1, -1}), 0.04, 0.35);
  tube(b, f.at(0, 0, 0.78).y_to_z(), 0.27, 0.22, 0.06, 16);
}

void undercarriage(Builder& b, const Frame& f, double height) {
  const Builder::Coarser fine(b, kFine);
  rod(b, f, {0, 0, 0}, {0, -height, 0}, 0.035, 10);
  rod(b, f, {0, -0.15, -0.3}, {0, -0.7 * height, 0}, 0.022, 8);
  for (const double side : {-1.0, 1.0}) {
    const Frame axle = f.at(0.1 * side, -height, 0).y_to_x();
    torus(b, axle, 0.13, 0.05, 20);
    cylinder(b, axle.at(0, -0.03, 0), 0.1, 0.06, 14);
  }
  rod(b, f, {-0.14, -height, 0}, {0.14, -height, 0}, 0.025, 8);
}

}  // namespace

void draw_plane(Builder& b) {
  const Frame f = Frame{}.at(0, 1.0, 0);
  fuselage(b, f);
  for (const double side : {-1.0, 1.0}) {
    // Mirroring would turn triangles inside out: the left wing is the right one turned about z, its profile is
    // symmetric.
    const Frame half = side > 0 ? f : f.about_z(0.5);
    surface(b, half, {0.3, 0.18 * side, 0.3}, 1.75, {5.8, 0.5 * side, 0.0}, 0.85, 0.13);
    surface(b, half, {0.1, 0.1 * side, -2.85}, 0.9, {2.3, 0.18 * side, -3.05}, 0.55, 0.1);
    for (int i = 0; i < 3; ++i)  // flap rails
      box(b, f.at((1.2 + 1.3 * i) * side, 0.14, -0.25), {-0.02, -0.06, -0.25}, {0.02, 0, 0.3});
    engine(b, f.at(2.0 * side, 0.12, 0.75), side > 0 ? 0.03 : 0.09);
    undercarriage(b, f.at(2.0 * side, -0.1, 0.5), 0.68);
    rod(b, f, {5.75 * side, 0.5, 0.1}, {5.75 * side, 0.5, -0.5}, 0.012, 6);
  }
  undercarriage(b, f.at(0, -0.35, 2.3), 0.43);
  surface(b, f.about_z(0.25), {0.2, 0, -2.7}, 1.2, {1.3, 0, -3.1}, 0.6, 0.1);
  rod(b, f, {0, 0.4, 1.2}, {0, 0.75, 1.0}, 0.01, 6);
}

}  // namespace standoff::scenes
