// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/diagnose.h"

#include <algorithm>

#include "geometry/predicates.h"
#include "sign/diagnosis/boundary_polygons.h"
#include "sign/diagnosis/closed.h"
#include "sign/diagnosis/cracks.h"
#include "sign/diagnosis/edge_sides.h"
#include "sign/diagnosis/openness.h"
#include "sign/diagnosis/recommend.h"
#include "sign/diagnosis/solid.h"
#include "sign/diagnosis/winding_range.h"

namespace standoff {
namespace {

bool is_degenerate(const Corners& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  // Rounding moves the normal by less than that.
  if (max_norm(cross(u, v)) > 1e-14 * max_norm(u) * max_norm(v)) return false;
  return normal_direction(t) == Vec3{};
}

void add_triangles(MeshView mesh, MeshReport& found) {
  found.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  found.bounds = bounds(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners corners = mesh.corners(t);
    found.area += length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
    found.degenerate += is_degenerate(corners);
  }
}

void add_orientation(const Orientation& orientation, MeshReport& found) {
  found.duplicate = orientation.repeated;
  found.duplicate_same = orientation.same;
  found.duplicate_opposite = orientation.opposite;
  found.two_sided = orientation.two_sided;
  found.inconsistent_edges = orientation.inconsistent_before;
  found.flipped = orientation.flipped;
  found.left_out = orientation.left_out;
  found.cancelled_parts = orientation.cancelled_parts;
  found.cancelled_share = orientation.cancelled_share;
  found.inconsistent_after = orientation.inconsistent_after;
  found.unorientable = orientation.unorientable;
  found.patches = orientation.patches;
  found.boundary_edges = orientation.boundary_edges;
  found.nesting_known = orientation.nesting_known;
}

// All caps; volumes are relative to the centre of the bounds.
Cap add_boundary(const Boundary& boundary, MeshReport& found) {
  found.boundary_loops = static_cast<std::int64_t>(boundary.loops());
  for (std::size_t n = 0; n < boundary.loops(); ++n) {
    const std::span<const BoundaryEdge> loop = boundary.loop(n);
    found.boundary_length += length_of(loop);
    found.largest_hole = std::max(found.largest_hole, diameter_of(loop));
  }
  Cap caps;
  for_each_polygon(boundary, [&](const BoundaryPolygon& polygon) {
    const Cap cap = cap_of(polygon, found.bounds.center());
    caps.area += cap.area;
    caps.volume += cap.volume;
  });
  return caps;
}

PartSums sums_of(const OrientedMesh& mesh, const Vec3& relative_to) {
  PartSums sums;
  for (std::size_t t = 0; t < mesh.mesh.triangles.size(); ++t) {
    if (mesh.use_of(t) == 0) continue;
    const auto [a, b, c] = mesh.corners(t);
    sums.add(a, b, c, relative_to);
  }
  return sums;
}

}  // namespace

Diagnosis diagnose(MeshView mesh, const MeshEdges& edges, ProgressMeter& progress) {
  Diagnosis all;
  MeshReport& found = all.report;
  add_triangles(mesh, found);
  progress.check();
  found.positions = edges.positions();
  for_each_edge(edges, {}, [&](std::span<const EdgeUse> sides) {
    found.open_edges += sides.size() == 1;
    found.nonmanifold_edges += sides.size() > 2;
  });
  progress.check();
  all.orientation = orient(mesh, edges);
  progress.check();
  add_orientation(all.orientation, found);
  const OrientedMesh oriented{mesh, all.orientation.use};
  all.boundary = net_boundary(oriented, edges);
  progress.check();
  const PartSums sums = sums_of(oriented, found.bounds.center());
  const Cap caps = add_boundary(all.boundary, found);
  progress.check();
  found.cap_share = sums.area > 0 ? caps.area / sums.area : 0;
  found.openness = openness_of(oriented, all.boundary);
  progress.check();
  found.volume = sums.volume + (is_cracked(found) ? 0 : caps.volume);
  if (found.closed()) {
    const WindingRange range = find_winding_range(oriented, found.bounds);
    found.least_winding = range.least;
    found.most_winding = range.most;
  }
  const bool even = found.unorientable > 0 && is_closed(mesh).unoriented;
  const Cracks cracks = found.closed() ? Cracks() : find_cracks(mesh, edges);
  progress.check();
  const Recommendation fitting = recommend(found, {sums.area, even, cracks});
  found.method = fitting.method;
  found.sure = fitting.sure;
  found.why = fitting.why;
  return all;
}

}  // namespace standoff
