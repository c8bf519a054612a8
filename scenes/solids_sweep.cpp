// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "scenes/solids.h"

namespace standoff::scenes {
namespace {

// The path with its interior corners replaced by arcs. An arc is a rational quadratic Bezier curve whose middle
// weight is the cosine of half the turn: exact, and free of inverse trigonometric functions.
std::vector<Vec3> rounded(const Builder& b, const std::vector<Vec3>& corners, double bend) {
  std::vector<Vec3> path{corners.front()};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 in = corners[i] - corners[i - 1], out = corners[i + 1] - corners[i];
    const double in_length = length(in), out_length = length(out);
    const Vec3 u = in * (1 / in_length), v = out * (1 / out_length);
    const double c = dot(u, v);
    const double tangent_of_half = std::sqrt((1 - c) / (1 + c));
    const double reach = std::min(bend * tangent_of_half, 0.45 * std::min(in_length, out_length));
    const double w = std::sqrt((1 + c) / 2);
    const Vec3 start = corners[i] - u * reach, end = corners[i] + v * reach;
    const int pieces = b.segments(1.5 * reach, 3);
    for (int k = 0; k <= pieces; ++k) {
      const double t = double(k) / pieces, s = 1 - t;
      const double weight = s * s + 2 * s * t * w + t * t;
      path.push_back((start * (s * s) + corners[i] * (2 * s * t * w) + end * (t * t)) * (1 / weight));
    }
  }
  path.push_back(corners.back());
  return path;
}

// Points between the given ones so that no step is much longer than the target edge.
std::vector<Vec3> divided(const Builder& b, const std::vector<Vec3>& path) {
  std::vector<Vec3> result{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3 step = path[i] - path[i - 1];
    const int pieces = b.segments(length(step));
    for (int k = 1; k <= pieces; ++k)
      result.push_back(k == pieces ? path[i] : path[i - 1] + step * (double(k) / pieces));
  }
  return result;
}

}  // namespace

void sweep(Builder& b, const Frame& f, const std::vector<Vec3>& path, const std::vector<double>& radii, int sides) {
  double reach = 0;
  for (std::size_t i = 1; i < path.size(); ++i) reach += length(path[i] - path[i - 1]);
  if (b.hides(reach, 2 * *std::max_element(radii.begin(), radii.end()))) return;
  if (b.counting()) {
    b.count_only(std::int64_t{2} * sides * static_cast<std::int64_t>(path.size()));
    return;
  }
  std::vector<CirclePoint> directions;
  for (int i = 0; i < sides; ++i) directions.push_back(circle(double(i) / sides));
  Vec3 x = perpendicular(normalized(path[1] - path[0]));
  Ring below = b.point(f(path[0]));
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Vec3 before = k > 0 ? normalized(path[k] - path[k - 1]) : normalized(path[1] - path[0]);
    const Vec3 after = k + 1 < path.size() ? normalized(path[k + 1] - path[k]) : before;
    const Vec3 y = normalized(before + after);
    x = normalized(x - y * dot(x, y));  // carried along: the section does not twist
    const Vec3 z = cross(x, y);
    const double radius = radii.size() == 1 ? radii[0] : radii[k];
    const Ring above = b.ring(sides, true, [&](int i) {
      return f(path[k] + x * (radius * directions[i].sin) + z * (radius * directions[i].cos));
    });
    b.stitch(below, above);
    below = above;
  }
  b.stitch(below, b.point(f(path.back())));
  b.end_part();
}

void pipe(Builder& b, const Frame& f, const std::vector<Vec3>& corners, double radius, double bend, int least_sides) {
  const auto path =
      divided(b, bend > 0 ? rounded(b, corners, bend) : std::vector<Vec3>(corners.begin(), corners.end()));
  sweep(b, f, path, {radius}, b.sides(radius, least_sides));
}

void loft(Builder& b, const Frame& f, const std::vector<std::vector<Vec3>>& sections, bool close_ends) {
  const auto centre = [](const std::vector<Vec3>& section) {
    Vec3 sum;
    for (const Vec3 p : section) sum = sum + p;
    return sum * (1.0 / static_cast<double>(section.size()));
  };
  const auto ring = [&](const std::vector<Vec3>& section) {
    if (section.size() == 1) return b.point(f(section[0]));
    return b.ring(static_cast<int>(section.size()), true, [&](int i) { return f(section[i]); });
  };
  Ring below = ring(sections.front());
  if (close_ends && below.count > 1) b.stitch(b.point(f(centre(sections.front()))), below);
  for (std::size_t k = 1; k < sections.size(); ++k) {
    const Ring above = ring(sections[k]);
    b.stitch(below, above);
    below = above;
  }
  if (close_ends && below.count > 1) b.stitch(below, b.point(f(centre(sections.back()))));
  b.end_part();
}

}  // namespace standoff::scenes
