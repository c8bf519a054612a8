// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/cracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "core/hashes.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/edge_sides.h"

namespace standoff {
namespace {

constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

// An open edge by its ends, numbers of points.
struct CrackSide {
  std::uint32_t low, high;
  bool forward, single;  // of its triangle if it has but one
};

struct OpenEdges {
  std::vector<std::uint32_t> number;  // of each position its point, or kNoPoint
  std::vector<Vec3> points;
  std::vector<CrackSide> edges;
};

OpenEdges open_edges_of(MeshView mesh, const MeshEdges& edges) {
  OpenEdges open;
  open.number.assign(edges.positions(), kNoPoint);
  const auto point = [&](std::uint32_t position, const Vec3& at) {
    std::uint32_t& number = open.number[position];
    if (number == kNoPoint) {
      number = static_cast<std::uint32_t>(open.points.size());
      open.points.push_back(at);
    }
    return number;
  };
  for_each_edge(edges, {}, [&](std::span<const EdgeUse> sides) {
    if (sides.size() % 2 == 0) return;
    const EdgeUse& side = sides.front();
    const auto corners = mesh.corners(side.triangle);
    Vec3 low = corners[side.corner], high = corners[(side.corner + 1) % 3];
    if (!side.forward) std::swap(low, high);
    open.edges.push_back({point(side.low, low), point(side.high, high), side.forward, sides.size() == 1});
  });
  return open;
}

// Joins points no farther apart than `width`. Cells are twice as wide, so that all of them around a point are in the
// eight cells at its nearest corner.
DisjointSets welded_points(std::span<const Vec3> points, const Vec3& origin, double width) {
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& c) const {
      return splitmix64(splitmix64(splitmix64(static_cast<std::uint64_t>(c[0])) ^ static_cast<std::uint64_t>(c[1])) ^
                        static_cast<std::uint64_t>(c[2]));
    }
  };
  // Of a crowded cell only so many points are compared with; what is missed stays open.
  constexpr int kMostCompared = 64;
  std::unordered_map<Cell, std::uint32_t, Hash> last;
  std::vector<std::uint32_t> before(points.size(), kNoPoint);
  DisjointSets sets(points.size());
  for (std::uint32_t n = 0; n < points.size(); ++n) {
    const Vec3 at = (points[n] - origin) * (0.5 / width);
    const Cell own{static_cast<std::int64_t>(std::floor(at.x)), static_cast<std::int64_t>(std::floor(at.y)),
                   static_cast<std::int64_t>(std::floor(at.z))};
    const Cell step{at.x - std::floor(at.x) < 0.5 ? -1 : 1, at.y - std::floor(at.y) < 0.5 ? -1 : 1,
                    at.z - std::floor(at.z) < 0.5 ? -1 : 1};
    for (int corner = 0; corner < 8; ++corner) {
      Cell cell = own;
      for (std::size_t axis = 0; axis < 3; ++axis)
        if ((corner >> axis & 1) != 0) cell[axis] += step[axis];
      const auto found = last.find(cell);
      if (found == last.end()) continue;
      int compared = 0;
      for (std::uint32_t m = found->second; m != kNoPoint && compared < kMostCompared; m = before[m], ++compared)
        if (length(points[m] - points[n]) <= width) sets.join(n, m);
    }
    std::uint32_t& head = last.try_emplace(own, kNoPoint).first->second;
    before[n] = head;
    head = n;
  }
  return sets;
}

// Whether most triangles are copies of others once they are welded: those of sheets with a front and a back.
bool is_mostly_copies(const MeshEdges& edges, const OpenEdges& open, DisjointSets& sets, std::size_t triangles) {
  std::vector<std::array<std::uint32_t, 3>> faces(triangles);
  const auto points = static_cast<std::uint32_t>(open.points.size());
  for (std::size_t t = 0; t < triangles; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t position = edges.position(t, corner), point = open.number[position];
      faces[t][static_cast<std::size_t>(corner)] = point == kNoPoint ? points + position : sets.find(point).set;
    }
    std::ranges::sort(faces[t]);
  }
  std::ranges::sort(faces);
  std::size_t copies = 0;
  for (std::size_t n = 1; n < triangles; ++n) copies += faces[n] == faces[n - 1];
  return 4 * copies > triangles;
}

}  // namespace

Cracks find_cracks(MeshView mesh, const MeshEdges& edges) {
  Cracks found;
  OpenEdges open = open_edges_of(mesh, edges);
  const Box box = bounds(mesh);
  const double width = kCrackWidth * box.longest_side();
  // Also where lengths overflow.
  if (open.edges.empty() || !std::isfinite(width) || !std::isfinite(0.5 / width)) return found;
  DisjointSets sets = welded_points(open.points, box.min, width);
  for (CrackSide& edge : open.edges) {
    edge.low = sets.find(edge.low).set;
    edge.high = sets.find(edge.high).set;
    if (edge.low > edge.high) {
      std::swap(edge.low, edge.high);
      edge.forward = !edge.forward;
    }
  }
  // A triangle thinner than a crack has two sides that become one, or one that becomes a point.
  std::erase_if(open.edges, [](const CrackSide& edge) { return edge.low == edge.high; });
  const auto ends = [](const CrackSide& edge) { return std::tuple(edge.low, edge.high); };
  std::ranges::sort(open.edges, {}, ends);
  for (auto next = open.edges.begin(); next != open.edges.end();) {
    const auto first = next;
    while (next != open.edges.end() && ends(*next) == ends(*first)) ++next;
    if ((next - first) % 2 != 0) return found;
    if (next - first == 2 && first->single && first[1].single)
      found.inconsistent_edges += first->forward == first[1].forward;
  }
  found.all = !is_mostly_copies(edges, open, sets, mesh.triangles.size());
  return found;
}

}  // namespace standoff
