// SPDX-License-Identifier: Apache-2.0
// What is known about a mesh before its sign is decided: whether it is closed, what is wrong with it, and which sign
// method fits (docs/diagnosis.md).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/mesh.h"
#include "standoff/progress.h"
#include "standoff/sign.h"

namespace standoff {

/// Triangles that share positions, directly or through others. All figures are those of the oriented mesh
/// (docs/diagnosis.md, "Orientation").
struct MeshComponent {
  std::int64_t triangles = 0;
  std::uint32_t first_triangle = kNoTriangle;  ///< its lowest index
  Box bounds;
  double area = 0;
  /// Negative: a cavity. If the component is open, that of the cones from the centre of its bounds: with `solid`, about
  /// that of the body without its holes.
  double volume = 0;
  /// Of the volume if the component is closed and has one, else of the surface.
  Vec3 centroid;
  /// The inertia tensor of the volume at density 1 about its centroid: xx, yy, zz, xy, yz, zx. Negative for a cavity,
  /// so that those of a body and its cavities add up. 0 if the component is open or has no volume.
  std::array<double, 6> inertia = {};
  bool closed = false;
  bool solid = false;      ///< closed with a volume, or open with holes that are small against it
  std::int32_t depth = 0;  ///< how many other solid components contain it
};

struct MeshReport {
  std::int64_t triangles = 0;
  std::int64_t positions = 0;  ///< distinct ones, of all vertices: they count by position, not by index
  Box bounds;
  double area = 0;  ///< of all triangles

  // As the mesh is. Edges are pairs of positions.
  std::int64_t degenerate = 0;          ///< triangles without area, exactly
  std::int64_t duplicate = 0;           ///< triangles with an earlier copy, in any orientation
  std::int64_t duplicate_same = 0;      ///< triangles with an earlier copy in the same orientation
  std::int64_t duplicate_opposite = 0;  ///< pairs of copies in opposite orientation
  bool two_sided = false;               ///< nearly every face is there twice, once in each orientation
  std::int64_t open_edges = 0;          ///< edges of one triangle
  std::int64_t nonmanifold_edges = 0;   ///< edges of three triangles or more
  std::int64_t inconsistent_edges = 0;  ///< edges of two triangles that run along it in the same direction

  // After orientation.
  std::int64_t flipped = 0;             ///< triangles that are used in the opposite orientation
  std::int64_t left_out = 0;            ///< copies and inner walls that are not used
  std::int64_t cancelled_parts = 0;     ///< components in both orientations without an inside: nothing of them is used
  double cancelled_share = 0;           ///< their part of the area
  std::int64_t inconsistent_after = 0;  ///< of inconsistent_edges: those that no orientation makes consistent
  std::int64_t unorientable = 0;        ///< patches with but one side, like a Moebius strip
  std::int64_t patches = 0;             ///< triangles joined over edges of two triangles
  std::int64_t boundary_edges = 0;      ///< edges whose triangles do not cancel each other
  std::int64_t boundary_loops = 0;      ///< boundary edges connected by positions
  double boundary_length = 0;
  double largest_hole = 0;             ///< diameter of the largest loop, world units; at most sqrt(3) times too small
  double largest_hole_in_samples = 0;  ///< the same in MeshReportOptions::spacing; 0 if that is not given
  double cap_share = 0;  ///< area of cones that close the boundary, as part of the area of the triangles used
  double openness = 0;   ///< 0: a body, 1: a sheet, by the winding numbers beside the surface (docs/diagnosis.md)
  double volume = 0;     ///< with the holes closed by cones (docs/diagnosis.md); cavities are negative

  std::int64_t component_count = 0;
  std::vector<MeshComponent> components;  ///< the largest ones by area, largest first
  std::int32_t deepest = 0;               ///< largest MeshComponent::depth of all components
  bool nesting_known = true;              ///< false: too many components; depths are 0
  /// The winding numbers seen along up to 128 x 128 rows through the mesh; both 0 if the mesh is not closed.
  std::int32_t least_winding = 0, most_winding = 0;

  /// Pairs of triangles that intersect though they share no position. Neighbours that fold onto each other are not
  /// found.
  std::int64_t intersecting_pairs = 0;
  bool intersections_known = false;  ///< false: the search was stopped, by an option; there may be more

  /// Which method of compute() fits; `none` if the mesh has no inside.
  SignMethod method = SignMethod::none;
  bool sure = false;  ///< whether the mesh leaves no doubt what is inside; false for sheets
  std::string why;    ///< one sentence

  /// Whether the triangles in use cancel each other at every edge: the winding number is an integer everywhere.
  bool closed() const { return triangles > 0 && boundary_edges == 0; }
};

struct MeshReportOptions {
  double spacing = 0;                      ///< of the samples that are planned, world units; 0: unknown
  std::int64_t most_components = 100;      ///< that are listed
  std::int64_t most_intersections = 1000;  ///< the search stops soon after it has found so many; 0: no search
  /// Pairs of triangles with overlapping boxes that the search compares at the most, about a second per ten million.
  /// Where very many pairs share a position, finding them counts too (docs/diagnosis.md).
  std::int64_t most_intersection_tests = 10'000'000;
  Execution execution = {};  ///< the backend must be automatic or cpu
  ProgressCallback progress = {};
};

/// Examines a mesh; a mesh without triangles gets an empty report. The result does not depend on the number of threads.
/// Takes up to 200 bytes per triangle, and 150 per boundary edge. Errors: those of validate(mesh) for a mesh with
/// triangles; usage (spacing is negative or not finite, negative limits, execution); limit;
/// interrupted, between the steps of the work, which take up to 0.3 s for a million triangles, and often within the
/// search for intersections.
STANDOFF_API MeshReport report(MeshView mesh, const MeshReportOptions& options = {});

}  // namespace standoff
