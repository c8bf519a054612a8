// SPDX-License-Identifier: Apache-2.0
#include "standoff/mesh_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/threads.h"
#include "geometry/coplanar.h"
#include "sign/boundary.h"
#include "sign/closed.h"
#include "sign/components.h"
#include "sign/edge_sides.h"
#include "sign/nesting.h"
#include "sign/orient.h"
#include "sign/recommend.h"
#include "sign/self_intersections.h"
#include "sign/winding_range.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// Within it volumes and their moments are finite, and predicates exact.
constexpr double kMostCoordinate = 1e60;

void check(const MeshReportOptions& options) {
  validate("report", options.execution, Runs::on_the_cpu);
  if (!(options.spacing >= 0) || !std::isfinite(options.spacing))
    throw Error(ErrorCode::usage, "report: the spacing must be a finite number, and not negative");
  if (options.most_components < 0 || options.most_intersections < 0 || options.most_intersection_tests < 0)
    throw Error(ErrorCode::usage, "report: a limit is negative");
}

bool is_degenerate(const Corners& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  // Rounding moves the normal by less than that.
  if (max_norm(cross(u, v)) > 1e-14 * max_norm(u) * max_norm(v)) return false;
  return normal_direction(t) == Vec3{};
}

void add_triangles(MeshView mesh, MeshReport& found) {
  found.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners corners = mesh.corners(t);
    for (const Vec3& corner : corners) found.bounds.include(corner);
    found.area += length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
    found.degenerate += is_degenerate(corners);
  }
  if (!(std::max(max_norm(found.bounds.min), max_norm(found.bounds.max)) <= kMostCoordinate))
    throw Error(ErrorCode::limit,
                "report: a coordinate is larger than 1e60, and volumes are no numbers there; scale the mesh");
}

void add_orientation(const Orientation& orientation, MeshReport& found) {
  found.duplicate_same = orientation.same;
  found.duplicate_opposite = orientation.opposite;
  found.two_sided = orientation.two_sided;
  found.inconsistent_edges = orientation.inconsistent_before;
  found.flipped = orientation.flipped;
  found.left_out = orientation.left_out;
  found.inconsistent_after = orientation.inconsistent_after;
  found.unorientable = orientation.unorientable;
  found.patches = orientation.patches;
  found.boundary_edges = orientation.boundary_edges;
  found.nesting_known = orientation.nesting_known;
}

// Returns the volume of the caps over the boundary, with those of the mesh relative to the centre of the bounds.
struct Caps {
  double area = 0, volume = 0;
};
Caps add_boundary(const Boundary& boundary, const MeshReportOptions& options, MeshReport& found) {
  Caps caps;
  found.boundary_loops = static_cast<std::int64_t>(boundary.loops());
  for (std::size_t n = 0; n < boundary.loops(); ++n) {
    const std::span<const BoundaryEdge> loop = boundary.loop(n);
    found.boundary_length += length_of(loop);
    found.largest_hole = std::max(found.largest_hole, diameter_of(loop));
    caps.area += cap_area(loop);
    caps.volume += cap_volume(loop, found.bounds.center());
  }
  if (options.spacing > 0) found.largest_hole_in_samples = found.largest_hole / options.spacing;
  return caps;
}

void add_components(const OrientedMesh& mesh, const MeshEdges& edges, const MeshReportOptions& options,
                    MeshReport& found) {
  Components components = find_components(mesh, edges);
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

struct Used {
  double area = 0, volume = 0;
};
Used sums_of(const OrientedMesh& mesh, const Vec3& center) {
  Used used;
  for (std::size_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    if (mesh.use_of(t) == 0) continue;
    const auto [a, b, c] = mesh.corners(t);
    const Vec3 normal = cross(b - a, c - a) * 0.5;
    used.area += length(normal);
    used.volume += dot(a - center, normal) / 3;
  }
  return used;
}

MeshReport examine(MeshView mesh, const MeshReportOptions& options) {
  MeshReport found;
  add_triangles(mesh, found);
  const MeshEdges edges(mesh);
  found.positions = edges.positions();
  for_each_edge(edges, {}, [&](std::span<const EdgeUse> sides) { found.nonmanifold_edges += sides.size() > 2; });
  const Orientation orientation = orient(mesh, edges);
  add_orientation(orientation, found);
  const OrientedMesh oriented{mesh, orientation.use};
  const Used used = sums_of(oriented, found.bounds.center());
  const Caps caps = add_boundary(net_boundary(oriented, edges), options, found);
  found.volume = used.volume + caps.volume;
  found.cap_share = used.area > 0 ? caps.area / used.area : 0;
  add_components(oriented, edges, options, found);
  if (found.closed()) {
    const WindingRange range = find_winding_range(oriented, found.bounds);
    found.least_winding = range.least;
    found.most_winding = range.most;
  }
  if (options.most_intersections > 0) {
    const SelfIntersections crossing =
        find_self_intersections(mesh, edges, options.most_intersections, options.most_intersection_tests);
    found.intersecting_pairs = crossing.pairs;
    found.intersections_known = crossing.complete;
  }
  const bool even = found.unorientable > 0 && is_closed(mesh).unoriented;
  const Recommendation fitting = recommend(found, used.area, even);
  found.method = fitting.method;
  found.sure = fitting.sure;
  found.why = fitting.why;
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
  return Threads(options.execution.threads).run([&] { return examine(mesh, options); });
} catch (...) {
  throw_as_error("report");
}

}  // namespace standoff
