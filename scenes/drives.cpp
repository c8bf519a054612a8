// SPDX-License-Identifier: Apache-2.0
#include "scenes/drives.h"

#include "scenes/random.h"
#include "scenes/steel.h"
#include "scenes/vessels.h"

namespace standoff::scenes {

void motor(Builder& b, const Frame& f, double r) {
  const double length = 3 * r;
  const Frame axis = f.at(0, 1.25 * r, 0).y_to_x();
  const std::vector<Point2> body{Point2{0, 0},       {0.25 * r, 0},      {0.3 * r, 0.15 * r},      {0.92 * r, 0.2 * r},
                                 {0.92 * r, length}, {0.98 * r, length}, {0.9 * r, 1.18 * length}, {0, 1.2 * length}};
  lathe(b, axis.at(0, 0.4 * r, 0), body, b.sides(r, 12));
  cylinder(b, axis, 0.16 * r, 0.5 * r);
  const int ribs = 20;
  for (int i = 0; i < ribs; ++i)
    box(b, axis.at(0, 0.4 * r, 0).about_y((i + 0.5) / ribs), {-0.03 * r, 0.4 * r, 0.88 * r},
        {0.03 * r, 0.95 * length, 1.05 * r});
  box(b, f, {0.8 * r, 0, -0.8 * r}, {0.7 * length, 0.5 * r, 0.8 * r});
  box(b, f, {r, 2.1 * r, -0.4 * r}, {0.65 * length, 2.5 * r, 0.4 * r});
}

void gear_box(Builder& b, const Frame& f, double size) {
  const double s = size;
  const std::vector<Point2> outline{{-0.7 * s, -0.4 * s}, {0.7 * s, -0.4 * s}, {0.8 * s, -0.3 * s},
                                    {0.8 * s, 0.3 * s},   {0.7 * s, 0.4 * s},  {-0.7 * s, 0.4 * s},
                                    {-0.8 * s, 0.3 * s},  {-0.8 * s, -0.3 * s}};
  extrude(b, f, outline, 0.55 * s);
  extrude(b, f.at(0, 0.55 * s, 0).scaled(1.08, 1, 1.1), outline, 0.06 * s);
  extrude(b, f.at(0, 0.61 * s, 0), outline, 0.35 * s);
  box(b, f, {-0.95 * s, 0, -0.55 * s}, {0.95 * s, 0.08 * s, 0.55 * s});
  for (const double side : {-1.0, 1.0}) {
    const Frame end = f.at(side * 0.75 * s, 0.6 * s, -side * 0.1 * s).y_to_x();
    const Frame out = side > 0 ? end : end.y_to_minus_y();
    cylinder(b, out, 0.22 * s, 0.12 * s);
    bolt_circle(b, out.at(0, 0.12 * s, 0), 0.16 * s, 6, 0.05 * s);
    cylinder(b, out, 0.09 * s, 0.5 * s);
  }
  bolt_circle(b, f.at(0, 0.96 * s, 0), 0.3 * s, 6, 0.06 * s);
}

void pump(Builder& b, const Frame& f, double r) {
  const double y = 1.5 * r;
  box(b, f, {-1.2 * r, 0, -r}, {5.6 * r, 0.25 * r, r});
  const Frame axis = f.at(0, y, 0).y_to_x();
  torus(b, axis, 0.75 * r, 0.45 * r);
  cylinder(b, axis.at(0, -0.4 * r, 0), 0.9 * r, 0.8 * r, 12);
  nozzle(b, axis.y_to_minus_y(), 0.4 * r, 1.2 * r);
  nozzle(b, f.at(0, y, 0.8 * r), 0.35 * r, 1.6 * r);
  cylinder(b, axis.at(0, 0.3 * r, 0), 0.15 * r, 1.5 * r);
  cone(b, axis.at(0, 0.3 * r, 0), 0.7 * r, 0.3 * r, 0.7 * r);
  tube(b, axis.at(0, 1.35 * r, 0), 0.4 * r, 0.16 * r, 0.4 * r);
  motor(b, f.at(1.6 * r, 0.25 * r, 0), r);
}

void fan(Builder& b, const Frame& f, double r) {
  std::vector<Point2> outline;
  const int n = 24;
  for (int i = 0; i < n; ++i) {  // a volute: the radius grows with the angle
    const auto [c, s] = circle(double(i) / n);
    const double reach = r * (0.8 + 0.4 * i / n);
    outline.push_back({reach * c, reach * s});
  }
  const Frame upright = f.at(0, 1.4 * r, -0.4 * r).y_to_z();
  extrude(b, upright, outline, 0.8 * r);
  tube(b, upright.at(0, 0.8 * r, 0), 0.55 * r, 0.45 * r, 0.3 * r, 12);
  box(b, f, {0.7 * r, 1.3 * r, -0.35 * r}, {1.2 * r, 2.9 * r, 0.35 * r});
  box(b, f, {-r, 0, -0.5 * r}, {r, 0.4 * r, 0.5 * r});
  motor(b, f.at(0, 0.85 * r, -0.5 * r).about_y(0.25), 0.42 * r);
  box(b, f, {-0.4 * r, 0, -2 * r}, {0.4 * r, 0.9 * r, -0.6 * r});
}

void roll(Builder& b, const Frame& f, double r, double length) {
  const double neck = 0.3 * r;
  const std::vector<Point2> profile{
      Point2{0, -1.4 * r},      {neck, -1.4 * r},     {neck, 0}, {r, 0.02 * r}, {r, length - 0.02 * r}, {neck, length},
      {neck, length + 1.4 * r}, {0, length + 1.4 * r}};
  lathe(b, f.y_to_x(), profile, b.sides(r, 12));
  for (const double at : {-1.0 * r, length + 0.5 * r}) {
    box(b, f, {at, -0.7 * r, -0.6 * r}, {at + 0.5 * r, 0.3 * r, 0.6 * r});
    cylinder(b, f.at(at - 0.05 * r, 0, 0).y_to_x(), 0.6 * r, 0.6 * r, 12);
    bolt_circle(b, f.at(at + 0.55 * r, 0, 0).y_to_x(), 0.45 * r, 6, 0.12 * r);
  }
}

void wheel(Builder& b, const Frame& f, double r, double width, int spokes) {
  tube(b, f.at(0, -width / 2, 0), r, 0.85 * r, width, 16);
  cylinder(b, f.at(0, -0.7 * width, 0), 0.18 * r, 1.4 * width);
  for (int i = 0; i < spokes; ++i)
    beam(b, f.about_y(double(i) / spokes), {0.12 * r, 0, 0}, {0.88 * r, 0, 0}, 0.08 * r, 0.5 * width);
}

void conveyor(Builder& b, const Frame& f, double length, double width, double height) {
  const double r = 0.08 * width, w = width / 2;
  for (const double z : {-w - 0.02 * width, w + 0.02 * width})
    box(b, f, {0, height - 2 * r, z - 0.02 * width}, {length, height + r, z + 0.02 * width});
  const int rollers = std::max(2, static_cast<int>(length / (0.3 * width)));
  for (int i = 0; i <= rollers; ++i)
    cylinder(b, f.at(r + (length - 2 * r) * i / rollers, height - r, -w).y_to_z(), 0.7 * r, width);
  box(b, f, {0, height - 0.3 * r, -0.9 * w}, {length, height, 0.9 * w});
  box(b, f, {0, height - 2 * r, -0.9 * w}, {length, height - 1.7 * r, 0.9 * w});
  const int legs = std::max(1, static_cast<int>(length / (1.5 * width)));
  for (int i = 0; i <= legs; ++i) {
    const double x = 0.06 * width + (length - 0.12 * width) * i / legs;
    for (const double z : {-w, w}) beam(b, f, {x, 0, z}, {x, height - 2 * r, z}, 0.06 * width, 0.06 * width);
    beam(b, f, {x, 0.4 * height, -w}, {x, 0.4 * height, w}, 0.04 * width, 0.04 * width);
  }
  motor(b, f.at(0.1 * width, 0.1 * height, 0), 0.12 * width);
}

void cabinet(Builder& b, const Frame& f, double width, double height, double depth) {
  box(b, f, {0, 0.05 * height, -depth}, {width, height, 0});
  box(b, f, {0.02 * width, 0, -0.95 * depth}, {0.98 * width, 0.05 * height, -0.05 * depth});
  const int doors = std::max(1, static_cast<int>(2.2 * width / height + 0.5));
  const double door = width / doors;
  for (int i = 0; i < doors; ++i) {
    const double x = i * door;
    box(b, f, {x + 0.04 * door, 0.09 * height, -0.01 * depth}, {x + 0.96 * door, 0.96 * height, 0.04 * depth});
    rod(b, f, {x + 0.85 * door, 0.45 * height, 0.1 * depth}, {x + 0.85 * door, 0.6 * height, 0.1 * depth}, 0.02 * door);
    for (int slot = 0; slot < 8; ++slot)
      box(b, f, {x + 0.2 * door, (0.12 + 0.025 * slot) * height, 0.03 * depth},
          {x + 0.7 * door, (0.132 + 0.025 * slot) * height, 0.07 * depth});
  }
}

void machine_tool(Builder& b, const Frame& f, double size) {
  const double s = size;
  box(b, f, {-s, 0, -0.6 * s}, {s, 0.35 * s, 0.6 * s});
  for (const double x : {-1.0, 0.75}) box(b, f, {x * s, 0.35 * s, -0.6 * s}, {(x + 0.25) * s, 1.3 * s, 0.6 * s});
  box(b, f, {-s, 0.35 * s, -0.7 * s}, {s, 1.5 * s, -0.6 * s});
  box(b, f, {-s, 1.3 * s, -0.6 * s}, {s, 1.4 * s, 0.3 * s});
  box(b, f, {-0.6 * s, 0.35 * s, -0.35 * s}, {0.6 * s, 0.45 * s, 0.35 * s});
  for (const double z : {-0.25, 0.0, 0.25})
    box(b, f, {-0.55 * s, 0.45 * s, (z - 0.03) * s}, {0.55 * s, 0.48 * s, (z + 0.03) * s});
  box(b, f, {-0.2 * s, 0.9 * s, -0.6 * s}, {0.2 * s, 1.7 * s, 0.05 * s});
  const Frame spindle = f.at(0, 0.9 * s, 0.0).y_to_minus_y();
  cone(b, spindle, 0.14 * s, 0.1 * s, 0.12 * s, 12);
  cylinder(b, spindle.at(0, 0.12 * s, 0), 0.03 * s, 0.18 * s);
  motor(b, f.at(0, 1.7 * s, -0.2 * s).about_z(0.25), 0.12 * s);
  cabinet(b, f.at(1.1 * s, 0, 0.2 * s), 0.5 * s, 1.2 * s, 0.5 * s);
  box(b, f, {1.15 * s, 0.8 * s, 0.22 * s}, {1.55 * s, 1.1 * s, 0.26 * s});
  const std::vector<Vec3> hose{{0.2 * s, 1.5 * s, -0.2 * s},
                               {0.5 * s, 1.8 * s, -0.2 * s},
                               {0.9 * s, 1.8 * s, 0.1 * s},
                               {1.3 * s, 1.5 * s, 0},
                               {1.3 * s, 1.1 * s, 0}};
  pipe(b, f, hose, 0.03 * s, 0.15 * s);
}

void press(Builder& b, const Frame& f, double size) {
  const double s = size;
  box(b, f, {-0.8 * s, 0, -0.5 * s}, {0.8 * s, 0.5 * s, 0.5 * s});
  for (const double x : {-0.8, 0.6}) box(b, f, {x * s, 0.5 * s, -0.4 * s}, {(x + 0.2) * s, 2 * s, 0.4 * s});
  box(b, f, {-0.85 * s, 2 * s, -0.5 * s}, {0.85 * s, 2.6 * s, 0.5 * s});
  box(b, f, {-0.55 * s, 1.1 * s, -0.35 * s}, {0.55 * s, 1.4 * s, 0.35 * s});
  for (const double x : {-0.35, 0.35}) {
    cylinder(b, f.at(x * s, 1.4 * s, 0), 0.09 * s, 0.6 * s, 12);
    cylinder(b, f.at(x * s, 2.6 * s, 0), 0.15 * s, 0.35 * s, 12);
    bolt_circle(b, f.at(x * s, 2.95 * s, 0), 0.11 * s, 8, 0.03 * s);
  }
  wheel(b, f.at(0.95 * s, 2.3 * s, 0).y_to_x(), 0.45 * s, 0.12 * s, 6);
  for (const double x : {-0.7, 0.7})
    for (const double z : {-0.42, 0.42}) rod(b, f, {x * s, 0.5 * s, z * s}, {x * s, 2 * s, z * s}, 0.05 * s);
}

void robot_arm(Builder& b, const Frame& f, double size, std::uint64_t key) {
  const double s = size;
  const auto angle = [&](std::uint64_t joint, double low, double high) {
    return between(low, high, uniform(key, joint));
  };
  cylinder(b, f, 0.3 * s, 0.1 * s, 12);
  bolt_circle(b, f.at(0, 0.1 * s, 0), 0.25 * s, 8, 0.03 * s);
  const Frame turret = f.at(0, 0.1 * s, 0).about_y(angle(0, 0, 1));
  cone(b, turret, 0.26 * s, 0.2 * s, 0.3 * s, 12);
  const Frame shoulder = turret.at(0, 0.4 * s, 0).about_x(angle(1, 0.02, 0.09));
  cylinder(b, shoulder.at(-0.22 * s, 0, 0).y_to_x(), 0.17 * s, 0.44 * s, 12);
  beam(b, shoulder, {0, 0, 0}, {0, 0.8 * s, 0}, 0.16 * s, 0.2 * s);
  const Frame elbow = shoulder.at(0, 0.8 * s, 0).about_x(angle(2, 0.14, 0.22));
  cylinder(b, elbow.at(-0.18 * s, 0, 0).y_to_x(), 0.14 * s, 0.36 * s, 12);
  cone(b, elbow.at(0, -0.2 * s, 0), 0.12 * s, 0.07 * s, 0.9 * s);
  motor(b, elbow.at(0, -0.2 * s, -0.1 * s).about_x(0.25), 0.05 * s);
  const Frame wrist = elbow.at(0, 0.7 * s, 0).about_x(angle(3, 0, 0.12));
  cylinder(b, wrist.at(-0.08 * s, 0, 0).y_to_x(), 0.08 * s, 0.16 * s);
  cylinder(b, wrist, 0.05 * s, 0.15 * s);
  for (const double side : {-1.0, 1.0})
    box(b, wrist, {(0.05 * side - 0.015) * s, 0.15 * s, -0.03 * s}, {(0.05 * side + 0.015) * s, 0.28 * s, 0.03 * s});
}

void coil(Builder& b, const Frame& f, double radius, double wire, double height, int turns) {
  std::vector<Vec3> path;
  const int per_turn = b.sides(radius, 10);
  for (int i = 0; i <= turns * per_turn; ++i) {
    const auto [c, s] = circle(double(i % per_turn) / per_turn);
    path.push_back({radius * c, height * i / (turns * per_turn), radius * s});
  }
  sweep(b, f, path, {wire}, b.sides(wire, 6));
}

}  // namespace standoff::scenes
