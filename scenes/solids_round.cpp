// SPDX-License-Identifier: Apache-2.0

#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

bool on_axis(Point2 p) { return p.u == 0; }

}  // namespace

void lathe(Builder& b, const Frame& f, const std::vector<Point2>& profile, int sides, bool loop) {
  double reach = 0, low = profile[0].v, high = low;
  for (const Point2 p : profile) {
    reach = std::max(reach, p.u);
    low = std::min(low, p.v);
    high = std::max(high, p.v);
  }
  if (b.hides(2 * reach, std::max(2 * reach, high - low))) return;
  std::vector<CirclePoint> directions;
  if (!b.counting())
    for (int i = 0; i < sides; ++i) directions.push_back(circle(double(i) / sides));
  const auto ring = [&](Point2 p) {
    if (on_axis(p)) return b.point(f({0, p.v, 0}));
    return b.ring(sides, true, [&](int i) { return f({p.u * directions[i].sin, p.v, p.u * directions[i].cos}); });
  };
  const Ring first = ring(profile[0]);
  Ring below = first;
  const std::size_t edges = profile.size() - (loop ? 0 : 1);
  for (std::size_t e = 0; e < edges; ++e) {
    const Point2 from = profile[e], to = profile[(e + 1) % profile.size()];
    const double du = to.u - from.u, dv = to.v - from.v;
    // Annuli and discs keep one piece up to twice the target edge: finer rings near an axis would be slivers.
    const int pieces = b.segments(std::sqrt(du * du + dv * dv) * (dv == 0 ? 0.5 : 1.0));
    for (int i = 1; i <= pieces; ++i) {
      const double t = double(i) / pieces;
      const bool last = i == pieces;
      const Ring above =
          last && loop && e + 1 == edges ? first : ring(last ? to : Point2{from.u + du * t, from.v + dv * t});
      b.stitch(below, above);
      below = above;
    }
  }
  b.end_part();
}

void cylinder(Builder& b, const Frame& f, double radius, double height, int least_sides) {
  cone(b, f, radius, radius, height, least_sides);
}

void rod(Builder& b, const Frame& f, Vec3 from, Vec3 to, double radius, int least_sides) {
  cylinder(b, f * along(from, to), radius, length(to - from), least_sides);
}

void cone(Builder& b, const Frame& f, double bottom_radius, double top_radius, double height, int least_sides) {
  const int sides = b.sides(std::max(bottom_radius, top_radius), least_sides);
  if (top_radius == 0) {
    lathe(b, f, {{0, 0}, {bottom_radius, 0}, {0, height}}, sides);
  } else {
    lathe(b, f, {{0, 0}, {bottom_radius, 0}, {top_radius, height}, {0, height}}, sides);
  }
}

void tube(Builder& b, const Frame& f, double outer, double inner, double height, int least_sides) {
  lathe(b, f, {{outer, 0}, {outer, height}, {inner, height}, {inner, 0}}, b.sides(outer, least_sides), true);
}

void torus(Builder& b, const Frame& f, double radius, double thickness, int least_sides) {
  std::vector<Point2> profile;
  const int pieces = b.sides(thickness, 6);
  for (int i = 0; i < pieces; ++i) {
    const auto [c, s] = circle(double(i) / pieces);
    profile.push_back({radius + thickness * c, thickness * s});
  }
  lathe(b, f, profile, b.sides(radius, least_sides), true);
}

void ellipsoid(Builder& b, const Frame& f, Vec3 radii, int least_sides) {
  const int sides = b.sides(std::max({radii.x, radii.y, radii.z}) * 0.9, least_sides);
  const int bands = std::max(4, sides / 2);
  std::vector<Point2> profile{{0, -1}};
  for (int i = 1; i < bands; ++i) {
    const auto [c, s] = circle(0.5 * i / bands);
    profile.push_back({s, -c});
  }
  profile.push_back({0, 1});
  const double unit = std::max({radii.x, radii.y, radii.z});
  const Builder::Coarser whole_bands(b, 1 / unit);  // the profile is on the unit sphere
  lathe(b, f.scaled(radii.x, radii.y, radii.z), profile, sides);
}

void append_dome(std::vector<Point2>& profile, double radius, double y, double bulge, int pieces, bool top) {
  for (int i = 0; i <= pieces; ++i) {
    const auto [c, s] = circle(0.25 * i / pieces);
    if (top) {
      profile.push_back(i == pieces ? Point2{0, y + bulge} : Point2{radius * c, y + bulge * s});
    } else {
      profile.push_back(i == 0 ? Point2{0, y - bulge} : Point2{radius * s, y - bulge * c});
    }
  }
}

}  // namespace standoff::scenes
