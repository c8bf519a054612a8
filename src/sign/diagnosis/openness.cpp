// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/openness.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/hashes.h"
#include "sign/cpu/kernels.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "simd/dispatch.h"
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

// The triangles between the boundary and an apex, seen from several points.
class Cone {
 public:
  static constexpr std::size_t kPointsAtOnce = 8;

  // Puts the apex outside the bounds, and in no plane or line with corners on a lattice.
  Cone(const Boundary& boundary, const Box& bounds)
      : edges_(boundary.edges),
        apex_(bounds.center() + Vec3{0.7548776662, 0.5698402910, 0.6180339887} * bounds.longest_side()),
        center_(bounds.center()),
        scale_(1 / bounds.longest_side()) {
    for (std::size_t axis = 0; axis < 3; ++axis) apex_of_all_[axis].fill(scaled(apex_)[axis]);
  }

  // Multiplies the weights of at most kPointsAtOnce points by the cone's winding number there, less the nearest
  // integer.
  void weigh(std::span<WeightedPoint> points) const {
    std::array<Sum, kPointsAtOnce> sums;
    Edges some;
    for (std::size_t first = 0; first < edges_.size(); first += kChunk) {
      const std::span<const BoundaryEdge> edges =
          std::span(edges_).subspan(first, std::min(kChunk, edges_.size() - first));
      load(edges, some);
      for (std::size_t n = 0; n < points.size(); ++n) add(edges, some, points[n].at, sums[n]);
    }
    for (std::size_t n = 0; n < points.size(); ++n) {
      const double turns = sums[n].exact + sums[n].angles.turns();
      points[n].weight *= turns - std::nearbyint(turns);
    }
  }

 private:
  static constexpr std::size_t kChunk = cpu::AngleChunk::kMost;
  using Floats = std::array<float, kChunk + cpu::AngleTriangles::kLanes>;

  // The edges' ends, relative to the center.
  struct Edges {
    std::array<Floats, 3> to, from;
  };
  struct Sum {
    cpu::AngleSums angles = cpu::AngleSums::none();
    double exact = 0;  // of triangles that are summed up one by one, in full turns
  };

  std::array<float, 3> scaled(const Vec3& p) const {
    const Vec3 local = (p - center_) * scale_;
    return {static_cast<float>(local.x), static_cast<float>(local.y), static_cast<float>(local.z)};
  }

  void load(std::span<const BoundaryEdge> edges, Edges& some) const {
    for (std::size_t n = 0; n < edges.size(); ++n) {
      const auto to = scaled(edges[n].to), from = scaled(edges[n].from);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        some.to[axis][n] = to[axis];
        some.from[axis][n] = from[axis];
      }
    }
  }

  void add(std::span<const BoundaryEdge> edges, const Edges& some, const Vec3& point, Sum& sum) const {
    cpu::AngleTriangles triangles;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      triangles.corner[0][axis] = apex_of_all_[axis].data();
      triangles.corner[1][axis] = some.to[axis].data();
      triangles.corner[2][axis] = some.from[axis].data();
    }
    cpu::AngleChunk chunk;
    kernels_.add_solid_angles(triangles, 0, static_cast<int>(edges.size()), scaled(point).data(), cpu::kLeastLength,
                              sum.angles, chunk);
    for (int n = 0; n < chunk.left_count; ++n) sum.exact += turns_of(edges[chunk.left[n]], point);
    for (const BoundaryEdge& edge : edges)
      if (edge.weight > 1) sum.exact += (edge.weight - 1) * turns_of(edge, point);
  }

  // Half the solid angle of a triangle is the argument of a complex number (van Oosterom and Strackee 1983). Edges
  // through the point count as 0.
  double turns_of(const BoundaryEdge& edge, const Vec3& point) const {
    const Vec3 to_apex = unit(apex_ - point), a = unit(edge.to - point), b = unit(edge.from - point);
    const double x = 1 + dot(a, b) + dot(b, to_apex) + dot(to_apex, a), y = dot(to_apex, cross(a, b));
    return x * x + y * y > 1e-28 ? std::atan2(y, x) / (2 * std::numbers::pi) : 0;
  }
  static Vec3 unit(const Vec3& v) {
    const double norm = length(v);
    return norm > 0 ? v * (1 / norm) : Vec3{};
  }

  const std::vector<BoundaryEdge>& edges_;
  Vec3 apex_, center_;
  double scale_;  // the mesh extends to 1/2 from the center
  std::array<Floats, 3> apex_of_all_;
  const cpu::SignKernels& kernels_ = dispatch_of<cpu::SignKernels>().best();
};

}  // namespace

double openness_of(const OrientedMesh& mesh, const Boundary& boundary) {
  if (boundary.edges.empty()) return 0;
  const std::size_t most = std::clamp(kMostAngles / boundary.edges.size(), kLeastPoints, kMostPoints);
  std::vector<WeightedPoint> points = points_on(mesh, most);
  const Cone cone(boundary, bounds(mesh.mesh));
  double weights = 0, sum = 0;
  for (const WeightedPoint& point : points) weights += point.weight;
  // Counted here: a range of TBB may hold more points than weigh() has room for.
  const std::size_t groups = (points.size() + Cone::kPointsAtOnce - 1) / Cone::kPointsAtOnce;
  tbb::parallel_for(std::size_t{0}, groups, [&](std::size_t n) {
    const auto rest = std::span(points).subspan(n * Cone::kPointsAtOnce);
    cone.weigh(rest.first(std::min(rest.size(), Cone::kPointsAtOnce)));
  });
  for (const WeightedPoint& point : points) sum += 2 * std::abs(point.weight);
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
  // Cells of the same slot share a list. Their points are too far from each other to be joined, but count as compared.
  std::vector<std::uint32_t> last(std::bit_ceil(2 * points.size()), kNoPoint), before(points.size(), kNoPoint);
  const auto last_of = [&](const Cell& c) -> std::uint32_t& {
    std::uint64_t hash = 0;
    for (const std::int64_t along : c) hash = splitmix64(hash ^ static_cast<std::uint64_t>(along));
    return last[hash & (last.size() - 1)];
  };
  // A crowded cell is searched no further; what is missed stays open.
  constexpr int kMostCompared = 64;
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
      int compared = 0;
      for (std::uint32_t m = last_of(cell); m != kNoPoint && compared < kMostCompared; m = before[m], ++compared)
        if (length(points[m] - points[n]) <= width) sets.join(n, m);
    }
    before[n] = std::exchange(last_of(own), n);
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
