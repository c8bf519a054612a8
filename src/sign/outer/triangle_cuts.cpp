// SPDX-License-Identifier: Apache-2.0
#include "sign/outer/triangle_cuts.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "core/progress.h"
#include "core/threads.h"
#include "geometry/predicates.h"
#include "geometry/triangle_pair.h"

namespace standoff {

// Whether one triangle divides another one, exactly. Let L be the line in which the planes of triangles p and q meet.
// If p is on one closed side of q's plane, then L passes no point of p's interior, so q does not cut p. If p is on both
// sides, L passes through p's interior, and q cuts p if q's part of L is there. That part is
// - a corner or an edge of q, if q is on one closed side of p's plane: all its ends are corners, and exact signs in the
//   plane of p decide,
// - else a segment with an inner point of q. Then both cut each other or none does, unless ends touch: they count as a
//   cut.

namespace {

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

// All pairs of a mesh.

constexpr std::int64_t kPairsBetweenChecks = 1 << 14;

class CutSearch {
 public:
  CutSearch(const OrientedMesh& mesh, MeshCuts& found) : mesh_(mesh), found_(found) {}

  void compare(std::uint32_t first, std::uint32_t second, TrianglePairs& touched) const {
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
  void mark(std::uint32_t triangle) const { std::atomic_ref(found_.cut[triangle]).store(1, std::memory_order_relaxed); }

  OrientedMesh mesh_;
  MeshCuts& found_;
};

}  // namespace

std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs_of(const TrianglePairs& pairs, std::uint32_t triangle) {
  const auto found = std::ranges::equal_range(pairs, triangle, {}, &TrianglePairs::value_type::first);
  return {found.begin(), found.end()};
}

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

}  // namespace standoff
