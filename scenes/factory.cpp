// SPDX-License-Identifier: Apache-2.0
// The factory hall: three bays of 3.5 units, open at the sides so that one sees in. A unit is about five metres.
#include <array>

#include "scenes/drives.h"
#include "scenes/families.h"
#include "scenes/random.h"
#include "scenes/steel.h"
#include "scenes/vessels.h"

namespace standoff::scenes {
namespace {

constexpr double kWidth = 10.6, kLength = 12.6, kEaves = 2.15;
constexpr std::array<double, 4> kColumnLines{0.15, 3.6, 7.0, 10.45};
constexpr int kFrames = 9;

double frame_z(int i) { return 0.15 + (kLength - 0.3) * i / (kFrames - 1); }

// Floor, columns, roof girders and purlins, low walls, glazing bars on one long side.
void hall(Builder& b) {
  const Frame f;
  {
    const Builder::Coarser flat(b, 3);
    box(b, f, {0, -0.06, 0}, {kWidth, 0, kLength});
    box(b, f, {0, 0, 0}, {0.05, 0.5, kLength});
    box(b, f, {0, 0, 0}, {kWidth, 0.5, 0.05});
  }
  for (int i = 0; i < kFrames; ++i) {
    const double z = frame_z(i);
    for (const double x : kColumnLines) column(b, f.at(x, 0, z), kEaves, 0.09);
    for (int bay = 0; bay < 3; ++bay) {
      const Vec3 from{kColumnLines[bay], kEaves, z}, to{kColumnLines[bay + 1], kEaves, z};
      truss(b, f, from, to, 0.3, 12);
      const Vec3 ridge = (from + to) * 0.5 + Vec3{0, 0.6, 0};
      i_beam(b, f, from + Vec3{0, 0.32, 0}, ridge, 0.06, 0.04);
      i_beam(b, f, to + Vec3{0, 0.32, 0}, ridge, 0.06, 0.04);
    }
  }
  for (int bay = 0; bay < 3; ++bay)
    for (int i = 0; i <= 6; ++i) {
      const double t = i / 6.0, x = kColumnLines[bay] + (kColumnLines[bay + 1] - kColumnLines[bay]) * t;
      const double y = kEaves + 0.36 + 0.28 * (1 - std::abs(2 * t - 1));
      i_beam(b, f, {x, y, 0}, {x, y, kLength}, 0.05, 0.03);
    }
  for (const double x : kColumnLines)
    for (const double y : {1.55, kEaves}) i_beam(b, f, {x + 0.07, y, 0.05}, {x + 0.07, y, kLength - 0.05}, 0.09, 0.06);
  for (int i = 0; i < 64; ++i) beam(b, f, {0.05, 0.5, 0.1 + i * 0.196}, {0.05, kEaves, 0.1 + i * 0.196}, 0.012, 0.012);
  for (int i = 1; i < 8; ++i) beam(b, f, {0.05, 0.5 + i * 0.2, 0.1}, {0.05, 0.5 + i * 0.2, kLength - 0.1}, 0.01, 0.01);
}

// A travelling crane between two column lines.
void bridge_crane(Builder& b, double x0, double x1, double z) {
  const Frame f = Frame{}.at(0, 1.62, z);
  for (const double side : {-0.15, 0.15}) {
    truss(b, f, {x0, 0, side}, {x1, 0, side}, 0.2, 14);
    box(b, f, {x0, -0.05, side - 0.05}, {x0 + 0.12, 0.15, side + 0.05});
    box(b, f, {x1 - 0.12, -0.05, side - 0.05}, {x1, 0.15, side + 0.05});
  }
  const Frame trolley = f.at(x0 + (x1 - x0) * 0.4, 0.22, 0);
  box(b, trolley, {-0.2, 0, -0.2}, {0.2, 0.06, 0.2});
  cylinder(b, trolley.at(-0.12, 0.12, 0).y_to_x(), 0.06, 0.24, 12);
  motor(b, trolley.at(0.12, 0.06, 0), 0.05);
  for (const double side : {-0.03, 0.03}) rod(b, trolley, {side, 0, 0}, {side, -0.8, 0}, 0.008);
  box(b, trolley, {-0.06, -0.95, -0.03}, {0.06, -0.8, 0.03});
  torus(b, trolley.at(0, -1.02, 0).y_to_z(), 0.05, 0.015);
}

// Pipes side by side on brackets along z, each with drops, flanges and a valve here and there.
void pipe_rack(Builder& b, double x, double y, int pipes, std::uint64_t seed) {
  const Frame f;
  for (int i = 0; i < 2 * kFrames; ++i) {
    const double z = 0.3 + i * (kLength - 0.6) / (2 * kFrames - 1);
    i_beam(b, f, {x - 0.55, y - 0.06, z}, {x + 0.55, y - 0.06, z}, 0.05, 0.04);
    beam(b, f, {x - 0.5, y - 0.06, z}, {x, y - 0.4, z}, 0.02, 0.02);
  }
  for (int p = 0; p < pipes; ++p) {
    const auto key = static_cast<std::uint64_t>(p);
    const double r = between(0.012, 0.035, uniform(seed, key, 0)), px = x - 0.5 + (p + 0.5) * (1.0 / pipes);
    const double start = between(0.1, 3, uniform(seed, key, 1)), end = between(9, kLength - 0.1, uniform(seed, key, 2));
    const double turn = between(-1.2, 1.2, uniform(seed, key, 3));
    const std::vector<Vec3> path{
        Vec3{px, 0.35, start}, {px, y, start}, {px, y, end}, {px + turn, y, end}, {px + turn, 0.3, end}};
    flanged_pipe(b, f, path, r);
    for (int joint = 1; joint < 6; ++joint) flange(b, f.at(px, y, start + (end - start) * joint / 6).y_to_z(), r);
    valve(b, f.at(px, 0.9, start).about_z(0.25), 1.2 * r);
    valve(b, f.at(px, y, 0.5 * (start + end)).about_y(0.25), r);
  }
}

// Cable trays: ladders of thin strips, with cables on them.
void cable_tray(Builder& b, double x, double y, std::uint64_t seed) {
  const Frame f;
  const double w = 0.16;
  for (const double side : {0.0, w}) box(b, f, {x + side, y, 0.1}, {x + side + 0.006, y + 0.04, kLength - 0.1});
  for (int i = 0; i < 120; ++i) {
    const double z = 0.15 + i * (kLength - 0.3) / 120;
    box(b, f, {x, y, z}, {x + w, y + 0.006, z + 0.015});
  }
  for (int c = 0; c < 6; ++c) {
    std::vector<Vec3> path;
    for (int i = 0; i <= 30; ++i) {
      const auto key = static_cast<std::uint64_t>(c * 31 + i);
      path.push_back({x + 0.02 + c * 0.022 + 0.006 * uniform(seed, key), y + 0.015 + 0.004 * uniform(seed, key, 1),
                      0.12 + i * (kLength - 0.24) / 30});
    }
    pipe(b, f, path, 0.007, 0, 6);
  }
}

// A rectangular air duct along z with stiffening frames and outlets.
void air_duct(Builder& b, double x, double y) {
  const Frame f;
  box(b, f, {x, y, 0.2}, {x + 0.35, y + 0.25, kLength - 0.2});
  for (int i = 0; i <= 24; ++i) {
    const double z = 0.25 + i * (kLength - 0.5) / 24;
    box(b, f, {x - 0.015, y - 0.015, z - 0.01}, {x + 0.365, y + 0.265, z + 0.01});
    if (i % 2 == 1) {
      cone(b, f.at(x + 0.17, y, z + 0.2).y_to_minus_y(), 0.06, 0.12, 0.12, 12);
      tube(b, f.at(x + 0.17, y - 0.14, z + 0.2), 0.13, 0.11, 0.03, 12);
    }
  }
}

// Bay A: rows of tanks joined by pipes, platforms above, pumps in front.
void tank_bay(Builder& b) {
  const Frame f;
  for (int row = 0; row < 2; ++row)
    for (int i = 0; i < 12; ++i) {
      const auto key = static_cast<std::uint64_t>(row * 12 + i);
      const double r = between(0.22, 0.36, uniform(11, key)), h = between(0.9, 1.5, uniform(12, key));
      const double x = 0.85 + row * 1.25, z = 0.75 + i * 1.0;
      standing_tank(b, f.at(x, 0, z).about_y(0.25 * static_cast<double>(hash(key) % 4)), r, h);
      pump(b, f.at(x + 0.25, 0, z + 0.45), 0.07);
      const std::vector<Vec3> suction{{x, 0.14 * h, z}, {x, 0.1, z}, {x, 0.1, z + 0.45}, {x + 0.2, 0.1, z + 0.45}};
      flanged_pipe(b, f, suction, 0.028);
      const std::vector<Vec3> over{{x, 1.25 * h, z}, {x, 1.75, z}, {x, 1.75, z + 0.8}, {x + 0.3, 1.75, z + 0.8}};
      flanged_pipe(b, f, over, 0.03);
    }
  catwalk(b, f.at(1.28, 1.0, 0.3), 0.4, 12, 0.22);
  catwalk(b, f.at(2.75, 1.0, 0.3), 0.4, 12, 0.22);
  for (int i = 0; i < 13; ++i)
    for (const double x : {1.3, 1.66, 2.77, 3.13})
      i_beam(b, f, {x, 0, 0.35 + i * 0.98}, {x, 0.95, 0.35 + i * 0.98}, 0.04, 0.04);
  stairs(b, f.at(3.3, 0, 5).about_y(0), 0.28, 1.0, 1.3);
}

// Bay B: two production lines under the crane.
void line_bay(Builder& b) {
  const Frame f;
  for (int line = 0; line < 2; ++line) {
    const double x = 4.3 + line * 1.5;
    for (int i = 0; i < 14; ++i) {
      const auto key = static_cast<std::uint64_t>(line * 14 + i);
      const double z = 0.5 + i * 0.85;
      conveyor(b, f.at(x, 0, z - 0.2).about_y(-0.25), 0.8, 0.32, 0.3);
      for (int item = 0; item < 3; ++item) gear(b, f.at(x, 0.3, z + item * 0.25), 0.09, 0.05, 18);
      if (hash(key) % 3 == 0) {
        press(b, f.at(x + 0.1, 0, z + 0.2).about_y(0.25), 0.33);
      } else {
        robot_arm(b, f.at(x + 0.42, 0, z + 0.15), 0.42, key);
        robot_arm(b, f.at(x - 0.42, 0, z + 0.45), 0.42, key + 100);
      }
      cabinet(b, f.at(x + 0.85, 0, z).about_y(0.25), 0.3, 0.45, 0.15);
      for (int post = 0; post < 4; ++post)
        beam(b, f, {x + 0.7, 0, z + post * 0.21}, {x + 0.7, 0.42, z + post * 0.21}, 0.012, 0.012);
      for (int wire = 0; wire < 9; ++wire)
        rod(b, f, {x + 0.7, 0.05 + wire * 0.045, z}, {x + 0.7, 0.05 + wire * 0.045, z + 0.82}, 0.004);
    }
  }
  bridge_crane(b, 3.68, 6.95, 3.5);
  bridge_crane(b, 3.68, 6.95, 9.5);
}

// Bay C: machine tools, heat exchangers, lying tanks, silos, fans.
void machine_bay(Builder& b) {
  const Frame f;
  for (int i = 0; i < 10; ++i) {
    const double z = 0.7 + i * 0.8;
    machine_tool(b, f.at(7.6, 0, z).about_y(0.25), 0.26);
    machine_tool(b, f.at(8.55, 0, z).about_y(-0.25), 0.26);
  }
  for (int i = 0; i < 5; ++i) {
    lying_tank(b, f.at(7.4, 0, 9.1 + i * 0.72), 0.26, 1.2);
    heat_exchanger(b, f.at(8.8, 0, 9.1 + i * 0.72), 0.16, 1.3);
    const std::vector<Vec3> link{
        {8.3, 0.6, 9.1 + i * 0.72}, {8.3, 1.1, 9.1 + i * 0.72}, {8.9, 1.1, 9.1 + i * 0.72}, {8.9, 0.5, 9.1 + i * 0.72}};
    flanged_pipe(b, f, link, 0.035);
  }
  for (int i = 0; i < 7; ++i) {
    silo(b, f.at(9.85, 0, 0.75 + i * 1.1), 0.38, 1.75);
    fan(b, f.at(9.25, 0, 0.6 + i * 1.1), 0.14);
    const std::vector<Vec3> feed{{9.85, 1.85, 0.75 + i * 1.1},
                                 {9.85, 2.0, 0.75 + i * 1.1},
                                 {9.2, 2.0, 0.75 + i * 1.1},
                                 {9.2, 0.4, 0.75 + i * 1.1}};
    pipe(b, f, feed, 0.05, 0.12, 12);
  }
  catwalk(b, f.at(9.2, 1.2, 8.7), 0.4, 3.7, 0.22);
  stairs(b, f.at(9.4, 0, 7.4 + 1.3 - 1.55), 0.28, 1.2, 1.5);
  coil(b, f.at(10.1, 0.05, 9.3), 0.2, 0.03, 0.4, 6);
}

void lamps(Builder& b) {
  const Frame f;
  for (int bay = 0; bay < 3; ++bay)
    for (int i = 0; i < 10; ++i)
      for (const double side : {0.3, 0.7}) {
        const double x = kColumnLines[bay] + (kColumnLines[bay + 1] - kColumnLines[bay]) * side, z = 0.9 + i * 1.2;
        rod(b, f, {x, kEaves, z}, {x, kEaves - 0.25, z}, 0.005);
        cone(b, f.at(x, kEaves - 0.35, z), 0.09, 0.02, 0.1, 12);
      }
}

}  // namespace

void draw_factory(Builder& b) {
  hall(b);
  tank_bay(b);
  line_bay(b);
  machine_bay(b);
  pipe_rack(b, 3.2, 1.85, 14, 21);
  pipe_rack(b, 7.3, 1.85, 14, 22);
  cable_tray(b, 3.75, 1.95, 31);
  cable_tray(b, 6.75, 1.95, 32);
  air_duct(b, 1.5, 1.95);
  air_duct(b, 8.7, 1.95);
  lamps(b);
}

}  // namespace standoff::scenes
