// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/self_intersections.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <tuple>
#include <vector>

#include "bvh/bvh.h"
#include "bvh/order.h"
#include "core/progress.h"
#include "geometry/triangle_pair.h"

namespace standoff {
namespace {

constexpr std::size_t kGroup = 1024;            // triangles between two looks at the limits
constexpr std::int64_t kMostOfTriangle = 4096;  // tests of one triangle
// A pair that shares a position is not tested, but it is found, and there may be very many: a million triangles around
// one vertex. So compared boxes count too: kBoxesPerTest take about as long as one test. Each triangle has kFreeBoxes
// for nothing, more than it needs in a mesh of any size whose vertices have few triangles.
constexpr std::int64_t kBoxesPerTest = 32, kFreeBoxes = 1024;
constexpr std::int64_t kMostBoxes = kBoxesPerTest * kMostOfTriangle;  // of one triangle
constexpr std::int64_t kBoxesBetweenChecks = std::int64_t{1} << 18;   // boxes

// The distinct triangles of a mesh, by positions, and the number of copies of each in any orientation.
struct DistinctTriangles {
  std::vector<std::uint32_t> triangles;  // the first of each, ascending
  std::vector<std::uint32_t> copies;     // of each
};

// Empty if all are distinct.
DistinctTriangles distinct_triangles(const MeshEdges& edges, std::size_t triangles, ProgressMeter& progress) {
  struct Positions {
    std::array<std::uint32_t, 3> positions;
    std::uint32_t triangle;
  };
  std::vector<Positions> faces(triangles);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      faces[t] = {{edges.position(t, 0), edges.position(t, 1), edges.position(t, 2)}, static_cast<std::uint32_t>(t)};
      std::ranges::sort(faces[t].positions);
    }
  });
  progress.check();
  tbb::parallel_sort(faces, [](const Positions& a, const Positions& b) {
    return std::tie(a.positions, a.triangle) < std::tie(b.positions, b.triangle);
  });
  progress.check();
  std::vector<std::uint32_t> copies(triangles);
  std::size_t distinct = 0;
  for (std::size_t n = 0, first = 0; n < triangles; ++n) {
    if (n == 0 || faces[n].positions != faces[first].positions) {
      first = n;
      ++distinct;
    }
    ++copies[faces[first].triangle];
  }
  DistinctTriangles found;
  if (distinct == triangles) return found;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    if (copies[t] == 0) continue;
    found.triangles.push_back(t);
    found.copies.push_back(copies[t]);
  }
  return found;
}

bool share_position(const MeshEdges& edges, std::uint32_t a, std::uint32_t b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (edges.position(a, i) == edges.position(b, j)) return true;
  return false;
}

struct Count {
  std::int64_t pairs = 0, boxes = 0;  // `boxes` measures the work: tests count as kBoxesPerTest each
  bool complete = true;

  friend Count operator+(const Count& a, const Count& b) {
    return {a.pairs + b.pairs, a.boxes + b.boxes, a.complete && b.complete};
  }
};

// Searches among distinct triangles. `copies`: the number of copies of each; empty: one each. `number`: the number in
// the whole mesh of each.
template <class Number>
SelfIntersections search(MeshView mesh, const MeshEdges& edges, const std::vector<std::uint32_t>& copies,
                         const Number& number, const IntersectionLimits& limits, ProgressMeter& progress) {
  const Bvh bvh(mesh, morton_order(mesh, {}, progress), frame_around(mesh), progress);
  const std::vector<std::uint32_t>& order = bvh.order();
  const auto copies_of = [&](std::size_t n) { return copies.empty() ? std::int64_t{1} : copies[order[n]]; };

  const auto count_of = [&](std::size_t n, Count count, WorkCheck& check) {
    const std::array<Vec3, 3> corners = mesh.corners(order[n]);
    std::int64_t tests = 0, boxes = kMostBoxes;
    const bool all = for_each_later_overlap(bvh, static_cast<std::uint32_t>(n), boxes, [&](std::uint32_t other) {
      if (share_position(edges, number(order[n]), number(order[other]))) return true;
      if (triangles_intersect(corners, mesh.corners(order[other]))) count.pairs += copies_of(n) * copies_of(other);
      return ++tests < kMostOfTriangle;
    });
    const std::int64_t compared = kMostBoxes - std::max<std::int64_t>(boxes, 0);
    count.boxes += std::max<std::int64_t>(0, compared - kFreeBoxes) + kBoxesPerTest * tests;
    count.complete = count.complete && all;
    check.add(compared + kBoxesPerTest * tests);
    return count;
  };
  const std::int64_t most_boxes =
      std::min(limits.tests, std::numeric_limits<std::int64_t>::max() / kBoxesPerTest) * kBoxesPerTest;
  progress.stage("intersections", static_cast<std::int64_t>(order.size()), limits.from, limits.to);
  Count total;
  std::size_t next = 0;
  while (next < order.size() && total.pairs < limits.pairs && total.boxes < most_boxes) {
    const std::size_t past = std::min(next + kGroup, order.size());
    total = total + tbb::parallel_reduce(
                        tbb::blocked_range<std::size_t>(next, past, 32), Count{},
                        [&](const auto& range, Count count) {
                          WorkCheck check(progress, kBoxesBetweenChecks);
                          for (std::size_t n = range.begin(); n != range.end(); ++n) count = count_of(n, count, check);
                          return count;
                        },
                        std::plus<>());
    progress.advance(static_cast<std::int64_t>(past - next));
    next = past;
  }
  return {total.pairs, total.complete && next == order.size()};
}

}  // namespace

SelfIntersections find_self_intersections(MeshView mesh, const MeshEdges& edges, const IntersectionLimits& limits,
                                          ProgressMeter& progress) {
  const DistinctTriangles distinct = distinct_triangles(edges, mesh.triangles.size(), progress);
  if (distinct.triangles.empty())
    return search(
        mesh, edges, {}, [](std::uint32_t t) { return t; }, limits, progress);
  std::vector<Triangle> once(distinct.triangles.size());
  std::ranges::transform(distinct.triangles, once.begin(), [&](std::uint32_t t) { return mesh.triangles[t]; });
  return search(
      {mesh.vertices, once}, edges, distinct.copies, [&](std::uint32_t t) { return distinct.triangles[t]; }, limits,
      progress);
}

}  // namespace standoff
