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
};

/// The name of a method in options, reports and the provenance of fields; empty for `none`.
constexpr const char* name_of(SignMethod method) {
  switch (method) {
    case SignMethod::none:
      return "";
    case SignMethod::winding:
      return "winding";
    case SignMethod::parity:
      return "parity";
    case SignMethod::normal:
      return "normal";
    case SignMethod::flood:
      return "flood";
    case SignMethod::shell:
      return "shell";
    case SignMethod::automatic:
      return "auto";
  }
  return "";
}

/// Which winding numbers are inside, for SignMethod::winding. For open meshes, `positive` is above 1/2 and `nonzero` is
/// above 1/2 in magnitude.
enum class WindingRule {
  positive,  ///< above 0: overlapping solids are united, and a solid turned inside out is a cavity
  nonzero,   ///< not 0: the orientation of a whole solid does not matter
  odd,       ///< odd: a solid inside a solid is a cavity
};

struct SignOptions {
  SignMethod method = SignMethod::none;
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
