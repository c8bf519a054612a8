// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/rims.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/progress.h"
#include "sign/diagnosis/boundary_polygons.h"

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

}  // namespace

void Rims::make(const Boundary& boundary, ProgressMeter& progress) {
  WorkCheck check(progress, 1 << 16);
  for_each_polygon(boundary, [&](BoundaryPolygon polygon) {
    check.add(static_cast<std::int64_t>(polygon.corners.size()));
    add(std::move(polygon.corners), polygon.weight);
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
