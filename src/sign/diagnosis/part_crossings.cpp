// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/part_crossings.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <tuple>

#include "sign/rows/ray_crossing.h"

namespace standoff {
namespace {

// Points in a uniform grid over y and z, so that a box finds those in it without looking at all.
class PointGrid {
 public:
  explicit PointGrid(std::span<const PartPoint> points) {
    for (const PartPoint& point : points) box_.include(point.at);
    side_ = std::clamp<std::int64_t>(std::llround(std::sqrt(double(points.size()))), 1, 1024);
    begin_.resize(static_cast<std::size_t>(side_ * side_) + 1);
    for (const PartPoint& point : points) ++begin_[cell_of(point) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    sorted_.resize(points.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t n = 0; n < points.size(); ++n) sorted_[next[cell_of(points[n])]++] = {points[n], n};
  }

  /// How many points for_each() visits.
  std::int64_t count(const Box& box) const {
    std::int64_t sum = 0;
    for_each_run(box, [&](std::uint32_t first, std::uint32_t past) { sum += past - first; });
    return sum;
  }
  /// Calls visit(point, number) for all points whose y and z are in the box, and for some others.
  template <class Visit>
  void for_each(const Box& box, const Visit& visit) const {
    for_each_run(box, [&](std::uint32_t first, std::uint32_t past) {
      for (std::uint32_t n = first; n < past; ++n) visit(sorted_[n].point, sorted_[n].number);
    });
  }

 private:
  struct Numbered {
    PartPoint point;
    std::uint32_t number;
  };

  // Monotone, so that a point between two others is in a cell between theirs.
  std::int64_t along(double value, double min, double max) const {
    const double width = max / 2 - min / 2;  // finite whatever the numbers are
    const double share = width > 0 ? (value / 2 - min / 2) / width : 0;
    return static_cast<std::int64_t>(std::clamp(share * double(side_), 0.0, double(side_ - 1)));
  }
  std::int64_t y_of(double y) const { return along(y, box_.min.y, box_.max.y); }
  std::int64_t z_of(double z) const { return along(z, box_.min.z, box_.max.z); }
  std::size_t cell_of(const PartPoint& point) const {
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

  Box box_;
  std::int64_t side_ = 1;  // cells
  std::vector<std::uint32_t> begin_;
  std::vector<Numbered> sorted_;
};

PointGrid grid_of_rows(std::span<const PartPoint> rows) {
  std::vector<PartPoint> lines(rows.begin(), rows.end());
  for (PartPoint& line : lines) line.at.x = -std::numeric_limits<double>::infinity();  // a row has no first point
  return PointGrid(lines);
}

}  // namespace

Candidates find_candidates(const PartOrder& order, std::int64_t most_tests) {
  const std::uint32_t count = order.size();
  std::vector<PartPoint> lows;
  lows.reserve(count);
  for (std::uint32_t n = 0; n < count; ++n) lows.push_back({order[n].min, n});
  const PointGrid grid(lows);
  Candidates found{std::vector<std::uint8_t>(count), std::vector<std::uint8_t>(count, 1)};
  for (std::uint32_t n = 0; n < count; ++n) found.tests += grid.count(order[n]);
  if (found.tests > most_tests) return found;
  for (std::uint32_t n = 0; n < count; ++n)
    grid.for_each(order[n], [&](const PartPoint& other, std::uint32_t) {
      if (!order.may_contain(n, other.part)) return;
      found.innermost[n] = 0;
      found.inner[other.part] = 1;
    });
  return found;
}

Box PartCrossings::bounds_of(std::size_t t) const {
  Box box;
  for (const Vec3& corner : mesh_.mesh.corners(t)) box.include(corner);
  return box;
}

std::int64_t PartCrossings::tests(std::span<const PartPoint> rows) const {
  const PointGrid grid = grid_of_rows(rows);
  std::int64_t sum = 0;
  for (std::size_t t = 0; t < part_of_.size(); ++t)
    if (is_looked_at(t)) sum += grid.count(bounds_of(t));
  return sum;
}

bool PartCrossings::find(std::span<const PartPoint> rows, std::size_t most,
                         std::vector<PartCrossing>& crossings) const {
  constexpr std::size_t kAtOnce = 256;
  const PointGrid grid = grid_of_rows(rows);
  crossings.clear();
  crossings.reserve(most);
  std::mutex of_crossings;
  std::atomic<bool> too_many = false;
  const auto take = [&](std::vector<PartCrossing>& some) {
    const std::lock_guard alone(of_crossings);
    if (some.size() > most - crossings.size())
      too_many = true;
    else
      crossings.insert(crossings.end(), some.begin(), some.end());
    some.clear();
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part_of_.size(), 1024), [&](const auto& range) {
    std::vector<PartCrossing> mine;
    for (std::size_t t = range.begin(); t != range.end() && !too_many; ++t) {
      if (!is_looked_at(t)) continue;
      const Box box = bounds_of(t);
      std::optional<RayTriangle> ray;
      grid.for_each(box, [&](const PartPoint& row, std::uint32_t n) {
        if (row.at.y < box.min.y || row.at.y > box.max.y || row.at.z < box.min.z || row.at.z > box.max.z ||
            !order_.may_contain(part_of_[t], row.part))
          return;
        if (!ray) ray.emplace(mesh_.corners(t));
        if (const int step = ray->crossing(row.at.y, row.at.z))
          mine.push_back({n, part_of_[t], static_cast<std::uint32_t>(t), step});
        if (mine.size() == kAtOnce) take(mine);
      });
    }
    take(mine);
  });
  if (too_many) {
    crossings = {};
    return false;
  }
  std::ranges::sort(crossings, {}, [](const PartCrossing& c) { return std::tuple(c.row, c.part, c.triangle); });
  return true;
}

bool PartCrossings::is_past(const Vec3& at, const PartCrossing& crossing) const {
  return RayTriangle(mesh_.corners(crossing.triangle)).is_past(at, crossing.step);
}

double PartCrossings::x_of(const Vec3& at, const PartCrossing& crossing) const {
  const Box box = bounds_of(crossing.triangle);
  const double x = RayTriangle(mesh_.corners(crossing.triangle)).crossing_x(at.y, at.z);
  return x >= box.min.x ? std::min(x, box.max.x) : box.min.x;  // also if it is no number
}

}  // namespace standoff
