// SPDX-License-Identifier: Apache-2.0
#include "sign/outer/outer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "bvh/bvh.h"
#include "bvh/order.h"
#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "sign/oriented_mesh.h"
#include "sign/outer/triangle_cuts.h"
#include "sign/rows/ray_crossing.h"
#include "sign/sides.h"
#include "standoff/error.h"
#include "standoff/exposed.h"
#include "standoff/sign.h"

namespace standoff {
namespace {

// The winding numbers on the two sides of a triangle where a row, a line along an axis, passes through it.

// A line along an axis: 0 to 2 for x to z, at (y, z), (z, x) or (x, y).
struct Row {
  int axis;
  Flat at;
};

// Rotates the axes so that this one becomes x, in the cycle that ray_crossing.h describes.
Vec3 rotated(const Vec3& v, int axis) {
  if (axis == 0) return v;
  if (axis == 1) return {v.y, v.z, v.x};
  return {v.z, v.x, v.y};
}

Corners rotated(const Corners& t, int axis) { return {rotated(t[0], axis), rotated(t[1], axis), rotated(t[2], axis)}; }

// The box of a row, as long as the mesh.
Box box_of(const Row& row, Box box) {
  const auto fix = [&](double Vec3::*part, double at) { box.min.*part = box.max.*part = at; };
  fix(row.axis == 0 ? &Vec3::y : row.axis == 1 ? &Vec3::z : &Vec3::x, row.at.x);
  fix(row.axis == 0 ? &Vec3::z : row.axis == 1 ? &Vec3::x : &Vec3::y, row.at.y);
  return box;
}

struct PlaceInterval {
  double low, high;
};

// An interval that contains the place where a row along x crosses the triangle: x = x0 - s / n_x with
// s = n_y dy + n_z dz and the normal n. With the roundoff u, a part of n is off by less than 4 u times its products'
// magnitudes m (Shewchuk), and s by less than 8 u M with M = m_y |dy| + m_z |dz|, which is at least |s|. If n_x is off
// by at most half of itself, the division by it costs 2 * 4 u m_x / |n_x| of |s / n_x|. The difference at the end
// rounds once more. The interval never reaches beyond the triangle's corners.
PlaceInterval place_on(const Corners& t, double y, double z) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  const double nx = u.y * v.z - u.z * v.y, mx = std::abs(u.y * v.z) + std::abs(u.z * v.y);
  const double ny = u.z * v.x - u.x * v.z, my = std::abs(u.z * v.x) + std::abs(u.x * v.z);
  const double nz = u.x * v.y - u.y * v.x, mz = std::abs(u.x * v.y) + std::abs(u.y * v.x);
  const auto [low, high] = std::minmax({t[0].x, t[1].x, t[2].x});
  if (!(std::abs(nx) > 8 * kRoundoffDouble * mx)) return {low, high};
  const double dy = y - t[0].y, dz = z - t[0].z;
  const double x = t[0].x - (ny * dy + nz * dz) / nx;
  const double most = (my * std::abs(dy) + mz * std::abs(dz)) / std::abs(nx);
  const double off =
      kRoundoffDouble * ((16 + 8 * mx / std::abs(nx)) * most + 4 * std::max(std::abs(low), std::abs(high)));
  return {std::clamp(x - off, low, high), std::clamp(x + off, low, high)};
}

bool in_plane_of(const Corners& plane, const Corners& t) {
  for (const Vec3& v : t)
    if (orient3d(plane[0], plane[1], plane[2], v) != 0) return false;
  return true;
}

// The winding numbers just before and just behind a triangle along a row.
struct WindingNumbers {
  int before, behind;
};

// Counts the crossings of rows exactly, as ray_crossing.h does. Their places along the row are rounded, with a bound: a
// triangle that may be on either side must be in the plane of the one asked about, such as a wall that two boxes share.
// Triangles of one plane are passed together.
class RowWindingNumbers {
 public:
  // The mesh and the BVH must outlive this. Requires a closed mesh.
  RowWindingNumbers(const OrientedMesh& mesh, const Bvh& bvh);

  // Nothing where the row misses the triangle, or rounding hides its neighbours along the row.
  std::optional<WindingNumbers> of(std::uint32_t triangle, const Row& row) const;

 private:
  OrientedMesh mesh_;
  const Bvh& bvh_;
  Box bounds_;
};

RowWindingNumbers::RowWindingNumbers(const OrientedMesh& mesh, const Bvh& bvh)
    : mesh_(mesh), bvh_(bvh), bounds_(bounds(mesh.mesh)) {}

std::optional<WindingNumbers> RowWindingNumbers::of(std::uint32_t triangle, const Row& row) const {
  const int most_displaced = (4 - row.axis) % 3;
  const Corners own = rotated(mesh_.mesh.corners(triangle), row.axis);
  if (RayTriangle(own, most_displaced).crossing(row.at.x, row.at.y) == 0) return std::nullopt;
  const PlaceInterval here = place_on(own, row.at.x, row.at.y);
  WindingNumbers found{0, 0};
  bool sure = true;
  for_each_overlap(bvh_, bvh_.frame().local(box_of(row, bounds_)), [&](std::uint32_t place) {
    const std::uint32_t other = bvh_.order()[place];
    if (mesh_.use_of(other) == 0) return;
    const Corners t = rotated(mesh_.corners(other), row.axis);
    const int leaves = RayTriangle(t, most_displaced).crossing(row.at.x, row.at.y);
    if (leaves == 0) return;
    const PlaceInterval there = place_on(t, row.at.x, row.at.y);
    if (there.low > here.high) return;
    found.behind -= leaves;
    if (there.high < here.low)
      found.before -= leaves;
    else
      sure = sure && (other == triangle || in_plane_of(own, t));
  });
  return sure ? std::optional(found) : std::nullopt;
}

// The exposure of each triangle. No other triangle in use, unless in the same plane, has points in the interior of a
// triangle that is not cut. So the winding number is the same all over just in front of it, before all triangles in its
// plane, and also just behind: one row through the triangle decides. A wall between two boxes need not have the same
// triangles in both. Where a box stands on a part of a triangle, its sides have edges there, and cut it.

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
  // Decides by a row through the middle, or near it where rounding hides too much there.
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
    const std::optional<WindingNumbers> windings = rows_.of(triangle, row);
    if (!windings) return Exposure::cut;
    return is_inside(windings->before, rule_) && is_inside(windings->behind, rule_) ? Exposure::internal
                                                                                    : Exposure::exposed;
  }

  // Decides a triangle without an area, which is a line. If all triangles that touch it are internal, the space around
  // it is inside: the way from each part of that space to the next one leads through one of them, with inside on both
  // sides.
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
  RowWindingNumbers rows_;
};

}  // namespace

Exposures find_exposed(const OrientedMesh& mesh, WindingRule rule, ProgressMeter& progress) {
  return Classify(mesh, rule, progress).all();
}

// The plan, and the public function.

namespace {

void expect_closed(const SignPlan& plan, const char* who) {
  if (plan.report.method == SignMethod::winding && plan.report.boundary_edges == 0) return;
  throw Error(ErrorCode::input,
              std::string(who) + ": the mesh is not closed (" + plan.report.why +
                  "), so no triangle can be told to be inside it; repair the mesh, or take all its triangles");
}

}  // namespace

void plan_outer(MeshView mesh, const SignOptions& options, SignPlan& plan, ProgressMeter& progress) {
  expect_closed(plan, "outer");
  const Exposures found = find_exposed({mesh, plan.use}, options.rule, progress);
  plan.report.internal = found.internal;
  plan.report.cut = found.cut;
  if (found.internal == 0) return;
  plan.exposed.reserve(found.of.size() - static_cast<std::size_t>(found.internal));
  for (std::uint32_t t = 0; t < found.of.size(); ++t)
    if (found.of[t] != Exposure::internal) plan.exposed.push_back(t);
}

ExposedTriangles exposed_triangles(MeshView mesh, const SignOptions& sign, const Execution& execution) try {
  validate("exposed", execution, Runs::on_the_cpu);
  validate(sign);
  if (sign.method != SignMethod::winding && sign.method != SignMethod::automatic)
    throw Error(ErrorCode::usage, "exposed: inside must be by the winding number; take the sign method winding");
  validate(mesh);
  return Threads(execution.threads).run([&] {
    ProgressMeter unwatched;
    SignPlan plan = plan_sign(mesh, sign, unwatched);
    expect_closed(plan, "exposed");
    Exposures found = find_exposed({mesh, plan.use}, sign.rule, unwatched);
    plan.report.internal = found.internal;
    plan.report.cut = found.cut;
    return ExposedTriangles{std::move(found.of), found.internal, found.cut, std::move(plan.report)};
  });
} catch (...) {
  throw_as_error("exposed", "provide more memory");
}

}  // namespace standoff
