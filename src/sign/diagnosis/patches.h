// SPDX-License-Identifier: Apache-2.0
// Patches and pieces: triangles joined over manifold edges, and patches joined over nonmanifold edges, each oriented
// consistently.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/duplicates.h"
#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

/// A patch is a set of triangles joined over edges of exactly two triangles.
struct Patches {
  std::vector<std::uint32_t> of;           ///< the patch of each triangle; numbered by their first triangles
  std::vector<std::int8_t> orientation;    ///< OrientedMesh::use
  std::vector<std::uint8_t> unorientable;  ///< for each patch: whether it has one side only

  std::size_t size() const { return unorientable.size(); }
};

/// Makes neighbours within a patch consistent, and flips the smaller part of it (of parts of equal size, the one
/// without the first triangle). Where that is impossible (a Moebius strip), the patch is left as it is. Triangles of
/// Duplicates::either are free: they do not count there. A triangle that is left out, or has two equal corners, is a
/// patch of its own.
Patches find_patches(const MeshEdges& edges, const Duplicates& duplicates, std::size_t triangles);

/// The number of edges of exactly two triangles in use that run along it in the same direction.
std::int64_t inconsistent_edges(const MeshEdges& edges, std::span<const std::int8_t> use);

/// A piece is oriented as a whole. It is a patch that is closed by itself, as most are, or patches joined over
/// nonmanifold edges at which they have a border. (Two boxes that share an edge are two pieces: each cancels itself
/// there.)
struct Pieces {
  std::vector<std::uint32_t> of;           ///< the piece of each triangle
  std::vector<std::uint8_t> closed;        ///< for each piece: whether it has no boundary
  std::vector<std::uint8_t> unorientable;  ///< for each piece: whether one of its patches is
  std::int64_t walls = 0;                  ///< triangles that are left out, because they are no part of the outer hull

  std::size_t size() const { return closed.size(); }
};

/// Where the borders of a piece do not cancel, orients its patches so that they do: the outer hull faces outwards, and
/// patches that are no part of it are left out of the sign (outer_hulls). A wall between two rooms that is listed once
/// does not separate inside from outside, and three patches meet at its edges. They cancel in neither of its
/// orientations, and leave the same over for several orientations of whole rooms. Such walls would disturb the winding
/// number: beside a wall that faces away it is 1/2 too low, and lower still if more walls behind it do. So all that
/// cannot be reached from outside is inside, even a cavity if a wall joins it to the hull.
///
/// If no hull is a solid whose borders all cancel, the choice is greedy: most edges of a common border of two patches
/// should cancel. The patches are flipped if that leaves less over, and the majority of the triangles stays; else all
/// stay. If some edges are left over then, patches are left out that do not cancel there, the small ones first; but
/// only if all cancels without them, and the rest is a solid and most of the piece: so a hole that is filled twice is
/// filled once. A piece with an unorientable patch stays as it is.
Pieces find_pieces(MeshView mesh, const MeshEdges& edges, Patches& patches);

/// The outer hull of each piece that is `wanted` (outer_hull.cpp). For each patch: 1 if its front is outside and its
/// back is not, -1 the other way round, 0 if both sides are inside (a wall between two rooms) or both outside (a brim
/// around a ball). 0 too for all patches of other pieces, and of pieces whose hull is no solid (is_solid), or has less
/// volume than one of the patches that it leaves out. `piece_of` is the piece of each patch. Requires a finite mesh,
/// and orientable patches in the wanted pieces.
std::vector<std::int8_t> outer_hulls(MeshView mesh, const MeshEdges& edges, const Patches& patches,
                                     std::span<const std::uint32_t> piece_of, std::span<const std::uint8_t> wanted);

}  // namespace standoff
