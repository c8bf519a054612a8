// SPDX-License-Identifier: Apache-2.0
// What is true of all pairs of triangles of two placed bodies, by the exact test, in the order of the triangles.
#pragma once

#include <utility>
#include <vector>

#include "tests/collision/bodies.h"
#include "tests/collision/zoo/gap.h"

namespace standoff::testing {

using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// A body in the world: its triangles and their boxes.
class PlacedBody {
 public:
  PlacedBody(MeshView mesh, const Pose& pose) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      triangles_.push_back(corners_at(mesh, t, pose));
      Box& box = boxes_.emplace_back();
      for (const Vec3& v : triangles_.back()) box.include(v);
      all_.include(box.min), all_.include(box.max);
    }
  }
  std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size()); }
  const Corners& triangle(std::uint32_t t) const { return triangles_[t]; }
  const Box& box(std::uint32_t t) const { return boxes_[t]; }
  const Box& box() const { return all_; }

 private:
  std::vector<Corners> triangles_;
  std::vector<Box> boxes_;
  Box all_;
};

/// `visit(s, t)` for all pairs whose boxes are within `margin` of each other on all axes.
template <class Visit>
void for_close_boxes(const PlacedBody& a, const PlacedBody& b, double margin, Visit visit) {
  std::vector<std::uint32_t> order(b.size());
  for (std::uint32_t t = 0; t < b.size(); ++t) order[t] = t;
  std::sort(order.begin(), order.end(), [&](auto s, auto t) { return b.box(s).min.x < b.box(t).min.x; });
  double widest = 0;
  for (std::uint32_t t = 0; t < b.size(); ++t) widest = std::max(widest, b.box(t).max.x - b.box(t).min.x);
  // Rounding of the sums with the margin: a little more is visited, never less.
  const Vec3 m = Vec3{1, 1, 1} * (margin * (1 + 1e-9));
  for (std::uint32_t s = 0; s < a.size(); ++s) {
    const Box box{a.box(s).min - m, a.box(s).max + m};
    const double from = box.min.x - widest * (1 + 1e-9);
    auto at = std::lower_bound(order.begin(), order.end(), from,
                               [&](std::uint32_t t, double x) { return b.box(t).min.x < x; });
    for (; at != order.end() && b.box(*at).min.x <= box.max.x; ++at) {
      const Box& other = b.box(*at);
      if (other.max.x >= box.min.x && other.min.y <= box.max.y && other.max.y >= box.min.y &&
          other.min.z <= box.max.z && other.max.z >= box.min.z)
        visit(s, *at);
    }
  }
}

inline TrianglePairs touching_pairs(const PlacedBody& a, const PlacedBody& b) {
  TrianglePairs pairs;
  for_close_boxes(a, b, 0, [&](std::uint32_t s, std::uint32_t t) {
    if (touch(a.triangle(s), b.triangle(t))) pairs.emplace_back(s, t);
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace standoff::testing
