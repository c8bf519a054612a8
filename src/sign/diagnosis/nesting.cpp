// SPDX-License-Identifier: Apache-2.0
// Parts are numbered by their boxes, so that what contains another part comes first; then rows through the parts are
// swept (nesting_votes.h).
#include "sign/diagnosis/nesting.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "sign/diagnosis/containers.h"
#include "sign/diagnosis/nesting_votes.h"
#include "sign/diagnosis/point_cells.h"
#include "sign/diagnosis/row_hits.h"

namespace standoff {
namespace {

// The numbers of the solid parts in the order of their boxes. A box that contains another one has no smaller sum of
// sides, also when rounded, no larger min and no smaller max.
std::vector<std::uint32_t> in_order(std::span<const Part> parts) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t n = 0; n < parts.size(); ++n)
    if (parts[n].solid) order.push_back(n);
  std::ranges::sort(order, {}, [&](std::uint32_t n) {
    const auto& [min, max] = parts[n].bounds;
    const Vec3 e = max - min;
    return std::tuple(-(e.x + e.y + e.z), min.x, min.y, min.z, -max.x, -max.y, -max.z, n);
  });
  return order;
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
std::array<std::vector<PartPoint>, kVotes> points_of(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of,
                                                     const std::vector<std::uint8_t>& wanted) {
  const auto before_in_x = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  const auto before_in_y = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.y, a.z, a.x) < std::tie(b.y, b.z, b.x);
  };
  std::vector<std::uint32_t> place(wanted.size(), Nesting::kNone);
  std::array<std::vector<PartPoint>, kVotes> points;
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    const std::uint32_t part = part_of[t];
    if (mesh.use_of(t) == 0 || part == Nesting::kNone || wanted[part] == 0) continue;
    const Vec3 point = point_of(mesh.mesh.corners(t));
    if (place[part] == Nesting::kNone) {
      place[part] = static_cast<std::uint32_t>(points[0].size());
      for (std::vector<PartPoint>& some : points) some.push_back({point, part});
    }
    const auto chosen = [&](std::size_t n) -> Vec3& { return points[n][place[part]].at; };
    if (before_in_x(point, chosen(0))) chosen(0) = point;
    if (before_in_x(chosen(1), point)) chosen(1) = point;
    if (before_in_y(point, chosen(2))) chosen(2) = point;
  }
  return points;
}

// Which parts have a box that is in another one's, and which have one that contains no other one's.
struct Candidates {
  std::vector<std::uint8_t> inner, innermost;
  std::int64_t tests = 0;
};
Candidates find_candidates(const BoxOrder& order, std::int64_t most_tests) {
  const auto count = static_cast<std::uint32_t>(order.size());
  std::vector<PartPoint> lows;
  for (std::uint32_t n = 0; n < count; ++n) lows.push_back({order[n].min, n});
  const PointCells cells(lows);
  Candidates found{std::vector<std::uint8_t>(count), std::vector<std::uint8_t>(count, 1)};
  for (std::uint32_t n = 0; n < count; ++n) found.tests += cells.count(order[n]);
  if (found.tests > most_tests) return found;
  for (std::uint32_t n = 0; n < count; ++n)
    cells.for_each(order[n], [&](const PartPoint& other, std::uint32_t) {
      if (!order.is_larger(n, other.part)) return;
      found.innermost[n] = 0;
      found.inner[other.part] = 1;
    });
  return found;
}

}  // namespace

Nesting find_nesting(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, std::span<const Part> parts,
                     std::int64_t most_tests) {
  Nesting nesting;
  nesting.depth.resize(parts.size());
  nesting.parent.resize(parts.size(), Nesting::kNone);
  const std::vector<std::uint32_t> part_at = in_order(parts);
  if (part_at.size() < 2) return nesting;
  std::vector<Box> boxes;
  std::vector<std::uint32_t> number_of(parts.size(), Nesting::kNone), numbers;
  for (const std::uint32_t part : part_at) {
    number_of[part] = static_cast<std::uint32_t>(boxes.size());
    boxes.push_back(parts[part].bounds);
  }
  for (const std::uint32_t part : part_of) numbers.push_back(number_of[part]);
  const BoxOrder order(std::move(boxes));
  const Candidates candidates = find_candidates(order, most_tests);
  nesting.known = candidates.tests <= most_tests;
  if (!nesting.known) return nesting;

  const auto all_points = points_of(mesh, numbers, candidates.inner);
  for (std::uint32_t& number : numbers)  // what contains nothing need not be met
    if (number != Nesting::kNone && candidates.innermost[number] != 0) number = Nesting::kNone;
  const RowSearch search(mesh, numbers, order);
  NestingVotes votes(search, order, most_tests - candidates.tests);
  for (const std::vector<PartPoint>& points : all_points)
    if (!votes.vote(points, candidates.innermost)) {
      nesting.known = false;
      return nesting;
    }
  for (std::uint32_t n = 0; n < order.size(); ++n) {
    if (candidates.inner[n] == 0) continue;
    const auto [depth, parent] = votes.result(n);
    nesting.depth[part_at[n]] = depth;
    if (depth > 0) nesting.parent[part_at[n]] = part_at[parent];
  }
  return nesting;
}

}  // namespace standoff
