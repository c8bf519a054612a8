// SPDX-License-Identifier: Apache-2.0
// Each triangle is compared with the points from which a ray along +x may meet it.
#include "sign/nesting.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>

#include "core/per_thread.h"
#include "sign/point_cells.h"
#include "sign/ray_crossing.h"

namespace standoff {
namespace {

constexpr std::size_t kPoints = 3;  // of each part

bool contains(const Box& outer, const Box& inner) {
  return outer.min.x <= inner.min.x && outer.min.y <= inner.min.y && outer.min.z <= inner.min.z &&
         outer.max.x >= inner.max.x && outer.max.y >= inner.max.y && outer.max.z >= inner.max.z;
}

double volume_of(const Box& box) {
  const Vec3 e = box.extent();
  return e.x * e.y * e.z;
}

// A point of a triangle that does not depend on the order of its corners: on no edge, and on no line that a symmetric
// shape would have, where rays pass through many edges and need exact arithmetic.
Vec3 point_of(std::array<Vec3, 3> corners) {
  std::ranges::sort(corners,
                    [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  return corners[0] + (corners[1] - corners[0]) * 0.3 + (corners[2] - corners[0]) * 0.23;
}

// Three points of each part that is `wanted`, of different triangles: the first and last one by x, and the first one by
// y. They do not depend on the order of the triangles.
std::vector<PartPoint> points_of(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of,
                                 const std::vector<std::uint8_t>& wanted) {
  const auto before_in_x = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  const auto before_in_y = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.y, a.z, a.x) < std::tie(b.y, b.z, b.x);
  };
  std::vector<std::uint32_t> first(wanted.size(), Nesting::kNone);
  std::vector<PartPoint> points;
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    const std::uint32_t part = part_of[t];
    if (mesh.use_of(t) == 0 || wanted[part] == 0) continue;
    const Vec3 point = point_of(mesh.mesh.corners(t));
    if (first[part] == Nesting::kNone) {
      first[part] = static_cast<std::uint32_t>(points.size());
      points.insert(points.end(), kPoints, {point, part});
    }
    PartPoint* const chosen = &points[first[part]];
    if (before_in_x(point, chosen[0].at)) chosen[0].at = point;
    if (before_in_x(chosen[1].at, point)) chosen[1].at = point;
    if (before_in_y(point, chosen[2].at)) chosen[2].at = point;
  }
  return points;
}

// Whether the outer box contains the inner one; of equal boxes the first contains the second, so that no two parts
// contain each other.
bool is_larger(std::span<const Part> parts, std::uint32_t outer, std::uint32_t inner) {
  const Box &a = parts[outer].bounds, &b = parts[inner].bounds;
  return contains(a, b) && (outer < inner || !contains(b, a));
}

// Which parts have a box that is in another one's, or that contains another one's: no other ones need rays.
struct Candidates {
  std::vector<std::uint8_t> inner, outer;
  std::int64_t tests = 0;
};
Candidates find_candidates(std::span<const Part> parts, std::int64_t most_tests) {
  std::vector<PartPoint> lows;
  for (std::uint32_t n = 0; n < parts.size(); ++n)
    if (parts[n].solid) lows.push_back({parts[n].bounds.min, n});
  const PointCells cells(lows);
  Candidates found{std::vector<std::uint8_t>(parts.size()), std::vector<std::uint8_t>(parts.size())};
  for (const PartPoint& low : lows) found.tests += cells.count(parts[low.part].bounds);
  if (found.tests > most_tests) return found;
  for (const PartPoint& low : lows)
    cells.for_each(parts[low.part].bounds, [&](const PartPoint& other, std::uint32_t) {
      if (other.part == low.part || !is_larger(parts, low.part, other.part)) return;
      found.outer[low.part] = 1;
      found.inner[other.part] = 1;
    });
  return found;
}

// A ray from a point meets a triangle of another part.
struct Hit {
  std::uint32_t point, part;
  std::int32_t step;
};

struct Inside {
  std::uint32_t inner, outer;
  friend bool operator==(const Inside&, const Inside&) = default;
};

class Search {
 public:
  Search(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, std::span<const Part> parts,
         const std::vector<std::uint8_t>& outer)
      : mesh_(mesh), part_of_(part_of), parts_(parts), outer_(outer) {}

  std::int64_t tests(std::span<const PartPoint> points) const {
    const PointCells cells(points);
    std::int64_t sum = 0;
    for (std::size_t t = 0; t < part_of_.size(); ++t)
      if (takes_part(t)) sum += cells.count(box_of(t));
    return sum;
  }

  // Appends a pair for each point of a part that is inside another part. Where hits would take too much memory, half of
  // the points come first.
  void find(std::span<const PartPoint> points, std::vector<Inside>& found) const {
    constexpr std::size_t kMostHits = 1 << 22;
    std::vector<Hit> hits;
    if (!find_hits(points, kMostHits, hits)) {
      const std::size_t half = points.size() / kPoints / 2 * kPoints;
      find(points.first(half), found);
      find(points.subspan(half), found);
      return;
    }
    std::ranges::sort(hits, {}, [](const Hit& h) { return std::tuple(h.point, h.part); });
    for (auto next = hits.begin(); next != hits.end();) {
      const Hit first = *next;
      std::int64_t winding = 0;
      for (; next != hits.end() && next->point == first.point && next->part == first.part; ++next)
        winding += next->step;
      if (winding != 0) found.push_back({points[first.point].part, first.part});
    }
  }

 private:
  bool takes_part(std::size_t t) const { return mesh_.use_of(t) != 0 && outer_[part_of_[t]] != 0; }
  Box box_of(std::size_t t) const {
    Box box;
    for (const Vec3& corner : mesh_.mesh.corners(t)) box.include(corner);
    return box;
  }

  // False if there are more than `most`, unless the points are those of one part.
  bool find_hits(std::span<const PartPoint> points, std::size_t most, std::vector<Hit>& hits) const {
    const PointCells cells(points);
    PerThread<std::vector<Hit>> found;
    const std::size_t share = points.size() <= kPoints ? part_of_.size() * kPoints : most;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part_of_.size(), 1024), [&](const auto& range) {
      std::vector<Hit>& mine = found.local();
      for (std::size_t t = range.begin(); t != range.end() && mine.size() <= share; ++t)
        if (takes_part(t)) add_hits(t, cells, mine);
    });
    std::size_t total = 0;
    found.for_each([&](const std::vector<Hit>& some) { total += some.size(); });
    if (total > share) return false;
    found.for_each([&](const std::vector<Hit>& some) { hits.insert(hits.end(), some.begin(), some.end()); });
    return true;
  }

  void add_hits(std::size_t t, const PointCells& cells, std::vector<Hit>& hits) const {
    const std::uint32_t part = part_of_[t];
    const Box box = box_of(t);
    std::optional<RayTriangle> ray;
    cells.for_each(box, [&](const PartPoint& point, std::uint32_t n) {
      if (point.part == part || point.at.x > box.max.x || point.at.y < box.min.y || point.at.y > box.max.y ||
          point.at.z < box.min.z || point.at.z > box.max.z || !is_larger(parts_, part, point.part))
        return;
      if (!ray) ray.emplace(mesh_.corners(t));
      const int crossing = ray->crossing(point.at.y, point.at.z);
      if (crossing != 0 && !ray->is_past(point.at, crossing)) hits.push_back({n, part, crossing});
    });
  }

  OrientedMesh mesh_;
  std::span<const std::uint32_t> part_of_;
  std::span<const Part> parts_;
  const std::vector<std::uint8_t>& outer_;
};

}  // namespace

Nesting find_nesting(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, std::span<const Part> parts,
                     std::int64_t most_tests) {
  Nesting nesting;
  nesting.depth.resize(parts.size());
  nesting.parent.resize(parts.size(), Nesting::kNone);
  if (std::ranges::count_if(parts, &Part::solid) < 2) return nesting;
  const Candidates candidates = find_candidates(parts, most_tests);
  const std::vector<PartPoint> points = points_of(mesh, part_of, candidates.inner);
  const Search search(mesh, part_of, parts, candidates.outer);
  nesting.known = candidates.tests <= most_tests && search.tests(points) <= most_tests;
  if (!nesting.known || points.empty()) return nesting;
  std::vector<Inside> found;
  search.find(points, found);
  std::ranges::sort(found, {}, [](const Inside& i) { return std::pair(i.inner, i.outer); });
  for (auto next = found.begin(); next != found.end();) {
    const auto first = next;
    while (next != found.end() && *next == *first) ++next;
    if (2 * static_cast<std::size_t>(next - first) <= kPoints) continue;
    ++nesting.depth[first->inner];
    std::uint32_t& parent = nesting.parent[first->inner];
    if (parent == Nesting::kNone || volume_of(parts[first->outer].bounds) <= volume_of(parts[parent].bounds))
      parent = first->outer;
  }
  return nesting;
}

}  // namespace standoff
