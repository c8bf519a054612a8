// SPDX-License-Identifier: Apache-2.0
// A triangle and a point o span a tetrahedron of signed volume v = det(a, b, c) / 6, corners relative to o. Over it,
// the integral of x is v s / 4 and that of x x^T is v (a a^T + b b^T + c c^T + s s^T) / 20, where s = a + b + c (Tonon,
// Explicit exact formulas for the 3-D tetrahedron inertia tensor, 2004). Over a closed surface the tetrahedra add up to
// the body, wherever o is.
#include "sign/diagnosis/components.h"

#include <cstdlib>
#include <limits>

#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/edge_sides.h"
#include "sign/diagnosis/solid.h"

namespace standoff {
namespace {

// Integrals relative to the centre of the bounds.
struct Sums {
  PartSums part;
  Vec3 surface_centroid, first;       // of area * x, of x
  std::array<double, 6> second = {};  // of x x^T: xx, yy, zz, xy, yz, zx

  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double area_before = part.area, volume = dot(a, cross(b, c)) / 6;
    part.add(a, b, c, {});
    const Vec3 s = a + b + c;
    surface_centroid = surface_centroid + s * ((part.area - area_before) / 3);
    first = first + s * (volume / 4);
    const auto product = [&](double Vec3::*i, double Vec3::*j) {
      return volume / 20 * (a.*i * a.*j + b.*i * b.*j + c.*i * c.*j + s.*i * s.*j);
    };
    second[0] += product(&Vec3::x, &Vec3::x);
    second[1] += product(&Vec3::y, &Vec3::y);
    second[2] += product(&Vec3::z, &Vec3::z);
    second[3] += product(&Vec3::x, &Vec3::y);
    second[4] += product(&Vec3::y, &Vec3::z);
    second[5] += product(&Vec3::z, &Vec3::x);
  }
};

void finish(const Sums& sums, bool unorientable, MeshComponent& component) {
  component.area = sums.part.area;
  component.volume = sums.part.volume;
  component.solid = !unorientable && is_solid(sums.part, component.closed);
  const Vec3 center = component.bounds.center();
  component.centroid = sums.part.area > 0 ? center + sums.surface_centroid * (1 / sums.part.area) : center;
  if (!component.closed || !component.solid) return;
  const Vec3 c = sums.first * (1 / sums.part.volume);  // moves the second moments there: Steiner's theorem
  component.centroid = center + c;
  const double v = sums.part.volume;
  const double xx = sums.second[0] - v * c.x * c.x, yy = sums.second[1] - v * c.y * c.y,
               zz = sums.second[2] - v * c.z * c.z;
  component.inertia = {yy + zz,
                       zz + xx,
                       xx + yy,
                       v * c.x * c.y - sums.second[3],
                       v * c.y * c.z - sums.second[4],
                       v * c.z * c.x - sums.second[5]};
}

}  // namespace

Components find_components(const OrientedMesh& mesh, const MeshEdges& edges) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  const std::size_t triangles = mesh.mesh.triangles.size();
  DisjointSets connected(edges.positions());
  for (std::size_t t = 0; t < triangles; ++t)
    for (const int corner : {1, 2}) connected.join(edges.position(t, 0), edges.position(t, corner));

  Components found;
  found.of.resize(triangles);
  std::vector<std::uint32_t> number(edges.positions(), kNone);
  for (std::size_t t = 0; t < triangles; ++t) {
    std::uint32_t& component = number[connected.find(edges.position(t, 0)).set];
    if (component == kNone) {
      component = static_cast<std::uint32_t>(found.all.size());
      found.all.emplace_back().first_triangle = static_cast<std::uint32_t>(t);
      found.all.back().closed = true;
    }
    found.of[t] = component;
    ++found.all[component].triangles;
    for (const Vec3& corner : mesh.mesh.corners(t)) found.all[component].bounds.include(corner);
  }
  std::vector<std::uint8_t> unorientable(found.all.size());
  for_each_edge(edges, mesh.use, [&](std::span<const EdgeUse> sides) {
    int excess = 0;
    for (const EdgeUse& side : sides) excess += side.forward ? mesh.use_of(side.triangle) : -mesh.use_of(side.triangle);
    if (excess == 0) return;
    const std::uint32_t component = found.of[sides.front().triangle];
    found.all[component].closed = false;
    if (is_manifold(sides) && std::abs(excess) == 2) unorientable[component] = 1;
  });
  std::vector<Sums> sums(found.all.size());
  for (std::size_t t = 0; t < triangles; ++t) {
    if (mesh.use_of(t) == 0) continue;
    const Vec3 center = found.all[found.of[t]].bounds.center();
    const auto [a, b, c] = mesh.corners(t);
    sums[found.of[t]].add(a - center, b - center, c - center);
  }
  for (std::size_t n = 0; n < sums.size(); ++n) finish(sums[n], unorientable[n] != 0, found.all[n]);
  return found;
}

}  // namespace standoff
