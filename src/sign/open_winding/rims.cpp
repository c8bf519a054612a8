// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/rims.h"

#include <algorithm>
#include <cmath>

#include "core/weld.h"

namespace standoff {
namespace {

// A point amid the corners. Unequal weights, so that it is on no line that the corners' symmetry would put samples on:
// solid angles are ill-conditioned at the edges of their triangles. Near the first corner relative to it, for meshes
// far from the origin.
Vec3 point_amid(std::span<const Vec3> corners) {
  constexpr double kGolden = 0.6180339887498949;
  Vec3 sum;
  double weights = 0;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const double turn = kGolden * static_cast<double>(n + 1), weight = 1 + 0.5 * (turn - std::floor(turn));
    sum = sum + (corners[n] - corners[0]) * weight;
    weights += weight;
  }
  return corners[0] + sum * (1 / weights);
}

// Takes the edges of a boundary apart into polygons: walks along them, and cuts a polygon off wherever the walk comes
// back to a corner that it has passed. At each position as many edges begin as end, so a walk never gets stuck.
class Walk {
 public:
  explicit Walk(const std::vector<BoundaryEdge>& edges) : edges_(edges), left_(edges.size()), ends_(2 * edges.size()) {
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

  /// Calls use(polygon, weight) for each polygon.
  template <class Use>
  void for_each(const Use& use) {
    for (std::size_t start = 0; start + 1 < first_.size(); ++start)
      while (has_edge(start)) walk_from(start, use);
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

  template <class Use>
  void walk_from(std::size_t start, const Use& use) {
    std::size_t position = start;
    place_[position] = 0;
    while (has_edge(position)) {
      path_.push_back(out_[next_[position]]);
      position = to(path_.back());
      if (place_[position] == kNowhere) {
        place_[position] = path_.size();
      } else {
        cut_off(place_[position], use);
      }
      if (path_.empty()) break;
    }
    place_[start] = kNowhere;
  }

  // The path from this place on is a polygon.
  template <class Use>
  void cut_off(std::size_t place, const Use& use) {
    std::int32_t weight = left_[path_[place]];
    for (std::size_t n = place; n < path_.size(); ++n) weight = std::min(weight, left_[path_[n]]);
    std::vector<Vec3> polygon;
    for (std::size_t n = place; n < path_.size(); ++n) {
      polygon.push_back(edges_[path_[n]].from);
      left_[path_[n]] -= weight;
      if (n > place) place_[from(path_[n])] = kNowhere;
    }
    path_.resize(place);
    use(std::move(polygon), weight);
  }

  const std::vector<BoundaryEdge>& edges_;
  std::vector<std::int32_t> left_;        // of each edge's weight
  std::vector<std::uint32_t> ends_;       // numbers of positions, two an edge
  std::vector<std::size_t> first_, out_;  // edges by the position that they begin at
  std::vector<std::size_t> next_;         // of each position, the next edge to try
  std::vector<std::size_t> path_;         // edges of the walk
  std::vector<std::size_t> place_;        // of each position, where on the path it is
};

}  // namespace

Rims::Rims(const Boundary& boundary) {
  Walk(boundary.edges).for_each([&](std::vector<Vec3> polygon, std::int32_t weight) {
    add(std::move(polygon), weight);
  });
}

void Rims::add(std::vector<Vec3> polygon, std::int32_t weight) {
  constexpr std::size_t kArc = 8, kUncut = 32;  // edges
  for (std::size_t most = kUncut; polygon.size() > most; most = kMaxCorners) {
    const std::size_t size = polygon.size(), arcs = (size + kArc - 1) / kArc;
    std::vector<Vec3> chords, arc;
    for (std::size_t n = 0; n < arcs; ++n) {
      arc.clear();
      for (std::size_t corner = n * size / arcs; corner <= (n + 1) * size / arcs; ++corner)
        arc.push_back(polygon[corner % size]);
      // A chord with a bend: straight ones pass through samples where corners and samples share a lattice.
      const Vec3 middle = (arc.front() + (arc.back() - arc.front()) * 0.5), amid = point_amid(arc),
                 bend = middle + (amid - middle) * 0.3;
      chords.push_back(arc.front());
      chords.push_back(bend);
      arc.push_back(bend);
      add_small(arc, weight);
    }
    polygon = std::move(chords);
  }
  add_small(polygon, weight);
}

void Rims::add_small(std::span<const Vec3> polygon, std::int32_t weight) {
  apexes_.push_back(point_amid(polygon));
  weights_.push_back(weight);
  corners_.insert(corners_.end(), polygon.begin(), polygon.end());
  begin_.push_back(corners_.size());
}

Mesh caps_of(const Rims& rims) {
  Mesh mesh;
  for (std::size_t n = 0; n < rims.size(); ++n) {
    const Rim rim = rims[n];
    const auto apex = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(rim.apex);
    mesh.vertices.insert(mesh.vertices.end(), rim.corners.begin(), rim.corners.end());
    const auto size = static_cast<std::uint32_t>(rim.corners.size());
    for (std::int32_t copy = 0; copy < rim.weight; ++copy)
      for (std::uint32_t corner = 0; corner < size; ++corner)
        mesh.triangles.push_back({apex, apex + 1 + (corner + 1) % size, apex + 1 + corner});
  }
  return mesh;
}

}  // namespace standoff
