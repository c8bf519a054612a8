// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/number_text.h"
#include "core/threads.h"
#include "field/triangle_groups.h"
#include "geometry/closest_point.h"
#include "standoff/error.h"
#include "standoff/points.h"

namespace standoff {
namespace {

void check(MeshView mesh, std::span<const Vec3> points) {
  validate(mesh);
  const Box box = bounds(mesh);
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMaxCoordinate))
    throw Error(ErrorCode::limit, "points: the mesh reaches beyond " + number_text(kMaxCoordinate) + "; scale it down");
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (!is_finite(points[n]))
      throw Error(ErrorCode::usage, "points: point " + std::to_string(n) + " is not finite; leave it out");
    if (!(max_norm(points[n]) <= kMaxCoordinate))
      throw Error(ErrorCode::limit, "points: point " + std::to_string(n) + " lies beyond " +
                                        number_text(kMaxCoordinate) + "; scale it down");
  }
}

using Corners = std::array<Triple<double>, 3>;
using Weights = std::array<double, 3>;

// The weights of q, which lies on the side from corner i to corner j.
Weights on_side(const Corners& c, const Triple<double>& q, int i, int j) {
  const Triple<double> side = c[j] - c[i];
  const double length_sq = dot(side, side);
  const double share = length_sq > 0 ? std::clamp(dot(q - c[i], side) / length_sq, 0.0, 1.0) : 0;
  Weights weights{};
  weights[i] = 1 - share;
  weights[j] = share;
  return weights;
}

// The weights of q, which lies inside: the shares of the triangle's area that lie across from each corner.
Weights inside(const Corners& c, const Triple<double>& q) {
  const Triple<double> normal = cross(c[1] - c[0], c[2] - c[0]);
  const auto area = [&](int i, int j) { return std::max(0.0, dot(normal, cross(c[i] - q, c[j] - q))); };
  const double across[3] = {area(1, 2), area(2, 0), area(0, 1)};
  const double sum = across[0] + across[1] + across[2];
  if (!(sum > 0)) return {1, 0, 0};
  return {across[0] / sum, across[1] / sum, across[2] / sum};
}

// The closest point of a triangle to the origin. A side goes before the inside, as in closest_distance_sq: it is the
// better one where a sliver's width is lost in rounding.
ClosestPoint closest_to_origin(const Corners& c) {
  const Triple<double> origin{0, 0, 0};
  ClosestPoint best;
  double best_sq = std::numeric_limits<double>::infinity();
  const auto look = [&](const Triple<double>& q, auto weights) {
    const double sq = dot(q, q);
    if (!(sq < best_sq)) return;
    best_sq = sq;
    best = {.distance = std::sqrt(sq), .point = {q.x, q.y, q.z}, .weights = weights(q)};
  };
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    look(closest_on_segment(origin, c[i], c[j]), [&](const Triple<double>& q) { return on_side(c, q, i, j); });
  }
  look(closest_on_triangle(origin, c[0], c[1], c[2]), [&](const Triple<double>& q) { return inside(c, q); });
  return best;
}

ClosestPoint closest(MeshView mesh, const TriangleGroups& groups, Vec3 p) {
  const std::uint32_t triangle = groups.nearest(p);
  // Relative to the point, so that a mesh far from the origin loses nothing.
  const auto corner = [&](int k) { return triple_of(mesh.corner(triangle, k) - p); };
  ClosestPoint found = closest_to_origin({corner(0), corner(1), corner(2)});
  found.point = found.point + p;
  found.triangle = triangle;
  return found;
}

}  // namespace

std::vector<ClosestPoint> closest_points(MeshView mesh, std::span<const Vec3> points, const Execution& execution) try {
  validate("points", execution, Runs::on_the_cpu);
  check(mesh, points);
  std::vector<ClosestPoint> found(points.size());
  if (points.empty()) return found;
  Threads(execution.threads).run([&] {
    const TriangleGroups groups(mesh);
    tbb::parallel_for(std::size_t{0}, points.size(),
                      [&](std::size_t n) { found[n] = closest(mesh, groups, points[n]); });
  });
  return found;
} catch (...) {
  throw_as_error("points", "ask about fewer points at once, or provide more memory");
}

}  // namespace standoff
