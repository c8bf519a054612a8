// SPDX-License-Identifier: Apache-2.0
// Two process plants: vessels joined by piping, small and tall; and a pulp line, long and low.
#include "scenes/drives.h"
#include "scenes/families.h"
#include "scenes/steel.h"
#include "scenes/vessels.h"

namespace standoff::scenes {

void draw_process(Builder& b) {
  const Frame f;
  // The skid.
  for (const double z : {-0.75, 0.0, 0.75}) i_beam(b, f, {-2, -0.08, z}, {2, -0.08, z}, 0.14, 0.1);
  for (const double x : {-1.95, -0.8, 0.35, 1.95}) i_beam(b, f, {x, -0.08, -0.8}, {x, -0.08, 0.8}, 0.14, 0.1);
  // A column with trays' manholes, a reboiler at its foot, a condenser and a drum above, two pumps.
  std::vector<Point2> column{};
  append_dome(column, 0.24, 0.5, 0.14, b.segments(0.5, 3), false);
  append_dome(column, 0.24, 4.3, 0.14, b.segments(0.5, 3), true);
  const Frame tower = f.at(-1.2, 0, 0);
  lathe(b, tower, column, b.sides(0.24, 14));
  cone(b, tower, 0.3, 0.24, 0.5, 14);
  for (int i = 0; i < 4; ++i) {
    tube(b, tower.at(0, 1 + i * 0.9, 0), 0.27, 0.23, 0.06, 14);
    nozzle(b, tower.at(0, 1.4 + i * 0.8, 0.21).y_to_z(), 0.08, 0.14);
  }
  const Builder::Coarser coarse(b, 1.6);  // small parts: the column above has the finer ones
  standing_tank(b, f.at(0.1, 0, -0.15), 0.27, 1.7, false);
  lying_tank(b, f.at(0.75, 2.1, 0), 0.2, 1.15);
  for (const double x : {0.85, 1.75})
    for (const double z : {-0.35, 0.35}) beam(b, f, {x, 0, z}, {x, 2.1, z}, 0.08, 0.08);
  box(b, f, {0.7, 2.03, -0.45}, {1.95, 2.1, 0.45});
  heat_exchanger(b, f.at(0.75, 0, 0.1), 0.14, 1.15);
  pump(b, f.at(-0.5, 0, 0.5), 0.11);
  flanged_pipe(b, f, {{-1.2, 4.45, 0}, {-1.2, 4.75, 0}, {1.0, 4.75, 0}, {1.0, 2.56, 0}}, 0.055);
  flanged_pipe(b, f, {{1.3, 2.1, 0}, {1.3, 1.5, 0}, {0.5, 1.5, 0.5}, {-0.3, 1.5, 0.5}, {-0.3, 0.4, 0.5}}, 0.04);
  flanged_pipe(b, f, {{-0.95, 3.6, 0}, {-0.4, 3.6, 0}, {-0.4, 2.9, 0}, {0.1, 2.9, -0.15}, {0.1, 2.1, -0.15}}, 0.04);
  flanged_pipe(b, f, {{-1.2, 0.7, 0.24}, {-1.2, 0.7, 0.6}, {-0.75, 0.7, 0.6}, {-0.75, 0.2, 0.5}}, 0.04);
  flanged_pipe(b, f, {{0.4, 0.9, -0.15}, {0.8, 0.9, -0.15}, {0.8, 0.55, 0.1}}, 0.035);
  flanged_pipe(b, f, {{1.85, 0.55, 0.1}, {1.85, 1.2, 0.1}, {1.85, 1.2, -0.6}, {-1.2, 1.2, -0.6}, {-1.2, 1.2, -0.24}},
               0.035);
  valve(b, f.at(0, 4.75, 0), 0.06);
  valve(b, f.at(0.1, 1.5, 0.5), 0.04);
}

namespace {

// A steel chute without a bottom or lid: the pulp line's only part with open ends.
void open_chute(Builder& b, const Frame& f, double width, double height) {
  const auto ring = [&](double y, double w) {
    return b.ring(4, true, [&](int i) {
      const auto [c, s] = circle(0.125 + 0.25 * i);
      return f({w * s, y, w * c});
    });
  };
  const int rows = b.segments(height, 2);
  Ring below = ring(0, 0.5 * width);
  for (int row = 1; row <= rows; ++row) {
    const double t = double(row) / rows;
    const Ring above = ring(height * t, width * (0.5 + 0.4 * t));
    b.stitch(below, above);
    below = above;
  }
  b.end_part();
}

// A washing drum in its vat, axis along z.
void drum(Builder& b, const Frame& f, double r, double length) {
  const Frame axis = f.at(0, 1.2 * r, 0).y_to_z();
  tube(b, axis, r, 0.9 * r, length, 20);
  for (int i = 0; i <= 6; ++i) tube(b, axis.at(0, (length - 0.06) * i / 6, 0), 1.05 * r, 0.98 * r, 0.06, 20);
  cylinder(b, axis.at(0, -0.4, 0), 0.16 * r, length + 0.8, 10);
  wheel(b, axis.at(0, 0.08, 0), 0.9 * r, 0.08, 8);
  wheel(b, axis.at(0, length - 0.08, 0), 0.9 * r, 0.08, 8);
  for (const double side : {-1.0, 1.0})
    box(b, f, {side * 1.15 * r - 0.04, 0.2, -0.1}, {side * 1.15 * r + 0.04, 1.2 * r, length + 0.1});
  for (const double z : {-0.14, length + 0.1}) box(b, f, {-1.15 * r, 0, z}, {1.15 * r, 0.75 * r, z + 0.04});
  box(b, f, {-1.15 * r, 0.2, -0.1}, {1.15 * r, 0.26, length + 0.1});
}

// A screw in a trough along z that rises from y = 0.
void screw_conveyor(Builder& b, const Frame& f, double r, double length, int turns) {
  cylinder(b, f.y_to_z(), 0.3 * r, length, 10);
  const int per_turn = b.sides(r, 12);
  const int n = turns * per_turn;
  std::vector<std::vector<Vec3>> sections;
  for (int i = 0; i <= n; ++i) {
    const auto [c, s] = circle(double(i % per_turn) / per_turn);
    const double z = length * i / n;
    sections.push_back({{r * c, r * s, z - 0.02},
                        {0.28 * r * c, 0.28 * r * s, z - 0.02},
                        {0.28 * r * c, 0.28 * r * s, z + 0.02},
                        {r * c, r * s, z + 0.02}});
  }
  loft(b, f, sections);
  for (const double side : {-1.0, 1.0})
    box(b, f, {side * 1.15 * r - 0.03, -1.2 * r, 0}, {side * 1.15 * r + 0.03, 0.4 * r, length});
  box(b, f, {-1.15 * r, -1.25 * r, 0}, {1.15 * r, -1.15 * r, length});
  motor(b, f.at(0, -0.5 * r, length).about_y(-0.25), 0.4 * r);
}

// The line of the normal version: 5.8 wide, 2.8 high, 21 long.
void pulp_line(Builder& b) {
  const Frame f;
  box(b, f, {-3, -0.1, -10.4}, {3.2, 0, 11});
  // From wood chips at -z to pulp at +z.
  hopper(b, f.at(0, 1.2, -9.6), 1.8, 1.4, 1.3);
  open_chute(b, f.at(0, 2.45, -9.6), 0.9, 0.35);
  for (const double x : {-0.8, 0.8})
    for (const double z : {-10.1, -9.1}) i_beam(b, f, {x, 0, z}, {x, 2.0, z}, 0.12, 0.1);
  screw_conveyor(b, f.at(0, 0.7, -9.4), 0.35, 3.4, 9);
  {
    // The belt that brings chips up to the hopper; its long and aslant triangles weigh in the counts.
    const Builder::Coarser long_pieces(b, 3);
    const Vec3 from{2.6, 0.1, -5.6}, to{0.3, 2.65, -9.3};
    const Frame slope = f * along(from, to);
    const double reach = length(to - from);
    box(b, slope, {-0.35, 0, 0.0}, {0.35, reach, 0.04});
    for (const double x : {-0.4, 0.36}) box(b, slope, {x, 0, -0.06}, {x + 0.04, reach, 0.1});
    for (int i = 0; i < 12; ++i)
      rod(b, slope, {-0.36, reach * (i + 0.5) / 12, -0.05}, {0.36, reach * (i + 0.5) / 12, -0.05}, 0.045);
    for (const double t : {0.35, 0.75}) {
      const Vec3 top = from + (to - from) * t;
      for (const double x : {-0.3, 0.3}) beam(b, f, {top.x + x, 0, top.z}, {top.x + x, top.y - 0.1, top.z}, 0.08, 0.08);
    }
  }
  standing_tank(b, f.at(-1.3, 0, -4.6), 0.85, 1.9);
  standing_tank(b, f.at(1.3, 0, -4.6), 0.85, 1.9);
  standing_tank(b, f.at(-1.5, 0, -2.2), 0.7, 1.6);
  lying_tank(b, f.at(0.3, 0, -2.2), 0.6, 2.3);
  drum(b, f.at(0, 0, -0.8), 0.95, 3.0);
  drum(b, f.at(0, 0, 3.0), 0.95, 3.0);
  for (int i = 0; i < 5; ++i) roll(b, f.at(-1.5, 1.0 + 0.25 * (i % 2), 7.0 + 0.62 * i), 0.27, 3.0);
  conveyor(b, f.at(0, 0, 6.5).about_y(-0.25), 3.8, 2.4, 0.6);
  heat_exchanger(b, f.at(1.4, 0, 8.2), 0.26, 1.4);
  press(b, f.at(0, 0, 10.1), 0.62);
  for (int i = 0; i < 6; ++i) pump(b, f.at(i % 2 == 0 ? -2.7 : 2.0, 0, -5.2 + 2.4 * i), 0.15);
  for (int i = 0; i < 5; ++i) cabinet(b, f.at(-2.9, 0, 7.2 + 0.75 * i).about_y(0.25), 0.65, 1.1, 0.3);
  flanged_pipe(b, f, {{0, 0.9, -6.1}, {0, 2.3, -6.1}, {-1.3, 2.3, -6.1}, {-1.3, 2.3, -4.6}, {-1.3, 2.2, -4.6}}, 0.1);
  for (int p = 0; p < 7; ++p) {
    const double x = -1.9 + 0.62 * p, r = 0.05 + 0.015 * (p % 3);
    flanged_pipe(b, f,
                 {{x, 0.4, -5.4 + 0.3 * p},
                  {x, 2.25 + 0.04 * p, -5.4 + 0.3 * p},
                  {x, 2.25 + 0.04 * p, 5.5 + 0.5 * p},
                  {x + 0.5, 2.25 + 0.04 * p, 5.5 + 0.5 * p},
                  {x + 0.5, 1.3, 5.5 + 0.5 * p}},
                 r);
    valve(b, f.at(x, 1.2, -5.4 + 0.3 * p).about_z(0.25), 1.1 * r);
  }
  for (int i = 0; i < 5; ++i) {
    const double z = -4.5 + 3 * i;
    for (const double x : {-2.3, 2.4}) i_beam(b, f, {x, 0, z}, {x, 2.3, z}, 0.1, 0.08);
    i_beam(b, f, {-2.3, 2.2, z}, {2.4, 2.2, z}, 0.1, 0.08);
  }
  catwalk(b, f.at(2.5, 1.35, -4.5), 0.5, 12, 0.5);
  stairs(b, f.at(2.75, 0, -6.4), 0.45, 1.35, 1.9);
}

// A smoke stack with stiffening rings and a ladder.
void stack(Builder& b, const Frame& f, double r, double height) {
  const std::vector<Point2> profile{{0, 0},
                                    {1.6 * r, 0},
                                    {1.6 * r, 0.05 * height},
                                    {r, 0.12 * height},
                                    {0.8 * r, height},
                                    {0.7 * r, height},
                                    {0.7 * r, 0.9 * height},
                                    {0, 0.9 * height}};
  lathe(b, f, profile, b.sides(r, 16));
  for (int i = 2; i <= 8; ++i) tube(b, f.at(0, 0.12 * height * i, 0), (1.12 - 0.025 * i) * r, 0.7 * r, 0.15 * r, 16);
  ladder(b, f.at(0, 0, -1.65 * r).about_y(0.5), 0.5 * r, 0.95 * height);
}

}  // namespace

void draw_our_process(Builder& b) { pulp_line(b); }

// The thesis's versions with small and with large triangles are higher and wider boxes of the same length, so they
// held more than its normal one: here a stack, and a lower stack with a tank at the side.
void draw_our_process_small(Builder& b) {
  pulp_line(b);
  stack(b, Frame{}.at(-2.3, 0, -8.6), 0.5, 16.4);
}

void draw_our_process_large(Builder& b) {
  pulp_line(b);
  stack(b, Frame{}.at(-2.3, 0, -8.6), 0.3, 4.6);
  lying_tank(b, Frame{}.at(3.2, 0, 9), 0.55, 1.5);
}

}  // namespace standoff::scenes
