// SPDX-License-Identifier: Apache-2.0
// The step before the backend: validates the mesh, checks memory and the range of float, applies the skip rule.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "field/plan.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/verify.h"

namespace standoff {

// How far a triangle reaches, rounding included.

/// No method finds a triangle within the thickness of a sample that is farther from it than this, world units: ten
/// times the error that a distance of the thickness may have. Infinite with the thickness.
inline double reach_beyond_rounding(const Grid& grid, double thickness) {
  return thickness + 10 * allowed_error(grid, thickness);
}

// How far apart mesh and grid may be.

/// The points whose distances from a grid float holds: at most 2^60 spacings and 2^125 units from its centre, along
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

/// Whether the grid's spacings are within what check_domain() asks for.
bool has_float_spacing(const Grid& grid);

/// Backends compute squared distances in float, in units of the spacing. Throws Error{limit} where those, or the
/// distances in world units, would not be normal floats: the mesh reaches farther than 2^60 spacings or 2^125 units
/// from the grid's centre, the largest spacing is not within 2^-110 and 2^100, or one is less than 2^-60 of another.
/// Requires a valid mesh and grid.
void check_domain(MeshView mesh, const Grid& grid);
/// The same of the box around a mesh.
void check_domain(const Box& mesh, const Grid& grid);

/// What one pass over a mesh finds out.
struct MeshLook {
  /// Float holds the distances of all vertices (FloatRange). Where not, those that matter may still be near enough.
  bool is_near;
  /// Tiles that hold samples of some triangle's box grown by the thickness, at most; 0 where they were not counted.
  double tiles;
};

/// Goes over the vertices once and over the triangles once, in memory's order. Uses the caller's arena. Errors: as
/// validate(mesh).
MeshLook look_at(MeshView mesh, const Plan& plan, bool counts_tiles);

/// Throws as validate(mesh) does; Error{limit} where the computation may need more than options.memory_limit, with what
/// would fit, and as check_domain(mesh, grid) does. Looks at the mesh once. Uses the caller's arena.
void check_mesh(MeshView mesh, const Plan& plan, const ComputeOptions& options);

/// Of the triangles in `among`, which are all if it is empty, those that the plan's skip rule keeps, ascending; empty
/// when all of the mesh. The rule sees no others. Where there is no rule, copies of triangles are left out if they are
/// many and the plan says so, and that takes no more memory than all triangles would. Requires a checked mesh. Throws
/// Error{interrupted}.
std::vector<std::uint32_t> kept_by_plan(MeshView mesh, const Plan& plan, std::span<const std::uint32_t> among,
                                        ProgressMeter& progress);

}  // namespace standoff
