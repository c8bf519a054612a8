// SPDX-License-Identifier: Apache-2.0
#include "sign/normal/pseudonormals.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/predicates.h"

namespace standoff {
namespace {

// Which corner, side or face of a triangle is closest to a point.
struct ClosestFeature {
  enum class Kind { corner, side, face } kind;
  int n;      // the corner, or the side from this corner to the next one
  Vec3 away;  // from the closest point to the point asked about
};

// In double. Requires finite corners. The face is taken only where the point is above it; of a triangle without area
// a side or a corner is closest.
ClosestFeature closest_feature(const std::array<Vec3, 3>& corners, const Vec3& p) {
  using Kind = ClosestFeature::Kind;
  const std::array<Vec3, 3> to = {corners[0] - p, corners[1] - p, corners[2] - p};
  const Vec3 normal = cross(to[1] - to[0], to[2] - to[0]);
  const double normal_sq = dot(normal, normal);
  if (normal_sq > 0 && dot(normal, cross(to[0], to[1])) > 0 && dot(normal, cross(to[1], to[2])) > 0 &&
      dot(normal, cross(to[2], to[0])) > 0)
    return {Kind::face, 0, normal * (-dot(normal, to[0]) / normal_sq)};

  ClosestFeature best{Kind::corner, 0, {}};
  double best_sq = std::numeric_limits<double>::infinity();
  const auto look = [&](Kind kind, int n, const Vec3& at) {
    const double sq = dot(at, at);
    if (!(sq < best_sq)) return;
    best_sq = sq;
    best = {kind, n, at * -1.0};
  };
  for (int n = 0; n < 3; ++n) {
    const Vec3 &a = to[static_cast<std::size_t>(n)], &b = to[static_cast<std::size_t>((n + 1) % 3)], side = b - a;
    const double along = -dot(a, side), length_sq = dot(side, side);
    look(Kind::corner, n, a);
    if (along > 0 && along < length_sq) look(Kind::side, n, a + side * (along / length_sq));
  }
  return best;
}

using NormalRange = tbb::blocked_range<std::size_t>;
constexpr std::size_t kNormalGrain = 4096;

double angle_at(const std::array<Vec3, 3>& t, std::size_t n, double normal_length) {
  return std::atan2(normal_length, dot(t[(n + 1) % 3] - t[n], t[(n + 2) % 3] - t[n]));
}

}  // namespace

TriangleNormal exact_normal(const std::array<Vec3, 3>& t) {
  const auto part = [&](double Vec3::*u, double Vec3::*v) {
    return determinant2d({t[0].*u, t[0].*v}, {t[1].*u, t[1].*v}, {t[2].*u, t[2].*v});
  };
  const Vec3 normal{part(&Vec3::y, &Vec3::z), part(&Vec3::z, &Vec3::x), part(&Vec3::x, &Vec3::y)};
  const double largest = max_norm(normal);
  if (!(largest > 0)) return {};
  const Vec3 scaled = normal / Vec3{largest, largest, largest};  // its squares neither overflow nor vanish
  return {scaled * (1 / length(scaled)), largest * length(scaled)};
}

Pseudonormals::Pseudonormals(const OrientedMesh& mesh) : mesh_(mesh), edges_(mesh.mesh) {
  const std::size_t triangles = mesh.mesh.triangles.size();
  std::vector<Vec3> units(triangles);  // in the orientation of use; zero for triangles that are left out
  std::vector<double> angles(3 * triangles);
  tbb::parallel_for(NormalRange(0, triangles, kNormalGrain), [&](const NormalRange& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const std::array<Vec3, 3> corners = mesh.mesh.corners(t);
      const TriangleNormal normal = exact_normal(corners);
      units[t] = normal.unit * mesh.use_of(t);
      for (std::size_t n = 0; n < 3; ++n) angles[3 * t + n] = angle_at(corners, n, normal.length);
    }
  });
  set_normals_of_sides(units);
  // Sum up in the order of the triangles, so that the sums are the same for any number of threads.
  of_vertices_.resize(edges_.positions());
  for (std::size_t t = 0; t < triangles; ++t)
    for (int n = 0; n < 3; ++n) {
      Vec3& sum = of_vertices_[edges_.position(t, n)];
      sum = sum + units[t] * angles[3 * t + static_cast<std::size_t>(n)];
    }
}

void Pseudonormals::set_normals_of_sides(const std::vector<Vec3>& units) {
  of_sides_.resize(3 * units.size());
  facing_.resize(units.size());
  // Skip sides of length 0: they have no normal, and neither has the triangle.
  const std::span<const HalfEdge> sides = edges_.half_edges();
  const auto same_edge = [&](std::size_t m, std::size_t n) {
    return sides[m].low == sides[n].low && sides[m].high == sides[n].high;
  };
  const auto opposite = [&](const HalfEdge& side) { return edges_.position(side.triangle, (side.corner + 2) % 3); };
  tbb::parallel_for(NormalRange(0, sides.size(), kNormalGrain), [&](const NormalRange& range) {
    std::vector<HalfEdge> edge;
    for (std::size_t first = range.begin(); first != range.end(); ++first) {
      if (first > 0 && same_edge(first - 1, first)) continue;  // the edge belongs to another range
      std::size_t past = first + 1;
      while (past < sides.size() && same_edge(first, past)) ++past;
      Vec3 sum{};
      for (std::size_t n = first; n < past; ++n) sum = sum + units[sides[n].triangle];
      edge.assign(sides.begin() + static_cast<std::ptrdiff_t>(first),
                  sides.begin() + static_cast<std::ptrdiff_t>(past));
      for (const HalfEdge& side : edge) of_sides_[3 * side.triangle + side.corner] = sum;
      // Triangles at one edge with the same opposite corner are one face. The first side of each finds its orientation.
      std::ranges::stable_sort(edge, {}, opposite);
      for (std::size_t n = 0; n < edge.size();) {
        std::size_t next = n;
        int net = 0;  // forward triangles less backward ones
        for (; next < edge.size() && opposite(edge[next]) == opposite(edge[n]); ++next)
          net += (edge[next].forward ? 1 : -1) * mesh_.use_of(edge[next].triangle);
        for (; n < next; ++n)
          if (edge[n].corner == 0)
            facing_[edge[n].triangle] = static_cast<std::int8_t>(((net > 0) - (net < 0)) * (edge[n].forward ? 1 : -1));
      }
    }
  });
}

auto Pseudonormals::place_of(const Vec3& p, std::uint32_t triangle) const -> Place {
  const std::array<Vec3, 3> corners = mesh_.mesh.corners(triangle);
  const ClosestFeature closest = closest_feature(corners, p);
  if (closest.kind == ClosestFeature::Kind::face) {
    const int side = orient3d(corners[0], corners[1], corners[2], p);
    return side == 0 ? Place::on_surface : side * facing_[triangle] < 0 ? Place::back : Place::front;
  }
  // Within some roundings of a side or a corner, the direction means nothing.
  const double size = std::max({max_norm(corners[0] - p), max_norm(corners[1] - p), max_norm(corners[2] - p)});
  if (max_norm(closest.away) <= 8 * std::numeric_limits<double>::epsilon() * size) return Place::on_surface;
  const Vec3& normal = closest.kind == ClosestFeature::Kind::side
                           ? of_sides_[3 * std::size_t{triangle} + static_cast<std::size_t>(closest.n)]
                           : of_vertices_[edges_.position(triangle, closest.n)];
  return dot(closest.away, normal) < 0 ? Place::back : Place::front;
}

}  // namespace standoff
