// SPDX-License-Identifier: Apache-2.0
// No triangle in use, but for those in the same plane, has points in the interior of a triangle that is not cut. So
// just in front of it, before all that lie in its plane, the winding number is the same all over, and so it is just
// behind: one row through the triangle decides. Walls that two boxes have in common need not have the same triangles.
// Where a box stands on a part of a triangle, its sides have edges there, and cut it.
#include "sign/outer/exposed.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "bvh/bvh.h"
#include "bvh/order.h"
#include "geometry/predicates.h"
#include "sign/open_winding/winding_rule.h"
#include "sign/outer/mesh_cuts.h"
#include "sign/outer/row_sides.h"

namespace standoff {
namespace {

int steepest_axis(const Corners& t) {
  const Vec3 n = normal_direction(t);
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

class Classify {
 public:
  Classify(const OrientedMesh& mesh, WindingRule rule, ProgressMeter& progress)
      : mesh_(mesh),
        rule_(rule),
        progress_(progress),
        bvh_(mesh.mesh, morton_order(mesh.mesh, {}, progress), frame_around(mesh.mesh), progress),
        cuts_(find_cuts(mesh, bvh_, progress)),
        rows_(mesh, bvh_) {}

  Exposures all() const {
    const std::size_t triangles = mesh_.mesh.triangles.size();
    Exposures found;
    found.of.resize(triangles, Exposure::cut);
    const auto for_each = [&](const auto& use) {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 256), [&](const auto& range) {
        progress_.check();
        for (std::size_t t = range.begin(); t != range.end(); ++t) use(static_cast<std::uint32_t>(t));
      });
    };
    for_each([&](std::uint32_t t) {
      if (cuts_.flat[t] == 0 && cuts_.cut[t] == 0) found.of[t] = by_rows(t);
    });
    for_each([&](std::uint32_t t) {
      if (cuts_.flat[t] != 0) found.of[t] = by_neighbours(t, found.of);
    });
    found.internal = std::ranges::count(found.of, Exposure::internal);
    found.cut = std::ranges::count(found.of, Exposure::cut);
    return found;
  }

 private:
  // By a row through the middle, or near it where rounding hides too much there.
  Exposure by_rows(std::uint32_t triangle) const {
    const Corners corners = mesh_.mesh.corners(triangle);
    const int axis = steepest_axis(corners);
    const FlatCorners t = dropped(corners, axis);
    constexpr double kShares[][3] = {{1. / 3, 1. / 3, 1. / 3}, {.5, .3, .2}, {.2, .5, .3}, {.3, .2, .5}};
    for (const auto& [a, b, c] : kShares) {
      const Flat middle{a * t[0].x + b * t[1].x + c * t[2].x, a * t[0].y + b * t[1].y + c * t[2].y};
      if (const Exposure found = at(triangle, {axis, middle}); found != Exposure::cut) return found;
    }
    return Exposure::cut;
  }

  Exposure at(std::uint32_t triangle, const Row& row) const {
    const std::optional<TwoSides> sides = rows_.of(triangle, row);
    if (!sides) return Exposure::cut;
    return is_inside(sides->before, rule_) && is_inside(sides->behind, rule_) ? Exposure::internal : Exposure::exposed;
  }

  // A triangle without an area is a line. If those that touch it are all internal, the space around it is inside: from
  // each part of it to the next one the way leads through one of them, which has inside on both sides.
  Exposure by_neighbours(std::uint32_t triangle, std::span<const Exposure> of) const {
    const auto touched_by = pairs_of(cuts_.touched, triangle);
    const bool all_internal =
        std::ranges::all_of(touched_by, [&](const auto& pair) { return of[pair.second] == Exposure::internal; });
    return all_internal && !touched_by.empty() ? Exposure::internal : Exposure::exposed;
  }

  OrientedMesh mesh_;
  WindingRule rule_;
  ProgressMeter& progress_;
  Bvh bvh_;
  MeshCuts cuts_;
  RowSides rows_;
};

}  // namespace

Exposures find_exposed(const OrientedMesh& mesh, WindingRule rule, ProgressMeter& progress) {
  return Classify(mesh, rule, progress).all();
}

}  // namespace standoff
