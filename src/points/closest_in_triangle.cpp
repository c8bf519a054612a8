// SPDX-License-Identifier: Apache-2.0
#include "points/closest_in_triangle.h"

#include <cmath>

namespace standoff {
namespace {

using CornersFromPoint = std::array<Triple<double>, 3>;

bool same(const Triple<double>& a, const Triple<double>& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

Feature edge(std::size_t n) { return static_cast<Feature>(static_cast<int>(Feature::edge0) + static_cast<int>(n)); }
Feature vertex(std::size_t n) { return static_cast<Feature>(static_cast<int>(Feature::vertex0) + static_cast<int>(n)); }

// Where on the edge from corner n the point q is.
void set_on_edge(const CornersFromPoint& c, std::size_t n, const Triple<double>& q, ClosestPoint& at) {
  const std::size_t next = (n + 1) % 3;
  if (same(q, c[n]) || same(q, c[next])) {
    const std::size_t corner = same(q, c[n]) ? n : next;
    at.feature = vertex(corner);
    at.weights[corner] = 1;
    return;
  }
  const Triple<double> along = c[next] - c[n];
  const double share = std::clamp(dot(q - c[n], along) / dot(along, along), 0.0, 1.0);
  at.feature = edge(n);
  at.weights[n] = 1 - share;
  at.weights[next] = share;
}

}  // namespace

ClosestPoint closest_in_triangle(const CornersFromPoint& c) {
  ClosestPoint at;
  double best_sq = std::numeric_limits<double>::infinity();
  std::size_t side = 0;
  Triple<double> best = c[0];
  for (std::size_t n = 0; n < 3; ++n) {
    const Triple<double> q = nearest_on_edge(c[n], c[(n + 1) % 3]);
    const double sq = dot(q, q);
    if (!(sq < best_sq)) continue;
    best_sq = sq, best = q, side = n;
  }
  const NearestInside<double> inside = nearest_inside(c[0], c[1], c[2]);
  const Triple<double> face = point_inside(inside, c[0], c[1], c[2]);
  if (inside.least > 0 && dot(face, face) < best_sq) {
    best_sq = dot(face, face), best = face;
    at.feature = Feature::face;
    for (std::size_t n = 0; n < 3; ++n) at.weights[n] = inside.across[n] / inside.sum;
  } else {
    set_on_edge(c, side, best, at);
  }
  at.distance = std::sqrt(best_sq);
  at.point = vec_of(best);
  return at;
}

}  // namespace standoff
