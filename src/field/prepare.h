// SPDX-License-Identifier: Apache-2.0
// The step before the backend: validates the mesh, checks memory and the range of float, applies the skip rule.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "field/plan.h"
#include "geometry/host_device.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/verify.h"

namespace standoff {

/// The reach of a triangle, rounding included: no method finds a triangle within the thickness of a sample if it is
/// farther away than this, in world units. It adds ten times the error of a distance to the thickness. Infinite if the
/// thickness is.
inline double reach_beyond_rounding(const Grid& grid, double thickness) {
  return thickness + 10 * allowed_error(grid, thickness);
}

/// The points whose distances from a grid fit into float: at most 2^60 spacings and 2^125 units from its centre, along
/// each axis.
class FloatRange {
 public:
  explicit FloatRange(const Grid& grid);
  /// False for points that are not finite.
  bool holds(Vec3 p) const {
    const Vec3 d = p - center_;
    return std::abs(d.x) <= farthest_ && std::abs(d.y) <= farthest_ && std::abs(d.z) <= farthest_;
  }

 private:
  Vec3 center_;
  double farthest_;
};

/// Whether the grid's spacings are within the limits of check_domain(): the largest one, and it beside the least.
STANDOFF_HD inline bool is_moderate(double spacing) { return spacing >= 0x1p-110 && spacing <= 0x1p100; }
STANDOFF_HD inline bool is_even(double least, double largest) { return least >= largest / 0x1p60; }
inline bool is_even(Vec3 h) { return is_even(std::min({h.x, h.y, h.z}), std::max({h.x, h.y, h.z})); }
inline bool has_float_spacing(const Grid& grid) { return is_moderate(grid.max_spacing()) && is_even(grid.spacing); }

/// Backends compute squared distances in float, in units of the spacing. Throws Error{limit} if these, or the distances
/// in world units, would not be normal floats: the mesh reaches farther than 2^60 spacings or 2^125 units from the
/// grid's centre, the largest spacing is not within 2^-110 and 2^100, or one spacing is less than 2^-60 of another.
/// Requires a valid mesh and grid.
void check_domain(MeshView mesh, const Grid& grid);
/// The same for the box around a mesh.
void check_domain(const Box& mesh, const Grid& grid);

/// The findings of one pass over a mesh.
struct MeshScan {
  /// Whether FloatRange holds all vertices. If not, the vertices that triangles use may still be near enough.
  bool is_near;
  ReachCounts counts = {};
};

/// Reads the vertices once and the triangles once, in the order of memory. Uses the caller's arena. Throws the errors
/// of validate(mesh).
MeshScan scan_mesh(MeshView mesh, const Plan& plan, bool counts_tiles);

/// Throws as validate(mesh) does; Error{limit} where the computation may need more than the options' limit, with what
/// would fit, and as check_domain(mesh, grid) does. Looks at the mesh once. Uses the caller's arena.
void check_mesh(MeshView mesh, const Plan& plan, const ComputeOptions& options);

/// The triangles of `among` that the plan's skip rule keeps, ascending; empty if it keeps the whole mesh. An empty
/// `among` means all triangles; the rule sees no others. Without a rule, copies of triangles are left out if they are
/// many and the plan says so; this takes no more memory than work on all triangles would. Requires a checked mesh.
/// Throws Error{interrupted}.
std::vector<std::uint32_t> kept_by_plan(MeshView mesh, const Plan& plan, std::span<const std::uint32_t> among,
                                        ProgressMeter& progress);

}  // namespace standoff
