// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/boundary.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

#include "core/weld.h"
#include "sign/diagnosis/disjoint_sets.h"

namespace standoff {

// Loops.

namespace {

// A boundary edge, by one of its half-edges. A triangle soup has three per triangle, so they hold no positions until
// their order is known.
struct ExcessEdge {
  HalfEdge side;
  std::int32_t excess;
};

// The position of a half-edge's low end, or of its high end.
Vec3 end_of(const MeshView& mesh, const HalfEdge& side, bool low) {
  const int corner = low == side.forward ? side.corner : (side.corner + 1) % 3;
  return mesh.corner(side.triangle, corner);
}

BoundaryEdge boundary_edge_of(const MeshView& mesh, const ExcessEdge& one) {
  return {end_of(mesh, one.side, one.excess > 0), end_of(mesh, one.side, one.excess < 0), std::abs(one.excess)};
}

std::vector<ExcessEdge> edges_in_excess(const OrientedMesh& mesh, const MeshEdges& edges) {
  const auto for_each_found = [&](const auto& use) {
    edges.for_each([&](std::span<const HalfEdge> sides) {
      if (const std::int32_t excess = excess_of(sides, mesh.use)) use(ExcessEdge{sides.front(), excess});
    });
  };
  std::size_t count = 0;
  for_each_found([&](const ExcessEdge&) { ++count; });
  std::vector<ExcessEdge> found;
  found.reserve(count);
  for_each_found([&](const ExcessEdge& one) { found.push_back(one); });
  return found;
}

Vec3 farthest_from(const Vec3& from, std::span<const BoundaryEdge> loop) {
  Vec3 farthest = from;
  for (const BoundaryEdge& edge : loop)
    for (const Vec3& p : {edge.from, edge.to})
      if (length(p - from) > length(farthest - from)) farthest = p;
  return farthest;
}

}  // namespace

Boundary net_boundary(const OrientedMesh& mesh, const MeshEdges& edges) {
  const std::vector<ExcessEdge> all = edges_in_excess(mesh, edges);
  std::vector<std::uint32_t> ends;
  ends.reserve(2 * all.size());
  for (const ExcessEdge& one : all) ends.insert(ends.end(), {one.side.low, one.side.high});
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const auto number_of = [&](std::uint32_t position) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(ends, position) - ends.begin());
  };
  DisjointSets connected(ends.size());
  for (const ExcessEdge& one : all) connected.join(number_of(one.side.low), number_of(one.side.high));

  // Sort the edges by the least position of their loop, by counting.
  std::vector<std::uint32_t> loop_of(all.size());
  std::vector<std::size_t> next(ends.size() + 1);
  for (std::size_t n = 0; n < all.size(); ++n) {
    loop_of[n] = connected.find(number_of(all[n].side.low)).set;
    ++next[loop_of[n] + 1];
  }
  Boundary boundary;
  boundary.begin.reserve(next.size() - static_cast<std::size_t>(std::ranges::count(next, 0)) + 1);
  for (std::size_t n = 1; n < next.size(); ++n) {
    if (next[n] > 0) boundary.begin.push_back(boundary.begin.back() + next[n]);
    next[n] += next[n - 1];
  }
  boundary.edges.resize(all.size());
  for (std::size_t n = 0; n < all.size(); ++n) boundary.edges[next[loop_of[n]]++] = boundary_edge_of(mesh.mesh, all[n]);
  return boundary;
}

double length_of(std::span<const BoundaryEdge> loop) {
  double sum = 0;
  for (const BoundaryEdge& edge : loop) sum += length(edge.to - edge.from);
  return sum;
}

double diameter_of(std::span<const BoundaryEdge> loop) {
  if (loop.empty()) return 0;
  // Go from a point to the farthest one, again and again: no distance is smaller than the one before.
  Vec3 from = loop.front().from, to = from;
  for (int search = 0; search < 4; ++search) from = std::exchange(to, farthest_from(to, loop));
  return length(to - from);
}

// Polygons.

namespace {

// Walks along the edges, and cuts a polygon off wherever the walk comes back to a corner that it has passed. The number
// of edges that begin at a position equals the number that end there, so a walk never gets stuck.
class Walk {
 public:
  Walk(std::span<const BoundaryEdge> edges, const std::function<void(BoundaryPolygon)>& use)
      : edges_(edges), use_(use), left_(edges.size()), ends_(2 * edges.size()) {
    const auto end = [&](std::uint32_t n) { return n % 2 == 0 ? edges[n / 2].from : edges[n / 2].to; };
    const std::uint32_t positions = weld(end, ends_);
    first_.resize(positions + std::size_t{1});
    for (std::size_t n = 0; n < edges.size(); ++n) {
      left_[n] = edges[n].weight;
      ++first_[from(n) + 1];
    }
    for (std::size_t n = 0; n < positions; ++n) first_[n + 1] += first_[n];
    out_.resize(edges.size());
    next_.assign(first_.begin(), first_.end() - 1);
    for (std::size_t n = 0; n < edges.size(); ++n) out_[next_[from(n)]++] = n;
    next_.assign(first_.begin(), first_.end() - 1);
    place_.assign(positions, kNowhere);
  }

  void run() {
    for (std::size_t start = 0; start + 1 < first_.size(); ++start)
      while (has_edge(start)) walk_from(start);
  }

 private:
  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

  std::size_t from(std::size_t edge) const { return ends_[2 * edge]; }
  std::size_t to(std::size_t edge) const { return ends_[2 * edge + 1]; }

  // Whether an edge with weight left begins there: out_[next_[position]].
  bool has_edge(std::size_t position) {
    while (next_[position] < first_[position + 1] && left_[out_[next_[position]]] == 0) ++next_[position];
    return next_[position] < first_[position + 1];
  }

  // Moves the edge to the front that turns back most sharply, among those left where the path ends. Compares the first
  // few only, because a corner may have very many.
  void prefer_sharpest_turn(std::size_t position) {
    constexpr std::size_t kCompared = 8;
    const Vec3 came = direction(path_.back());
    const std::size_t begin = next_[position], end = std::min(first_[position + 1], begin + kCompared);
    std::size_t best = begin;
    double least = 2;
    for (std::size_t n = begin; n < end; ++n) {
      const double turn = left_[out_[n]] == 0 ? 2 : dot(came, direction(out_[n]));
      if (turn < least) {
        least = turn;
        best = n;
      }
    }
    std::swap(out_[begin], out_[best]);
  }

  Vec3 direction(std::size_t edge) const {
    const Vec3 along = edges_[edge].to - edges_[edge].from;
    return along * (1 / length(along));
  }

  void walk_from(std::size_t start) {
    std::size_t position = start;
    place_[position] = 0;
    while (has_edge(position)) {
      if (!path_.empty()) prefer_sharpest_turn(position);
      path_.push_back(out_[next_[position]]);
      position = to(path_.back());
      if (place_[position] == kNowhere) {
        place_[position] = path_.size();
      } else {
        cut_off(place_[position]);
      }
      if (path_.empty()) break;
    }
    place_[start] = kNowhere;
  }

  // Cuts off the path from this place on, which is a polygon.
  void cut_off(std::size_t place) {
    std::int32_t weight = left_[path_[place]];
    for (std::size_t n = place; n < path_.size(); ++n) weight = std::min(weight, left_[path_[n]]);
    std::vector<Vec3> polygon;
    for (std::size_t n = place; n < path_.size(); ++n) {
      polygon.push_back(edges_[path_[n]].from);
      left_[path_[n]] -= weight;
      if (n > place) place_[from(path_[n])] = kNowhere;
    }
    path_.resize(place);
    use_({std::move(polygon), weight});
  }

  std::span<const BoundaryEdge> edges_;
  const std::function<void(BoundaryPolygon)>& use_;
  std::vector<std::int32_t> left_;        // what is left of each edge's weight
  std::vector<std::uint32_t> ends_;       // numbers of positions, two per edge
  std::vector<std::size_t> first_, out_;  // edges by the position that they begin at
  std::vector<std::size_t> next_;         // the next edge to try at each position
  std::vector<std::size_t> path_;         // edges of the walk
  std::vector<std::size_t> place_;        // where each position is on the path
};

// Sums up relative to the first corner, for polygons far from the origin.
Vec3 mean_of(std::span<const Vec3> corners) {
  Vec3 sum;
  for (const Vec3& corner : corners) sum = sum + (corner - corners[0]);
  return corners[0] + sum * (1 / static_cast<double>(corners.size()));
}

}  // namespace

void for_each_polygon(const Boundary& boundary, const std::function<void(BoundaryPolygon)>& use) {
  constexpr std::size_t kAtOnce = 1 << 14;  // edges; one walk takes many small loops, because it costs time to begin
  const std::span<const BoundaryEdge> edges = boundary.edges;
  for (std::size_t n = 0, begin = 0; n < boundary.loops(); ++n) {
    const std::size_t end = boundary.begin[n + 1];
    if (end - begin < kAtOnce && n + 1 < boundary.loops()) continue;
    Walk(edges.subspan(begin, end - begin), use).run();
    begin = end;
  }
}

CapSums cap_sums_of(const BoundaryPolygon& polygon, const Vec3& origin) {
  const std::size_t size = polygon.corners.size();
  const Vec3 apex = mean_of(polygon.corners);
  CapSums cap;
  for (std::size_t n = 0; n < size; ++n) {
    const Vec3 normal =
        cross(polygon.corners[(n + 1) % size] - apex, polygon.corners[n] - apex) * (0.5 * polygon.weight);
    cap.area += length(normal);
    cap.volume += dot(apex - origin, normal) / 3;
  }
  return cap;
}

}  // namespace standoff
