// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/boundary_polygons.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/weld.h"

namespace standoff {
namespace {

// Walks along the edges, and cuts a polygon off wherever the walk comes back to a corner that it has passed. At each
// position as many edges begin as end, so a walk never gets stuck.
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

  // Whether an edge that is left begins there: out_[next_[position]].
  bool has_edge(std::size_t position) {
    while (next_[position] < first_[position + 1] && left_[out_[next_[position]]] == 0) ++next_[position];
    return next_[position] < first_[position + 1];
  }

  // Of the edges that are left where the path ends, moves to the front the one that turns back most sharply. The first
  // few are looked at: a corner may have very many.
  void prefer_sharpest_turn(std::size_t position) {
    constexpr std::size_t kLookedAt = 8;
    const Vec3 came = direction(path_.back());
    const std::size_t begin = next_[position], end = std::min(first_[position + 1], begin + kLookedAt);
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

  // The path from this place on is a polygon.
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
  std::vector<std::int32_t> left_;        // of each edge's weight
  std::vector<std::uint32_t> ends_;       // numbers of positions, two an edge
  std::vector<std::size_t> first_, out_;  // edges by the position that they begin at
  std::vector<std::size_t> next_;         // of each position, the next edge to try
  std::vector<std::size_t> path_;         // edges of the walk
  std::vector<std::size_t> place_;        // of each position, where on the path it is
};

// Relative to the first corner, for polygons far from the origin.
Vec3 mean_of(std::span<const Vec3> corners) {
  Vec3 sum;
  for (const Vec3& corner : corners) sum = sum + (corner - corners[0]);
  return corners[0] + sum * (1 / static_cast<double>(corners.size()));
}

}  // namespace

void for_each_polygon(const Boundary& boundary, const std::function<void(BoundaryPolygon)>& use) {
  constexpr std::size_t kAtOnce = 1 << 14;  // edges of small loops: a walk takes memory, and some time to begin with
  const std::span<const BoundaryEdge> edges = boundary.edges;
  for (std::size_t n = 0, begin = 0; n < boundary.loops(); ++n) {
    const std::size_t end = boundary.begin[n + 1];
    if (end - begin < kAtOnce && n + 1 < boundary.loops()) continue;
    Walk(edges.subspan(begin, end - begin), use).run();
    begin = end;
  }
}

Cap cap_of(const BoundaryPolygon& polygon, const Vec3& origin) {
  const std::size_t size = polygon.corners.size();
  const Vec3 apex = mean_of(polygon.corners);
  Cap cap;
  for (std::size_t n = 0; n < size; ++n) {
    const Vec3 normal =
        cross(polygon.corners[(n + 1) % size] - apex, polygon.corners[n] - apex) * (0.5 * polygon.weight);
    cap.area += length(normal);
    cap.volume += dot(apex - origin, normal) / 3;
  }
  return cap;
}

}  // namespace standoff
