// SPDX-License-Identifier: Apache-2.0
// Fields of meshes of which a part moves: only what can change is computed again (docs/update.md).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "standoff/compute.h"
#include "standoff/export.h"
#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// What an update did.
struct UpdateReport {
  bool anew = false;                   ///< the whole field was computed, as compute() does
  std::string why;                     ///< one sentence: why it was; empty otherwise
  std::int64_t triangles_changed = 0;  ///< triangles with other corners than before
  std::int64_t windows = 0;            ///< parts of the grid that were computed, in whole bricks of 16x16x16 samples
  std::int64_t tiles_computed = 0;     ///< tiles in these windows that could change; all tiles where anew
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

/// A field that follows its mesh, whose vertices move again and again. It has the bits that compute() gives for the
/// mesh as it is:
///
///     LiveField live(mesh, grid, thickness, options);
///     live.move(vertices, positions);
///     float value = live.field().value(10, 20, 30);
///
/// What updates have in common is kept, so that one takes the time of what changes, however large the mesh is: a
/// hierarchy of boxes over the triangles, where the grid's rows cross them, and sums that decide the sign. Where all
/// must be computed anew, it is (UpdateReport::why).
///
/// Takes some 90 bytes a triangle besides the field where triangles share vertices, else more; the memory limit counts
/// them. One call at a time.
class STANDOFF_API LiveField {
 public:
  /// Copies the mesh, computes the field, and prepares updates. Errors: as compute(); the limit counts what is kept.
  LiveField(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options = {});
  LiveField(LiveField&&) noexcept;
  LiveField& operator=(LiveField&&) noexcept;
  ~LiveField();

  /// Moves vertices, vertices[n] to positions[n], world units, and updates the field. Of a vertex that is named more
  /// than once the last position counts. Errors: usage (a vertex that the mesh does not have, other numbers of vertices
  /// and positions); else as compute() of the mesh as it would be. After an error the mesh and the field are as before;
  /// the next call may take as long as the constructor.
  UpdateReport move(std::span<const std::uint32_t> vertices, std::span<const Vec3> positions);

  /// The mesh as it is now; valid until the next call of move().
  MeshView mesh() const;
  /// The field of the mesh as it is now; valid until the next call of move(). The first call after the mesh moved takes
  /// a pass over the mesh for the provenance's hash, unless ComputeOptions::hash_mesh is off. Errors: as compute(),
  /// where the field was lost in an update that failed.
  const DistanceField& field();
  /// Of the constructor's computation.
  const ComputeReport& report() const;

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace standoff
