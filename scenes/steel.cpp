// SPDX-License-Identifier: Apache-2.0
#include "scenes/steel.h"

namespace standoff::scenes {

void i_beam(Builder& b, const Frame& f, Vec3 from, Vec3 to, double height, double width) {
  const double h = height / 2, w = width / 2, web = 0.12 * width, flange = 0.12 * height;
  const std::vector<Point2> outline{
      {-w, -h}, {w, -h}, {w, -h + flange}, {web / 2, -h + flange}, {web / 2, h - flange},   {w, h - flange},
      {w, h},   {-w, h}, {-w, h - flange}, {-web / 2, h - flange}, {-web / 2, -h + flange}, {-w, -h + flange}};
  extrude(b, f * along(from, to), outline, length(to - from));
}

void bolt_circle(Builder& b, const Frame& f, double radius, int bolts, double size) {
  if (b.hides(size, 1.2 * size)) return;
  for (int i = 0; i < bolts; ++i) {
    const auto [c, s] = circle((i + 0.5) / bolts);
    const std::vector<Point2> head{
        {0, 0}, {size / 2, 0}, {size / 2, 0.6 * size}, {size / 4, 0.6 * size}, {size / 4, 1.2 * size}, {0, 1.2 * size}};
    lathe(b, f.at(radius * c, 0, radius * s), head, 6);
  }
}

void column(Builder& b, const Frame& f, double height, double size) {
  i_beam(b, f, {0, 0, 0}, {0, height, 0}, size, size * 0.8);
  box(b, f, {-size, 0, -size}, {size, 0.15 * size, size});
  bolt_circle(b, f.at(0, 0.15 * size, 0), 1.05 * size, 4, 0.2 * size);
}

void truss(Builder& b, const Frame& f, Vec3 from, Vec3 to, double depth, int panels) {
  const double bar = 0.12 * depth;
  const Vec3 up{0, depth, 0}, step = (to - from) * (1.0 / panels);
  beam(b, f, from, to, bar, bar);
  beam(b, f, from + up, to + up, bar, bar);
  for (int i = 0; i <= panels; ++i) {
    const Vec3 foot = from + step * i;
    beam(b, f, foot, foot + up, 0.6 * bar, 0.6 * bar);
    if (i < panels)
      beam(b, f, foot + (i % 2 == 0 ? Vec3{} : up), foot + step + (i % 2 == 0 ? up : Vec3{}), 0.6 * bar, 0.6 * bar);
  }
}

void railing(Builder& b, const Frame& f, Vec3 from, Vec3 to, double height) {
  const double r = 0.025 * height;
  const double reach = length(to - from);
  const int posts = std::max(1, static_cast<int>(reach / (1.2 * height)));
  for (const double level : {1.0, 0.55})
    rod(b, f, from + Vec3{0, level * height, 0}, to + Vec3{0, level * height, 0}, r);
  for (int i = 0; i <= posts; ++i) {
    const Vec3 foot = from + (to - from) * (double(i) / posts);
    rod(b, f, foot, foot + Vec3{0, height, 0}, r);
  }
  beam(b, f, from + Vec3{0, 0.06 * height, 0}, to + Vec3{0, 0.06 * height, 0}, 0.02 * height, 0.12 * height);
}

void ladder(Builder& b, const Frame& f, double width, double height, bool caged) {
  const double r = 0.05 * width;
  for (const double side : {-0.5, 0.5}) rod(b, f, {side * width, 0, 0}, {side * width, height, 0}, r);
  const int rungs = static_cast<int>(height / (0.6 * width));
  for (int i = 1; i <= rungs; ++i) {
    const double y = i * height / (rungs + 1);
    rod(b, f, {-width / 2, y, 0}, {width / 2, y, 0}, 0.6 * r);
  }
  if (!caged) return;
  const int hoops = static_cast<int>(height / (1.5 * width));
  for (int i = 2; i <= hoops; ++i) {
    const double y = i * height / hoops;
    const std::vector<Vec3> path{
        Vec3{-width / 2, y, 0}, {-0.7 * width, y, 1.4 * width}, {0.7 * width, y, 1.4 * width}, {width / 2, y, 0}};
    pipe(b, f, path, 0.5 * r, 0.5 * width, 6);
  }
  for (int i = -1; i <= 1; ++i)
    beam(b, f, {0.6 * width * i, 3 * width, 1.35 * width}, {0.6 * width * i, height, 1.35 * width}, r, 0.4 * r);
}

void stairs(Builder& b, const Frame& f, double width, double height, double run) {
  const int steps = std::max(3, static_cast<int>(height / (0.28 * width)));
  for (const double side : {-0.5, 0.5}) {
    beam(b, f, {side * width, 0, 0}, {side * width, height, run}, 0.05 * width, 0.25 * width);
    railing(b, f, {side * width, 0, 0}, {side * width, height, run}, width);
  }
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps, z = run * t, y = height * t;
    box(b, f, {-width / 2, y, z}, {width / 2, y + 0.04 * width, z + 0.9 * run / steps});
  }
}

void grating(Builder& b, const Frame& f, double x, double z, double pitch) {
  const double bar = 0.2 * pitch;
  if (b.hides(std::min(x, z), 2 * bar)) {
    box(b, f, {0, -2 * bar, 0}, {x, 0, z});
    return;
  }
  const int across = std::max(1, static_cast<int>(z / pitch)), lengthwise = std::max(1, static_cast<int>(x / pitch));
  for (int i = 0; i <= across; ++i) {
    const double at = (z - bar) * i / across;
    box(b, f, {0, -2 * bar, at}, {x, 0, at + bar});
  }
  for (int i = 0; i <= lengthwise; ++i) {
    const double at = (x - bar) * i / lengthwise;
    box(b, f, {at, -2 * bar, 0}, {at + bar, -0.2 * bar, z});
  }
}

void catwalk(Builder& b, const Frame& f, double width, double length, double rail_height) {
  grating(b, f, width, length, width / 12);
  for (const double x : {0.0, width}) {
    i_beam(b, f, {x, -0.12 * width, 0}, {x, -0.12 * width, length}, 0.2 * width, 0.1 * width);
    railing(b, f, {x, 0, 0}, {x, 0, length}, rail_height);
  }
}

}  // namespace standoff::scenes
