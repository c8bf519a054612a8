// SPDX-License-Identifier: Apache-2.0
// Which patches of a piece lie between the outside and the rest: of rooms that share walls, the outer walls.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/patches.h"
#include "standoff/mesh.h"

namespace standoff {

/// For each patch of a piece that is `wanted`: 1 if its front is outside and its back is not, -1 the other way round, 0
/// if both sides are inside (a wall between two rooms) or both outside (a brim around a ball); and 0 for all patches of
/// other pieces, and of pieces whose hull is no solid (solid.h), or less than one of the patches that it leaves out.
///
/// The patches divide space into cells. A patch has a cell in front of it and one behind; around a nonmanifold edge,
/// two faces next to each other by angle have the cell between them in common, and so all cells follow from the edges
/// (Zhou, Grinspun, Zorin, Jacobson 2016, "Mesh arrangements for solid geometry"). The signed volume of the faces
/// around a cell, turned to look out of it, is its volume; but around the unbounded cell they look inwards, and it is
/// negative. So the outside is where the volume is negative. (A brim around a ball divides the outside into two cells,
/// since a patch's sides are not joined at its free edges: so holes in a hull do not matter.)
///
/// This is exact if the patches of a piece meet at edges only, whatever the shape of the rooms: angles are compared by
/// exact predicates. Where patches pass through each other it is a guess; but at nonmanifold edges the hull always
/// closes, because on the way around one of them one passes into the outside as often as out of it. (Unless faces
/// without an area hide that: then it may not.) If a patch that is nearly closed passes through others at such an edge,
/// the cells on its two sides may be taken for one; then the hull that is found leaves it out, and may be a tiny room
/// beside it.
///
/// `piece_of`: for each patch. Requires a finite mesh, and orientable patches in the wanted pieces.
std::vector<std::int8_t> outer_hulls(MeshView mesh, const MeshEdges& edges, const Patches& patches,
                                     std::span<const std::uint32_t> piece_of, std::span<const std::uint8_t> wanted);

}  // namespace standoff
