// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/openness.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/hashes.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

// Openness.

namespace {

struct WeightedPoint {
  Vec3 at;
  double weight;
};

double used_area_of(const OrientedMesh& mesh, std::size_t t) {
  return mesh.use_of(t) == 0 ? 0 : area_of(mesh.corners(t));
}

Vec3 centroid_of(const OrientedMesh& mesh, std::size_t t) {
  const auto [a, b, c] = mesh.corners(t);
  return a + ((b - a) + (c - a)) * (1.0 / 3);
}

std::vector<WeightedPoint> points_on(const OrientedMesh& mesh, std::size_t most) {
  const std::size_t triangles = mesh.mesh.triangles.size();
  std::vector<WeightedPoint> points;
  if (triangles <= most) {
    for (std::size_t t = 0; t < triangles; ++t)
      if (const double area = used_area_of(mesh, t); area > 0) points.push_back({centroid_of(mesh, t), area});
    return points;
  }
  double whole = 0, passed = 0, taken = 0;
  for (std::size_t t = 0; t < triangles; ++t) whole += used_area_of(mesh, t);
  if (!(whole > 0)) return points;
  for (std::size_t t = 0; t < triangles; ++t) {
    passed += used_area_of(mesh, t);
    // Point n is in the middle of the n-th of `most` equal areas. All points in a triangle become its centroid, once.
    const double due = std::floor(passed / whole * static_cast<double>(most) + 0.5);
    if (due > taken) points.push_back({centroid_of(mesh, t), due - taken});
    taken = std::max(taken, due);
  }
  return points;
}

// The cone over the boundary.
class Cone {
 public:
  // Puts the apex outside the bounds, and in no plane or line with corners on a lattice.
  Cone(const Boundary& boundary, const Box& bounds)
      : edges_(boundary.edges),
        apex_(bounds.center() + Vec3{0.7548776662, 0.5698402910, 0.6180339887} * bounds.longest_side()) {}

  // Half the solid angle of a triangle is the argument of a complex number (van Oosterom and Strackee 1983). So half
  // the sum of all is the argument of their product, modulo 2 pi, which is a winding number of 1. Edges through the
  // point count as 0.
  double winding_modulo_1(const Vec3& point) const {
    const Vec3 to_apex = unit(apex_ - point);
    double x = 1, y = 0;
    for (const BoundaryEdge& edge : edges_) {
      const Vec3 a = unit(edge.to - point), b = unit(edge.from - point);
      double u = 1 + dot(a, b) + dot(b, to_apex) + dot(to_apex, a), v = dot(to_apex, cross(a, b));
      if (edge.weight > 1) {
        const double angle = std::atan2(v, u) * edge.weight;
        u = std::cos(angle);
        v = std::sin(angle);
      }
      const double real = x * u - y * v, imaginary = x * v + y * u;
      const double magnitude_sq = real * real + imaginary * imaginary;
      if (!(magnitude_sq > 1e-28)) continue;
      const double scale = 1 / std::sqrt(magnitude_sq);
      x = real * scale;
      y = imaginary * scale;
    }
    return std::atan2(y, x) / (2 * std::numbers::pi);
  }

 private:
  static Vec3 unit(const Vec3& v) {
    const double norm = length(v);
    return norm > 0 ? v * (1 / norm) : Vec3{};
  }

  const std::vector<BoundaryEdge>& edges_;
  Vec3 apex_;
};

}  // namespace

double openness_of(const OrientedMesh& mesh, const Boundary& boundary) {
  if (boundary.edges.empty()) return 0;
  const std::size_t most = std::clamp(kMostAngles / boundary.edges.size(), kLeastPoints, kMostPoints);
  std::vector<WeightedPoint> points = points_on(mesh, most);
  const Cone cone(boundary, bounds(mesh.mesh));
  double weights = 0, sum = 0;
  for (const WeightedPoint& point : points) weights += point.weight;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size()), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n)
      points[n].weight *= 2 * std::abs(cone.winding_modulo_1(points[n].at));
  });
  for (const WeightedPoint& point : points) sum += point.weight;
  return weights > 0 ? sum / weights : 0;
}

// Cracks.

namespace {

constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

// An open edge. Its ends are numbers of points.
struct OpenEdge {
  std::uint32_t low, high;
  bool forward, single;  // `single`: it has one triangle, which goes from low to high if `forward`
};

struct OpenEdges {
  std::vector<std::uint32_t> number;  // the point of each position, or kNoPoint
  std::vector<Vec3> points;
  std::vector<OpenEdge> edges;
};

OpenEdges open_edges_of(MeshView mesh, const MeshEdges& edges) {
  OpenEdges open;
  open.number.assign(edges.positions(), kNoPoint);
  const auto for_each_open = [&](const auto& use) {
    for_each_edge(edges, {}, [&](std::span<const HalfEdge> sides) {
      if (sides.size() % 2 != 0) use(sides);
    });
  };
  std::size_t points = 0, count = 0;
  for_each_open([&](std::span<const HalfEdge> sides) {
    ++count;
    for (const std::uint32_t end : {sides.front().low, sides.front().high})
      points += std::exchange(open.number[end], 0) == kNoPoint;
  });
  if (count == 0) return open;
  std::ranges::fill(open.number, kNoPoint);
  open.points.reserve(points);
  open.edges.reserve(count);
  const auto point = [&](std::uint32_t position, const Vec3& at) {
    std::uint32_t& number = open.number[position];
    if (number == kNoPoint) {
      number = static_cast<std::uint32_t>(open.points.size());
      open.points.push_back(at);
    }
    return number;
  };
  for_each_open([&](std::span<const HalfEdge> sides) {
    const HalfEdge& side = sides.front();
    const auto corners = mesh.corners(side.triangle);
    Vec3 low = corners[side.corner], high = corners[(side.corner + 1) % 3];
    if (!side.forward) std::swap(low, high);
    open.edges.push_back({point(side.low, low), point(side.high, high), side.forward, sides.size() == 1});
  });
  return open;
}

// Joins points whose distance is at most `width`. Cells are twice as wide, so that all such points around a point lie
// in the eight cells at its nearest corner.
DisjointSets welded_points(std::span<const Vec3> points, const Vec3& origin, double width) {
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& c) const {
      return splitmix64(splitmix64(splitmix64(static_cast<std::uint64_t>(c[0])) ^ static_cast<std::uint64_t>(c[1])) ^
                        static_cast<std::uint64_t>(c[2]));
    }
  };
  // A crowded cell is searched no further; what is missed stays open.
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

// Whether most triangles are copies of others once they are welded, as in sheets with a front and a back.
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
  const bool overflows = !std::isfinite(width) || !std::isfinite(0.5 / width);
  if (open.edges.empty() || overflows) return found;
  DisjointSets sets = welded_points(open.points, box.min, width);
  for (OpenEdge& edge : open.edges) {
    edge.low = sets.find(edge.low).set;
    edge.high = sets.find(edge.high).set;
    if (edge.low > edge.high) {
      std::swap(edge.low, edge.high);
      edge.forward = !edge.forward;
    }
  }
  // Drop edges that became points: a triangle thinner than a crack has such a side, or two sides that become one.
  std::erase_if(open.edges, [](const OpenEdge& edge) { return edge.low == edge.high; });
  const auto ends = [](const OpenEdge& edge) { return std::tuple(edge.low, edge.high); };
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
