// SPDX-License-Identifier: Apache-2.0
#include "thesis/thesis.h"

#include <algorithm>
#include <cmath>

#include "geometry/triangle_box.h"

namespace standoff {
namespace {

bool contains(const Box& outer, const Box& inner) {
  return outer.min.x <= inner.min.x && outer.min.y <= inner.min.y && outer.min.z <= inner.min.z &&
         inner.max.x <= outer.max.x && inner.max.y <= outer.max.y && inner.max.z <= outer.max.z;
}

// The share of [low, high] in [other_low, other_high], all of it grown by `margin`.
double share_on_axis(double low, double high, double other_low, double other_high, double margin) {
  const double common = std::min(high, other_high) - std::max(low, other_low);
  const double whole = (high - low) + 2 * margin, inside = common + 2 * margin;
  if (whole > 0) return std::max(0.0, inside / whole);
  return common >= 0 ? 1 : 0;
}

}  // namespace

double share_inside(const Box& inner, const Box& outer, double margin) {
  return share_on_axis(inner.min.x, inner.max.x, outer.min.x, outer.max.x, margin) *
         share_on_axis(inner.min.y, inner.max.y, outer.min.y, outer.max.y, margin) *
         share_on_axis(inner.min.z, inner.max.z, outer.min.z, outer.max.z, margin);
}

std::vector<std::uint32_t> kept_by_neighbour_rule(MeshView mesh, double thickness, double fraction) {
  const double margin = std::isinf(thickness) ? 0 : thickness;
  const auto inside = [&](const Box& inner, const Box& outer) {
    return contains(outer, inner) || (fraction < 1 && share_inside(inner, outer, margin) >= fraction);
  };
  // The thesis repeats its pass until nothing more is dropped. A single pass that looks back does the same: a new
  // triangle is dropped if it lies inside the last one kept; else it drops the triangles before it that lie inside it,
  // one by one. Each new pair of neighbours is compared both ways, so at the end no neighbour of a kept triangle can be
  // dropped.
  std::vector<std::uint32_t> kept;
  kept.reserve(mesh.triangles.size());
  Box last;
  for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    const Box box = triangle_box(mesh, triangle);
    bool dropped = false;
    while (!kept.empty()) {
      dropped = inside(box, last);
      if (dropped || !inside(last, box)) break;
      kept.pop_back();
      if (!kept.empty()) last = triangle_box(mesh, kept.back());
    }
    if (dropped) continue;
    kept.push_back(triangle);
    last = box;
  }
  return kept;
}

}  // namespace standoff
