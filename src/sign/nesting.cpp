// SPDX-License-Identifier: Apache-2.0
// Points are sorted into a grid over y and z. Each triangle is compared with the points in the cells that it covers:
// those from which a ray along +x may meet it.
#include "sign/nesting.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/per_thread.h"
#include "sign/ray_crossing.h"

namespace standoff {
namespace {

constexpr std::size_t kPoints = 3;  // of each part

struct Point {
  Vec3 at;
  std::uint32_t part;
};

bool contains(const Box& outer, const Box& inner) {
  return outer.min.x <= inner.min.x && outer.min.y <= inner.min.y && outer.min.z <= inner.min.z &&
         outer.max.x >= inner.max.x && outer.max.y >= inner.max.y && outer.max.z >= inner.max.z;
}

double volume_of(const Box& box) {
  const Vec3 e = box.extent();
  return e.x * e.y * e.z;
}

// Three corners of each solid part: the first and last one by x, and the first one by y. They do not depend on the
// order of the triangles. Where parts touch, the rays' perturbation towards larger coordinates takes first corners for
// inside.
std::vector<Point> points_of(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of,
                             std::span<const Part> parts) {
  const auto before_in_x = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  const auto before_in_y = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.y, a.z, a.x) < std::tie(b.y, b.z, b.x);
  };
  std::vector<std::uint32_t> first(parts.size(), Nesting::kNone);
  std::vector<Point> points;
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    const std::uint32_t part = part_of[t];
    if (mesh.use_of(t) == 0 || !parts[part].solid) continue;
    if (first[part] == Nesting::kNone) {
      first[part] = static_cast<std::uint32_t>(points.size());
      points.insert(points.end(), kPoints, {mesh.mesh.corner(t, 0), part});
    }
    Point* const chosen = &points[first[part]];
    for (const Vec3& corner : mesh.mesh.corners(t)) {
      if (before_in_x(corner, chosen[0].at)) chosen[0].at = corner;
      if (before_in_x(chosen[1].at, corner)) chosen[1].at = corner;
      if (before_in_y(corner, chosen[2].at)) chosen[2].at = corner;
    }
  }
  return points;
}

// The points by cells of a square grid over y and z.
class Cells {
 public:
  explicit Cells(std::span<const Point> points) : points_(points) {
    for (const Point& point : points) box_.include(point.at);
    side_ = std::clamp<std::int64_t>(std::llround(std::sqrt(double(points.size()))), 1, 1024);
    begin_.resize(static_cast<std::size_t>(side_ * side_) + 1);
    for (const Point& point : points) ++begin_[cell_of(point) + 1];
    for (std::size_t n = 1; n < begin_.size(); ++n) begin_[n] += begin_[n - 1];
    order_.resize(points.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t n = 0; n < points.size(); ++n) order_[next[cell_of(points[n])]++] = n;
  }

  // How many points visit() sees.
  std::int64_t count(const Box& box) const {
    std::int64_t sum = 0;
    for_each_run(box, [&](std::uint32_t first, std::uint32_t past) { sum += past - first; });
    return sum;
  }
  // Calls visit(number) for all points whose y and z are in the box, and for some others.
  template <class Visit>
  void for_each(const Box& box, const Visit& visit) const {
    for_each_run(box, [&](std::uint32_t first, std::uint32_t past) {
      for (std::uint32_t n = first; n < past; ++n) visit(order_[n]);
    });
  }

 private:
  // Monotone, so that a point between two others is in a cell between theirs.
  std::int64_t along(double value, double min, double max) const {
    const double share = max > min ? (value / 2 - min / 2) / (max / 2 - min / 2) : 0;
    return static_cast<std::int64_t>(std::clamp(share * double(side_), 0.0, double(side_ - 1)));
  }
  std::int64_t y_of(double y) const { return along(y, box_.min.y, box_.max.y); }
  std::int64_t z_of(double z) const { return along(z, box_.min.z, box_.max.z); }
  std::size_t cell_of(const Point& point) const {
    return static_cast<std::size_t>(y_of(point.at.y) + side_ * z_of(point.at.z));
  }
  // A row of cells is one run of points.
  template <class Use>
  void for_each_run(const Box& box, const Use& use) const {
    if (box.max.y < box_.min.y || box.min.y > box_.max.y || box.max.z < box_.min.z || box.min.z > box_.max.z ||
        box.max.x < box_.min.x)
      return;
    const std::int64_t first = y_of(box.min.y), last = y_of(box.max.y);
    for (std::int64_t z = z_of(box.min.z), end = z_of(box.max.z); z <= end; ++z)
      use(begin_[static_cast<std::size_t>(first + side_ * z)], begin_[static_cast<std::size_t>(last + side_ * z) + 1]);
  }

  std::span<const Point> points_;
  Box box_;
  std::int64_t side_ = 1;
  std::vector<std::uint32_t> begin_, order_;
};

// A ray from a point meets a triangle of another part.
struct Hit {
  std::uint32_t point, part;
  std::int32_t step;
};

struct Inside {
  std::uint32_t inner, outer;
  friend auto operator<=>(const Inside&, const Inside&) = default;
};

class Search {
 public:
  Search(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, std::span<const Part> parts)
      : mesh_(mesh), part_of_(part_of), parts_(parts) {}

  std::int64_t tests(std::span<const Point> points) const {
    const Cells cells(points);
    std::int64_t sum = 0;
    for (std::size_t t = 0; t < part_of_.size(); ++t)
      if (takes_part(t)) sum += cells.count(box_of(t));
    return sum;
  }

  // Appends a pair for each point of a part that is inside another part. Where hits would take too much memory, half of
  // the points come first.
  void find(std::span<const Point> points, std::vector<Inside>& found) const {
    constexpr std::size_t kMostHits = 1 << 24;
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
  bool takes_part(std::size_t t) const { return mesh_.use_of(t) != 0 && parts_[part_of_[t]].solid; }
  Box box_of(std::size_t t) const {
    Box box;
    for (const Vec3& corner : mesh_.mesh.corners(t)) box.include(corner);
    return box;
  }

  // False if there are more than `most`, unless the points are those of one part.
  bool find_hits(std::span<const Point> points, std::size_t most, std::vector<Hit>& hits) const {
    const Cells cells(points);
    PerThread<std::vector<Hit>> found;
    const std::size_t share = points.size() <= kPoints ? part_of_.size() * kPoints : most;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part_of_.size(), 1024), [&](const auto& range) {
      std::vector<Hit>& mine = found.local();
      for (std::size_t t = range.begin(); t != range.end() && mine.size() <= share; ++t)
        if (takes_part(t)) add_hits(t, cells, points, mine);
    });
    std::size_t total = 0;
    found.for_each([&](const std::vector<Hit>& some) { total += some.size(); });
    if (total > share) return false;
    found.for_each([&](const std::vector<Hit>& some) { hits.insert(hits.end(), some.begin(), some.end()); });
    return true;
  }

  void add_hits(std::size_t t, const Cells& cells, std::span<const Point> points, std::vector<Hit>& hits) const {
    const std::uint32_t part = part_of_[t];
    const Box box = box_of(t);
    cells.for_each(box, [&](std::uint32_t n) {
      const Point& point = points[n];
      if (point.part == part || point.at.y < box.min.y || point.at.y > box.max.y || point.at.z < box.min.z ||
          point.at.z > box.max.z || point.at.x > box.max.x || !is_larger(part, point.part))
        return;
      const RayTriangle ray(mesh_.corners(t));
      const int crossing = ray.crossing(point.at.y, point.at.z);
      if (crossing != 0 && !ray.is_past(point.at, crossing)) hits.push_back({n, part, crossing});
    });
  }

  // Whether the outer box contains the inner one; of equal boxes the first contains the second, so that no two parts
  // contain each other.
  bool is_larger(std::uint32_t outer, std::uint32_t inner) const {
    const Box &a = parts_[outer].bounds, &b = parts_[inner].bounds;
    return contains(a, b) && (outer < inner || !contains(b, a));
  }

  OrientedMesh mesh_;
  std::span<const std::uint32_t> part_of_;
  std::span<const Part> parts_;
};

}  // namespace

Nesting find_nesting(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, std::span<const Part> parts,
                     std::int64_t most_tests) {
  Nesting nesting;
  nesting.depth.resize(parts.size());
  nesting.parent.resize(parts.size(), Nesting::kNone);
  if (std::ranges::count_if(parts, &Part::solid) < 2) return nesting;
  const std::vector<Point> points = points_of(mesh, part_of, parts);
  const Search search(mesh, part_of, parts);
  if (search.tests(points) > most_tests) {
    nesting.known = false;
    return nesting;
  }
  std::vector<Inside> found;
  search.find(points, found);
  std::ranges::sort(found);
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
