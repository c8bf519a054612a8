// SPDX-License-Identifier: Apache-2.0
// Which side of a surface is inside (docs/sign.md).
#pragma once

#include <cstdint>
#include <string>

namespace standoff {

/// How the sign of a field is decided. No method but `shell` changes the magnitude of a value; SignOptions::outer may.
enum class SignMethod {
  none,       ///< no sign: all values are positive
  winding,    ///< by the winding number: an exact integer if the mesh is closed, else the generalised winding number
  parity,     ///< by the parity of crossings; the mesh must be closed, its orientation does not matter
  normal,     ///< by the angle-weighted normal of the nearest face, edge or vertex: for terrain and sheets with a front
  flood,      ///< outside is what can be reached from the grid's border between samples that no triangle separates
  shell,      ///< the mesh as a solid of thickness SignOptions::shell: distance - shell / 2
  automatic,  ///< by the diagnosis of the mesh; ComputeReport says which method and why
  // Files of queries hold the numbers of those before.
  facet,  ///< by the plane of the nearest triangle: for comparison (docs/methods.md), wrong beside edges and vertices
};

/// What is said of a method, and where it may be used.
struct SignMethodInfo {
  SignMethod method;
  const char* name;             ///< in options, reports and the provenance of fields
  const char* inside;           ///< what it takes for inside: "by crossings"
  bool at_samples = false;      ///< decides samples without their distances, as occupancy() asks
  bool at_points = false;       ///< decides points without a grid, as MeshQuery asks
  bool by_orientation = false;  ///< looks at the orientation of triangles: SignOptions::as_oriented may be given
};

/// All methods. Checks, messages, help and reports ask this table.
inline constexpr SignMethodInfo kSignMethods[] = {
    {.method = SignMethod::automatic,
     .name = "auto",
     .inside = "what fits the mesh, or nothing if it has no inside",
     .at_samples = true,
     .at_points = true,
     .by_orientation = true},
    {.method = SignMethod::winding,
     .name = "winding",
     .inside = "by crossings",
     .at_samples = true,
     .at_points = true,
     .by_orientation = true},
    {.method = SignMethod::parity, .name = "parity", .inside = "by crossings", .at_samples = true, .at_points = true},
    {.method = SignMethod::normal,
     .name = "normal",
     .inside = "behind the nearest triangle, for terrain",
     .at_points = true,
     .by_orientation = true},
    {.method = SignMethod::facet,
     .name = "facet",
     .inside = "behind the nearest triangle's plane, wrong beside edges",
     .by_orientation = true},
    {.method = SignMethod::flood,
     .name = "flood",
     .inside = "what a flood from outside does not reach",
     .at_samples = true},
    {.method = SignMethod::shell,
     .name = "shell",
     .inside = "the surface as a solid of thickness T",
     .at_points = true},
    {.method = SignMethod::none, .name = "none", .inside = "", .at_points = true},
};

/// The row of a method; nullptr for numbers that are none.
constexpr const SignMethodInfo* find_info(SignMethod method) {
  for (const SignMethodInfo& info : kSignMethods)
    if (info.method == method) return &info;
  return nullptr;
}

/// The name of a method; empty for `none`.
constexpr const char* name_of(SignMethod method) {
  const SignMethodInfo* const info = find_info(method);
  return info && method != SignMethod::none ? info->name : "";
}

/// Which winding numbers are inside, for SignMethod::winding. For open meshes, `positive` is above 1/2 and `nonzero` is
/// above 1/2 in magnitude.
enum class WindingRule {
  positive,  ///< above 0: overlapping solids are united, and a solid turned inside out is a cavity
  nonzero,   ///< not 0: the orientation of a whole solid does not matter
  odd,       ///< odd: a solid inside a solid is a cavity
};

struct SignOptions {
  /// What fits the mesh. A mesh without an inside gets no sign, and the report says why.
  SignMethod method = SignMethod::automatic;
  WindingRule rule = WindingRule::positive;
  bool invert = false;  ///< exchange inside and outside, for example for the scan of a room
  bool strict = false;  ///< Error{doubt} where the sign is not certain
  /// Take the triangles as they are oriented. By default the orientation is repaired first (docs/diagnosis.md).
  bool as_oriented = false;
  /// Leave out triangles with inside on both sides, so that values inside are distances to the surface of the union of
  /// all parts (docs/outer.md). For winding and automatic; the mesh must be closed. Values outside do not change.
  bool outer = false;
  double shell = 0;  ///< SignMethod::shell alone: thickness of the sheet, world units, positive
};

/// How the sign of a field was decided.
struct SignReport {
  SignMethod method = SignMethod::none;  ///< the one that was used; never `automatic`
  std::string why;                       ///< one sentence: why this method, and what was done to the mesh before
  bool sure = true;                      ///< whether the mesh leaves no doubt what is inside
  std::int64_t flipped = 0;              ///< triangles that were taken in the opposite orientation
  std::int64_t left_out = 0;             ///< triangles that were left out: copies of others, inner walls
  std::int64_t boundary_edges = 0;       ///< edges that do not cancel after that: 0 if the mesh is closed
  std::int64_t internal = 0;             ///< with `outer`: triangles with inside on both sides, which were left out
  std::int64_t cut =
      0;  ///< with `outer`: triangles that others divide, kept: inside, distances near them are too small
};

}  // namespace standoff
