// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/openness.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "standoff/mesh.h"

namespace standoff {
namespace {

struct WeightedPoint {
  Vec3 at;
  double weight;
};

double area_of(const OrientedMesh& mesh, std::size_t t) {
  if (mesh.use_of(t) == 0) return 0;
  const auto [a, b, c] = mesh.corners(t);
  return length(cross(b - a, c - a)) / 2;
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
      if (const double area = area_of(mesh, t); area > 0) points.push_back({centroid_of(mesh, t), area});
    return points;
  }
  double whole = 0, passed = 0, taken = 0;
  for (std::size_t t = 0; t < triangles; ++t) whole += area_of(mesh, t);
  if (!(whole > 0)) return points;
  for (std::size_t t = 0; t < triangles; ++t) {
    passed += area_of(mesh, t);
    // Point n is in the middle of the n-th of `most` equal areas. Those in one triangle are its centroid, once.
    const double due = std::floor(passed / whole * static_cast<double>(most) + 0.5);
    if (due > taken) points.push_back({centroid_of(mesh, t), due - taken});
    taken = std::max(taken, due);
  }
  return points;
}

// The cone over the boundary, for its winding numbers modulo 1.
class Cone {
 public:
  // The apex is outside the bounds, and in no plane or line with corners on a lattice.
  Cone(const Boundary& boundary, const Box& bounds)
      : edges_(boundary.edges),
        apex_(bounds.center() + Vec3{0.7548776662, 0.5698402910, 0.6180339887} * bounds.longest_side()) {}

  // Half the solid angle of a triangle is the argument of a complex number (van Oosterom and Strackee 1983), so half
  // the sum of all is that of their product, modulo 2 pi: a winding number of 1. Edges through the point count as 0.
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

}  // namespace standoff
