// SPDX-License-Identifier: Apache-2.0
#include "scenes/vessels.h"

#include <algorithm>

#include "scenes/steel.h"

namespace standoff::scenes {
namespace {

// Plates under a lying cylinder of radius r whose axis is at height y.
void saddles(Builder& b, const Frame& f, double r, double y, double length) {
  for (const double side : {0.25, 0.75}) {
    const Frame at = f.at(side * length, 0, 0);
    box(b, at, {-0.12 * r, 0, -0.8 * r}, {0.12 * r, y - 0.45 * r, 0.8 * r});
    box(b, at, {-0.25 * r, 0, -0.9 * r}, {0.25 * r, 0.08 * r, 0.9 * r});
  }
}

}  // namespace

void flange(Builder& b, const Frame& f, double r) {
  tube(b, f.at(0, -0.35 * r, 0), 1.7 * r, r, 0.35 * r);
  bolt_circle(b, f, 1.35 * r, 8, 0.3 * r);
}

void flanged_pipe(Builder& b, const Frame& f, const std::vector<Vec3>& corners, double r) {
  pipe(b, f, corners, r, 3 * r);
  flange(b, f * along(corners[1], corners[0]).at(0, length(corners[1] - corners[0]), 0), r);
  const std::size_t n = corners.size();
  flange(b, f * along(corners[n - 2], corners[n - 1]).at(0, length(corners[n - 1] - corners[n - 2]), 0), r);
}

void valve(Builder& b, const Frame& f, double r) {
  ellipsoid(b, f, {1.6 * r, 1.7 * r, 1.5 * r});
  for (const double side : {-1.0, 1.0}) {
    const Frame end = side > 0 ? f.y_to_x() : f.y_to_x().y_to_minus_y();
    cylinder(b, end, r, 2.2 * r);
    flange(b, end.at(0, 2.2 * r, 0), r);
  }
  cone(b, f.at(0, r, 0), 1.1 * r, 0.7 * r, 1.5 * r);
  flange(b, f.at(0, 2.6 * r, 0), 0.8 * r);
  if (b.hides(3 * r, 0.4 * r)) return;  // no wheel without its spindle
  cylinder(b, f.at(0, 2 * r, 0), 0.2 * r, 3 * r, 6);
  torus(b, f.at(0, 4.6 * r, 0), 1.4 * r, 0.15 * r);
  for (int i = 0; i < 3; ++i) {
    const auto [c, s] = circle(i / 6.0);
    rod(b, f.at(0, 4.6 * r, 0), {-1.4 * r * c, 0, -1.4 * r * s}, {1.4 * r * c, 0, 1.4 * r * s}, 0.1 * r);
  }
}

void nozzle(Builder& b, const Frame& f, double r, double reach) {
  if (b.hides(2 * r, std::max(2 * r, reach))) return;  // no flange without its pipe
  cylinder(b, f, r, reach);
  flange(b, f.at(0, reach, 0), r);
}

void standing_tank(Builder& b, const Frame& f, double r, double height, bool with_ladder) {
  const double legs = 0.2 * height, bulge = 0.35 * r;
  const int sides = b.sides(r, 12), arc = b.segments(r, 3);
  std::vector<Point2> profile;
  append_dome(profile, r, legs + bulge, bulge, arc, false);
  append_dome(profile, r, legs + height - bulge, bulge, arc, true);
  lathe(b, f, profile, sides);
  for (const double level : {0.25, 0.75}) tube(b, f.at(0, legs + level * height, 0), 1.04 * r, 0.98 * r, 0.08 * r, 12);
  for (int i = 0; i < 4; ++i) {
    const auto [c, s] = circle(0.125 + i / 4.0);
    rod(b, f, {0.85 * r * c, 0, 0.85 * r * s}, {0.85 * r * c, legs + 2 * bulge, 0.85 * r * s}, 0.08 * r);
    box(b, f.at(0.85 * r * c, 0, 0.85 * r * s), {-0.15 * r, 0, -0.15 * r}, {0.15 * r, 0.04 * r, 0.15 * r});
  }
  nozzle(b, f.at(0, legs + height - 0.1 * bulge, 0), 0.14 * r, 0.4 * r);
  nozzle(b, f.at(0, legs + 0.1 * bulge, 0).y_to_minus_y(), 0.12 * r, 0.3 * r);
  nozzle(b, f.at(0.95 * r, legs + 0.6 * height, 0).y_to_x(), 0.12 * r, 0.3 * r);
  // The manhole, with its lid.
  const Frame side = f.at(0, legs + 0.35 * height, 0.9 * r).y_to_z();
  nozzle(b, side, 0.3 * r, 0.25 * r);
  cylinder(b, side.at(0, 0.25 * r, 0), 0.5 * r, 0.06 * r, 12);
  if (!with_ladder) return;
  ladder(b, f.at(0, 0, -1.1 * r).about_y(0.5), 0.4 * r, 1.15 * height, true);
  for (int i = 0; i < 12; ++i) {
    const auto [c, s] = circle(i / 12.0);
    const auto [c2, s2] = circle((i + 1) / 12.0);
    const double y = legs + height - bulge;
    railing(b, f, {0.9 * r * c, y, 0.9 * r * s}, {0.9 * r * c2, y, 0.9 * r * s2}, 0.45 * r);
  }
}

void lying_tank(Builder& b, const Frame& f, double r, double length) {
  const double y = 1.5 * r, bulge = 0.4 * r;
  std::vector<Point2> profile;
  append_dome(profile, r, bulge, bulge, b.segments(r, 3), false);
  append_dome(profile, r, length - bulge, bulge, b.segments(r, 3), true);
  lathe(b, f.at(0, y, 0).y_to_x(), profile, b.sides(r, 12));
  saddles(b, f, r, y, length);
  for (const double at : {0.2, 0.5, 0.8}) nozzle(b, f.at(at * length, y + 0.95 * r, 0), 0.15 * r, 0.4 * r);
}

void heat_exchanger(Builder& b, const Frame& f, double r, double length) {
  const double y = 1.6 * r;
  const Frame axis = f.at(0, y, 0).y_to_x();
  cylinder(b, axis, r, length, 12);
  for (const double at : {0.0, 0.12, 0.88, 1.0}) {
    tube(b, axis.at(0, at * length - 0.05 * r, 0), 1.2 * r, 0.95 * r, 0.1 * r, 12);
    bolt_circle(b, axis.at(0, at * length + 0.05 * r, 0), 1.1 * r, 16, 0.1 * r);
  }
  nozzle(b, f.at(0.06 * length, y + 0.9 * r, 0), 0.3 * r, 0.6 * r);
  nozzle(b, f.at(0.94 * length, y + 0.9 * r, 0), 0.3 * r, 0.6 * r);
  nozzle(b, f.at(0.25 * length, y + 0.9 * r, 0), 0.25 * r, 0.6 * r);
  saddles(b, f, r, y, length);
}

void silo(Builder& b, const Frame& f, double r, double height) {
  const double cone_top = 0.35 * height;
  const std::vector<Point2> profile{{0, 0.1 * height}, {0.15 * r, 0.1 * height}, {r, cone_top},     {r, 0.9 * height},
                                    {0.3 * r, height}, {0.3 * r, 1.04 * height}, {0, 1.04 * height}};
  lathe(b, f, profile, b.sides(r, 12));
  for (int i = 0; i < 6; ++i) {
    const auto [c, s] = circle(i / 6.0);
    const Vec3 foot{1.05 * r * c, 0, 1.05 * r * s};
    beam(b, f, foot, foot + Vec3{0, 0.5 * height, 0}, 0.08 * r, 0.08 * r);
  }
  for (const double level : {0.45, 0.6, 0.75}) tube(b, f.at(0, level * height, 0), 1.05 * r, 0.98 * r, 0.06 * r, 12);
  ladder(b, f.at(0, 0, -1.15 * r).about_y(0.5), 0.3 * r, height, true);
}

void hopper(Builder& b, const Frame& f, double width, double depth, double height) {
  const auto section = [](double w, double d, double y) {
    return std::vector<Vec3>{{-w / 2, y, d / 2}, {w / 2, y, d / 2}, {w / 2, y, -d / 2}, {-w / 2, y, -d / 2}};
  };
  const std::vector<std::vector<Vec3>> sections{section(0.25 * width, 0.25 * depth, 0),
                                                section(0.25 * width, 0.25 * depth, 0.15 * height),
                                                section(width, depth, 0.75 * height), section(width, depth, height)};
  loft(b, f, sections);
}

}  // namespace standoff::scenes
