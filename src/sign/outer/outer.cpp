// SPDX-License-Identifier: Apache-2.0
#include "sign/outer/outer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bvh/bvh.h"
#include "bvh/order.h"
#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "geometry/predicates.h"
#include "geometry/rounding.h"
#include "geometry/triangle_pair.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/ray_crossing.h"
#include "sign/signs.h"
#include "standoff/error.h"
#include "standoff/exposed.h"
#include "standoff/sign.h"

namespace standoff {
namespace {

// Whether one triangle divides another one, exactly. Let L be the line in which the planes of triangles p and q meet.
// If p is on one closed side of q's plane, then L passes no point of p's interior, so q does not cut p. If p is on both
// sides, L passes through p's interior, and q cuts p if q's part of L is there. That part is
// - a corner or an edge of q, if q is on one closed side of p's plane: all its ends are corners, and exact signs in the
//   plane of p decide,
// - else a segment with an inner point of q. Then both cut each other or none does, unless ends touch: they count as a
//   cut.

// Whether the line through a and b, corners of p, has p on one closed side and all of q on the other one.
template <class Points>
bool line_separates(const Flat& a, const Flat& b, const Flat& third, const Points& q) {
  const int own = orient2d(a, b, third);
  for (const Flat& point : q)
    if (orient2d(a, b, point) * own > 0) return false;
  return true;
}

template <class Points>
bool edge_separates(const FlatCorners& p, const Points& q) {
  for (std::size_t n = 0; n < 3; ++n)
    if (line_separates(p[n], p[(n + 1) % 3], p[(n + 2) % 3], q)) return true;
  return false;
}

// Whether a segment in the triangle's plane, which may be a point, has points in the triangle's interior. If not, a
// line along an edge or along the segment separates them.
bool is_in_interior(const Vec3& from, const Vec3& to, const Corners& t) {
  const int axis = upright_axis(t[0], t[1], t[2]);
  const FlatCorners p = dropped(t, axis);
  const std::array<Flat, 2> ends{dropped(from, axis), dropped(to, axis)};
  if (edge_separates(p, ends)) return false;
  if (from == to) return true;
  bool left = false, right = false;
  for (const Flat& corner : p) {
    const int side = orient2d(ends[0], ends[1], corner);
    left = left || side > 0;
    right = right || side < 0;
  }
  return left && right;
}

struct CornerSides {
  std::array<int, 3> of;
  int above = 0, below = 0;

  CornerSides(const Corners& plane, const Corners& t) {
    for (std::size_t n = 0; n < 3; ++n) {
      // Skip the corners that neighbours share, which would take the exact stage.
      const bool common = t[n] == plane[0] || t[n] == plane[1] || t[n] == plane[2];
      of[n] = common ? 0 : orient3d(plane[0], plane[1], plane[2], t[n]);
      above += of[n] > 0;
      below += of[n] < 0;
    }
  }
  bool both() const { return above > 0 && below > 0; }
  int zero() const { return 3 - above - below; }
};

// Whether q, on one closed side of p's plane, has a corner or an edge in p's interior.
bool touches_interior(const Corners& p, const Corners& q, const CornerSides& q_sides) {
  const Vec3 *from = nullptr, *to = nullptr;
  for (std::size_t n = 0; n < 3; ++n)
    if (q_sides.of[n] == 0) (from ? to : from) = &q[n];
  return from && is_in_interior(*from, to ? *to : *from, p);
}

// Whether triangles that both pass through the other's plane cut each other. They cannot share an edge. If they share a
// corner, then L begins there, and their parts of it share more if an edge across reaches the other triangle.
bool pass_through_each_other(const Corners& p, const Corners& q) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (p[i] == q[j]) {
        const Vec3 &a = p[(i + 1) % 3], &b = p[(i + 2) % 3], &c = q[(j + 1) % 3], &d = q[(j + 2) % 3];
        return triangles_intersect({a, b, b}, q) || triangles_intersect({c, d, d}, p);
      }
  return triangles_intersect(p, q);
}

// For each of two triangles whether the other one, unless it lies in the same plane, has points in its interior.
struct Cuts {
  bool first = false, second = false;
};

// Requires triangles with an area. May call a triangle cut that the other one touches at a point of the border, where
// both pass through the other's plane; never the other way round.
Cuts cuts_between(const Corners& first, const Corners& second) {
  const CornerSides second_sides(first, second);
  if (!second_sides.both() && second_sides.zero() == 0) return {};
  const CornerSides first_sides(second, first);
  if (first_sides.both() && second_sides.both()) {
    const bool cut = pass_through_each_other(first, second);
    return {cut, cut};
  }
  return {first_sides.both() && touches_interior(first, second, second_sides),
          second_sides.both() && touches_interior(second, first, first_sides)};
}

// The triangles of a mesh that others cut or touch.

// Pairs of triangles, sorted.
using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

struct MeshCuts {
  std::vector<std::uint8_t> flat;  // for each triangle whether it has no area
  // For each triangle whether one in use has points in its interior. Triangles in its plane do not count.
  std::vector<std::uint8_t> cut;
  TrianglePairs touched;  // a triangle without an area, and one with an area that touches it
};

constexpr std::int64_t kPairsBetweenChecks = 1 << 14;

class CutSearch {
 public:
  CutSearch(const OrientedMesh& mesh, MeshCuts& found) : mesh_(mesh), found_(found) {}

  void compare(std::uint32_t first, std::uint32_t second, TrianglePairs& touched) const {
    if (is_cut(first) && is_cut(second)) return;  // where parts overlap, most pairs are of such triangles
    const Corners p = mesh_.mesh.corners(first), q = mesh_.mesh.corners(second);
    const bool first_flat = found_.flat[first] != 0, second_flat = found_.flat[second] != 0;
    if (first_flat || second_flat) {
      // A triangle without an area has no sides, and cuts nothing.
      if (first_flat != second_flat && triangles_intersect(p, q))
        touched.push_back(first_flat ? std::pair(first, second) : std::pair(second, first));
      return;
    }
    const bool first_used = mesh_.use_of(first) != 0, second_used = mesh_.use_of(second) != 0;
    const Cuts cuts = cuts_between(p, q);
    if (cuts.first && second_used) mark(first);
    if (cuts.second && first_used) mark(second);
  }

 private:
  bool is_cut(std::uint32_t t) const { return std::atomic_ref(found_.cut[t]).load(std::memory_order_relaxed) != 0; }
  void mark(std::uint32_t t) const { std::atomic_ref(found_.cut[t]).store(1, std::memory_order_relaxed); }

  OrientedMesh mesh_;
  MeshCuts& found_;
};

// The pairs whose first triangle is this one.
std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs_of(const TrianglePairs& pairs, std::uint32_t triangle) {
  const auto found = std::ranges::equal_range(pairs, triangle, {}, &TrianglePairs::value_type::first);
  return {found.begin(), found.end()};
}

// Compares all pairs of triangles whose boxes overlap. Requires a valid mesh. Runs on the threads of the calling TBB
// arena; the result does not depend on them. Throws Error{interrupted}.
MeshCuts find_cuts(const OrientedMesh& mesh, const Bvh& bvh, ProgressMeter& progress) {
  const std::size_t triangles = mesh.mesh.triangles.size();
  MeshCuts found;
  found.flat.resize(triangles);
  found.cut.resize(triangles);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const Corners corners = mesh.mesh.corners(t);
      found.flat[t] = upright_axis(corners[0], corners[1], corners[2]) < 0;
    }
  });
  const CutSearch search(mesh, found);
  PerThread<TrianglePairs> touched;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 64), [&](const auto& range) {
    TrianglePairs& mine = touched.local();
    WorkCheck check(progress, kPairsBetweenChecks);
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      std::int64_t boxes = std::numeric_limits<std::int64_t>::max();
      for_each_later_overlap(bvh, static_cast<std::uint32_t>(n), boxes, [&](std::uint32_t other) {
        search.compare(bvh.order()[n], bvh.order()[other], mine);
        check.add(1);
        return true;
      });
    }
  });
  touched.for_each(
      [&](const TrianglePairs& part) { found.touched.insert(found.touched.end(), part.begin(), part.end()); });
  std::ranges::sort(found.touched);
  return found;
}

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

ExposedTriangles exposed_triangles(MeshView mesh, const ExposedOptions& options) try {
  const SignOptions& sign = options.sign;
  validate("exposed", options.execution, Runs::on_the_cpu);
  validate(sign);
  if (sign.method != SignMethod::winding && sign.method != SignMethod::automatic)
    throw Error(ErrorCode::usage, "exposed: inside must be by the winding number; take the sign method winding");
  validate(mesh);
  return Threads(options.execution.threads).run([&] {
    ProgressMeter meter(options.progress);
    meter.stage("exposed", 1, 0, 1);
    SignPlan plan = plan_sign(mesh, sign, meter);
    expect_closed(plan, "exposed");
    Exposures found = find_exposed({mesh, plan.use}, sign.rule, meter);
    plan.report.internal = found.internal;
    plan.report.cut = found.cut;
    return ExposedTriangles{std::move(found.of), found.internal, found.cut, std::move(plan.report)};
  });
} catch (...) {
  throw_as_error("exposed", "provide more memory");
}

}  // namespace standoff
