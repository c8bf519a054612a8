// SPDX-License-Identifier: Apache-2.0
// A house fly that looks along +z: head with big eyes, ringed abdomen, two wings, six legs.
#include "scenes/families.h"
#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

// The middle and the half width of a wing at a share t of its length; the wing starts at the origin and goes along +x.
Vec3 wing_middle(double t) { return {0.05 + 1.6 * t, 0.12 * t * t, -0.25 * t}; }
double wing_half(double t) { return 0.06 + 0.42 * std::sqrt(std::max(0.0, t * (1.04 - t)) * 2) * (0.7 + 0.3 * t); }

// A thin wing, with both sides, and its veins.
void wing(Builder& b, const Frame& f, double side) {
  const int pieces = b.segments(1.8, 6), around = 8;
  const auto at = [&](double t, double across, double up) {
    const Vec3 middle = wing_middle(t);
    return Vec3{side * middle.x, middle.y + up, middle.z + wing_half(t) * (across - 0.2)};
  };
  std::vector<std::vector<Vec3>> sections;
  for (int i = 0; i <= pieces; ++i) {
    std::vector<Vec3> section;
    for (int k = 0; k < around; ++k) {
      const auto [c, s] = circle(double(k) / around);
      section.push_back(at(double(i) / pieces, -side * c, 0.012 * s));
    }
    sections.push_back(section);
  }
  loft(b, f, sections);
  for (const double spread : {0.97, 0.55, 0.1, -0.4, -0.8}) {
    std::vector<Vec3> vein{at(0, 0, 0.014)};
    for (int i = 1; i <= 5; ++i) vein.push_back(at(0.17 * i, spread * std::min(1.0, 0.3 * i), 0.014));
    pipe(b, f, vein, 0.014, 0, 5);
  }
}

// Hip, thigh, shin and foot; `side` is -1 or 1, z where the leg starts and where it stands.
void leg(Builder& b, double side, double z_from, double z_to) {
  const std::vector<Vec3> path{{0.2 * side, 0.55, z_from},
                               {0.42 * side, 0.5, 0.7 * z_from + 0.3 * z_to},
                               {0.85 * side, 0.95, 0.4 * z_from + 0.6 * z_to},
                               {1.12 * side, 0.25, 0.9 * z_to + 0.1 * z_from},
                               {1.2 * side, 0.04, z_to},
                               {1.38 * side, 0.02, 1.06 * z_to}};
  sweep(b, {}, path, {0.05, 0.07, 0.05, 0.03, 0.022, 0.012}, b.sides(0.06, 6));
  for (std::size_t joint = 1; joint < 4; ++joint) ellipsoid(b, Frame{}.at(path[joint]), {0.06, 0.06, 0.06}, 6);
}

}  // namespace

void draw_fly(Builder& b) {
  const Frame f = Frame{}.at(0, 0.72, 0);
  ellipsoid(b, f, {0.38, 0.36, 0.5}, 10);
  // The abdomen, ringed, tapering backwards.
  std::vector<Point2> rings{{0, 0}};
  for (int i = 1; i < 12; ++i) {
    const double t = i / 12.0;
    rings.push_back({0.46 * std::sqrt(t * (1 - t) * 4) * (1 - 0.25 * t) * (i % 2 == 0 ? 1.0 : 0.94), 1.25 * t});
  }
  rings.push_back({0, 1.27});
  const Frame back = f.at(0, -0.02, -0.35).about_x(-0.27);
  lathe(b, back.scaled(1, 1, 0.85), rings, b.sides(0.42, 12));
  const Frame head = f.at(0, 0.02, 0.68);
  ellipsoid(b, head, {0.3, 0.27, 0.22}, 8);
  for (const double side : {-1.0, 1.0}) {
    const Builder::Coarser compound(b, 0.7);
    ellipsoid(b, head.at(0.2 * side, 0.06, 0.05), {0.19, 0.24, 0.19}, 12);
    pipe(b, head, {{0.06 * side, 0.1, 0.18}, {0.1 * side, 0.16, 0.32}, {0.16 * side, 0.1, 0.4}}, 0.018, 0.05, 5);
    ellipsoid(b, f.at(0.36 * side, 0.12, -0.38), {0.05, 0.05, 0.07}, 6);
  }
  sweep(b, head, {{0, -0.15, 0.1}, {0, -0.32, 0.2}, {0, -0.42, 0.24}, {0, -0.46, 0.26}}, {0.06, 0.045, 0.05, 0.09},
        b.sides(0.06, 6));
  wing(b, f.at(0.14, 0.3, 0), 1);
  wing(b, f.at(-0.14, 0.3, 0), -1);
  for (const double side : {-1.0, 1.0}) {
    leg(b, side, 0.3, 0.95);
    leg(b, side, 0.02, -0.1);
    leg(b, side, -0.22, -1.15);
  }
  for (int i = 0; i < 24; ++i) {
    const auto [c, s] = circle(i / 24.0);
    const Vec3 root{0.3 * c, 0.22, 0.4 * s};
    rod(b, f, root, root * 1.35 + Vec3{0, 0.08, 0}, 0.008, 4);
  }
}

}  // namespace standoff::scenes
