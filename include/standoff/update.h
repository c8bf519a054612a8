// SPDX-License-Identifier: Apache-2.0
// Fields of meshes of which a part moves: only what can change is computed again (docs/update.md).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "standoff/compute.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff {

/// What an update did.
struct UpdateReport {
  bool anew = false;                   ///< the whole field was computed, as compute() does
  std::string why;                     ///< one sentence: why it was; empty otherwise
  std::int64_t triangles_changed = 0;  ///< triangles with other corners than before
  std::int64_t windows = 0;            ///< parts of the grid that were computed, in whole bricks of 16x16x16 samples
  std::int64_t tiles_computed = 0;     ///< tiles of the grid in these windows; all tiles where anew
  std::int64_t tiles_changed = 0;      ///< of these, tiles with other samples than before; all tiles where anew
  std::int64_t tiles_stored = 0;       ///< tiles that the field stores now
  SignReport sign;                     ///< how the sign was decided
  struct Seconds {
    double prepare = 0;  ///< checks, hashes, what can change, which triangles reach it
    double compute = 0;  ///< distances; all work of compute() where anew
    double sign = 0;     ///< which samples are inside
    double merge = 0;    ///< into the field
  } seconds;
};

/// The triangles whose corners differ between two meshes, ascending, and those that only one of them has. Corners are
/// compared bit by bit, triangle n with triangle n. Takes a pass over both meshes. Errors: as validate(), of either.
STANDOFF_API std::vector<std::uint32_t> changed_triangles(MeshView before, MeshView after);

/// Makes the field of `before` the field of `after`, with the bits that compute() gives: values, nearest triangles,
/// stored tiles and provenance.
///
///     UpdateReport report = update_field(before, after, changed_triangles(before, after), field, options);
///
/// `changed`: the triangles whose corners differ, in any order, at least; those that only one mesh has count as well.
/// `field`: what compute() made of `before` with these options, of which only `nearest` is not looked at: the field
/// keeps nearest triangles if it has them. Where triangles that changed are missing in the list, the field is wrong.
///
/// Only windows that triangles which changed reach, before or after, and which they may enclose are computed. Where
/// something far away may change too, all is: UpdateReport::why (docs/update.md). The memory limit counts what is taken
/// besides the field.
///
/// Errors: as compute() of `after`; usage for an empty field, for triangles that no mesh has, and where the field's
/// hash shows that the meshes are one, changed in its place, or in the wrong order; input for triangles of `before`
/// that are not valid. After an error the field is unchanged; it may be empty where it was computed anew, or where
/// memory ran out.
STANDOFF_API UpdateReport update_field(MeshView before, MeshView after, std::span<const std::uint32_t> changed,
                                       DistanceField& field, const ComputeOptions& options = {});

}  // namespace standoff
