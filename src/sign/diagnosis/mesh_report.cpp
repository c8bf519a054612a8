// SPDX-License-Identifier: Apache-2.0
#include "standoff/mesh_report.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "core/guarded.h"
#include "core/progress.h"
#include "core/threads.h"
#include "sign/diagnosis/diagnose.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/nesting.h"
#include "sign/diagnosis/self_intersections.h"
#include "sign/oriented_mesh.h"
#include "standoff/error.h"

namespace standoff {

namespace {

// The connected components of an oriented mesh, with their volumes and moments.
//
// A triangle and a point o span a tetrahedron of signed volume v = det(a, b, c) / 6, corners relative to o. The
// integral of x over it is v s / 4, and the integral of x x^T is v (a a^T + b b^T + c c^T + s s^T) / 20, where s = a +
// b + c (Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor, 2004). Over a closed surface the
// tetrahedra add up to the body, wherever o is.

struct Components {
  std::vector<std::uint32_t> of;   // the component of each triangle
  std::vector<MeshComponent> all;  // in the order of their first triangles; depths are 0
};

// Integrals relative to the centre of the bounds.
struct Sums {
  PartSums part;
  Vec3 surface_centroid, first;       // integrals of x over the surface, and over the volume
  std::array<double, 6> second = {};  // integrals of x x^T: xx, yy, zz, xy, yz, zx

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
  const Vec3 c = sums.first * (1 / sums.part.volume);  // the second moments move there, by Steiner's theorem
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

// Requires a mesh oriented by orient(): edges that are inconsistent after that make a component no solid. Triangles
// that are left out belong to components, but add nothing to them but their bounds. Sums are relative to the centre of
// each component's bounds. Takes linear time.
Components find_components(const OrientedMesh& mesh, const MeshEdges& edges) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  const std::size_t triangles = mesh.mesh.triangles.size();
  DisjointSets connected = edges.connected_positions();
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
  for_each_edge(edges, mesh.use, [&](std::span<const HalfEdge> sides) {
    const std::int32_t excess = excess_of(sides, mesh.use);
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

// The report.

// Coordinates up to this have finite volumes and moments, and exact predicates.
constexpr double kMostCoordinate = 1e60;

void check(const MeshReportOptions& options) {
  validate("report", options.execution, Runs::on_the_cpu);
  if (!(options.spacing >= 0) || !std::isfinite(options.spacing))
    throw Error(ErrorCode::usage, "report: the spacing must be a finite number, and not negative");
  if (options.most_components < 0 || options.most_intersections < 0 || options.most_intersection_tests < 0)
    throw Error(ErrorCode::usage, "report: a limit is negative");
}

void add_components(const OrientedMesh& mesh, const MeshEdges& edges, const MeshReportOptions& options,
                    ProgressMeter& progress, MeshReport& found) {
  Components components = find_components(mesh, edges);
  progress.check();
  std::vector<Part> parts;
  for (const MeshComponent& component : components.all) parts.push_back({component.bounds, component.solid});
  const Nesting nesting = find_nesting(mesh, components.of, parts);
  found.nesting_known = found.nesting_known && nesting.known;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    components.all[n].depth = nesting.depth[n];
    found.deepest = std::max(found.deepest, nesting.depth[n]);
  }
  found.component_count = static_cast<std::int64_t>(components.all.size());
  std::ranges::sort(components.all, {}, [](const MeshComponent& c) { return std::pair(-c.area, c.first_triangle); });
  if (found.component_count > options.most_components)
    components.all.resize(static_cast<std::size_t>(options.most_components));
  found.components = std::move(components.all);
}

MeshReport examine(MeshView mesh, const MeshReportOptions& options, ProgressMeter& progress) {
  const Box box = bounds(mesh);
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMostCoordinate))
    throw Error(ErrorCode::limit,
                "report: a coordinate is larger than 1e60, where volumes exceed all numbers; scale the mesh");
  progress.stage("edges", 1, 0, 0.1);
  const MeshEdges edges(mesh, progress);
  progress.stage("diagnosis", 1, 0.1, 0.5);
  Diagnosis diagnosis = diagnose(mesh, edges, progress);
  MeshReport found = std::move(diagnosis.report);
  if (options.spacing > 0) found.largest_hole_in_samples = found.largest_hole / options.spacing;
  progress.stage("components", 1, 0.5, 0.7);
  add_components({mesh, diagnosis.orientation.use}, edges, options, progress, found);
  if (options.most_intersections > 0) {
    const SelfIntersections crossing = find_self_intersections(
        mesh, edges, {options.most_intersections, options.most_intersection_tests, 0.7, 1}, progress);
    found.intersecting_pairs = crossing.pairs;
    found.intersections_known = crossing.complete;
  }
  progress.stage("done", 1, 1, 1);
  return found;
}

}  // namespace

MeshReport report(MeshView mesh, const MeshReportOptions& options) try {
  check(options);
  if (mesh.triangles.empty()) {
    MeshReport empty;
    empty.sure = true;
    empty.why = "there are no triangles";
    return empty;
  }
  validate(mesh);
  ProgressMeter progress(options.progress);
  return Threads(options.execution.threads).run([&] { return examine(mesh, options, progress); });
} catch (...) {
  throw_as_error("report");
}

}  // namespace standoff
