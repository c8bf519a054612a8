// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/row_hits.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <tuple>

#include "core/threads.h"
#include "sign/rows/ray_crossing.h"

namespace standoff {
namespace {

// A row has no first point.
PointCells cells_of(std::span<const PartPoint> rows) {
  std::vector<PartPoint> lines(rows.begin(), rows.end());
  for (PartPoint& line : lines) line.at.x = -std::numeric_limits<double>::infinity();
  return PointCells(lines);
}

}  // namespace

Box RowSearch::box_of(std::size_t t) const {
  Box box;
  for (const Vec3& corner : mesh_.mesh.corners(t)) box.include(corner);
  return box;
}

std::int64_t RowSearch::tests(std::span<const PartPoint> rows) const {
  const PointCells cells = cells_of(rows);
  std::int64_t sum = 0;
  for (std::size_t t = 0; t < part_of_.size(); ++t)
    if (takes_part(t)) sum += cells.count(box_of(t));
  return sum;
}

bool RowSearch::find(std::span<const PartPoint> rows, std::size_t most, std::vector<RowHit>& hits) const {
  const PointCells cells = cells_of(rows);
  const std::size_t share = rows.size() <= 1 ? part_of_.size() : most;
  PerThread<std::vector<RowHit>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part_of_.size(), 1024), [&](const auto& range) {
    std::vector<RowHit>& mine = found.local();
    for (std::size_t t = range.begin(); t != range.end() && mine.size() <= share; ++t) {
      if (!takes_part(t)) continue;
      const Box box = box_of(t);
      std::optional<RayTriangle> ray;
      cells.for_each(box, [&](const PartPoint& row, std::uint32_t n) {
        if (row.at.y < box.min.y || row.at.y > box.max.y || row.at.z < box.min.z || row.at.z > box.max.z ||
            !order_.is_larger(part_of_[t], row.part))
          return;
        if (!ray) ray.emplace(mesh_.corners(t));
        if (const int step = ray->crossing(row.at.y, row.at.z))
          mine.push_back({n, part_of_[t], static_cast<std::uint32_t>(t), step});
      });
    }
  });
  std::size_t total = 0;
  found.for_each([&](const std::vector<RowHit>& some) { total += some.size(); });
  if (total > share) return false;
  hits.clear();
  found.for_each([&](const std::vector<RowHit>& some) { hits.insert(hits.end(), some.begin(), some.end()); });
  std::ranges::sort(hits, {}, [](const RowHit& h) { return std::tuple(h.row, h.part, h.triangle); });
  return true;
}

bool RowSearch::is_past(const Vec3& at, const RowHit& hit) const {
  return RayTriangle(mesh_.corners(hit.triangle)).is_past(at, hit.step);
}

double RowSearch::x_of(const Vec3& at, const RowHit& hit) const {
  const Box box = box_of(hit.triangle);
  const double x = RayTriangle(mesh_.corners(hit.triangle)).crossing_x(at.y, at.z);
  return x >= box.min.x ? std::min(x, box.max.x) : box.min.x;  // also if it is no number
}

}  // namespace standoff
