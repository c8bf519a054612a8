// SPDX-License-Identifier: Apache-2.0
// The inner loops of the CPU backend, compiled once per instruction set (kernels_*.cpp) and chosen at run time. All
// sets give the same bits.
#pragma once

#include <cstdint>

#include "field/cpu/box_arrays.h"
#include "field/cpu/candidate_table.h"
#include "field/cpu/crowded_cell.h"
#include "field/cpu/lattice.h"
#include "field/cpu/mesh_memory.h"
#include "field/tile_writer.h"
#include "standoff/compute.h"

namespace standoff::cpu {

/// The squared distances of one brick while triangles are gathered into it; one per thread.
struct BrickState {
  alignas(64) float distance_sq[kBlocks][kLanes];
  alignas(64) std::uint32_t nearest[kBlocks][kLanes];  ///< kept only when asked for
  std::int64_t samples_examined = 0;
  std::int64_t samples_band = 0;
};

/// Triangles to gather: `count` indices into the mesh's.
struct Candidates {
  MeshMemory mesh;
  const std::uint32_t* refs;
  std::int64_t count;
};

/// The samples of a cell: a box around them, and how far a triangle may be to matter.
struct CullCell {
  float center[3];
  float half[3];
  float reach;
};

/// Points of the surface, any: what lies farther from all samples of a cell than one of them is left out there. Those
/// nearest to the cell's corners leave out the most.
struct References {
  static constexpr int kMost = 8;
  float at[kMost][3];
  int count = 0;
};

/// Eight triangles and a point beside each, all relative to the same point: corner, axis, lane.
struct TriangleLanes {
  static constexpr int kCount = 8;
  alignas(64) double corner[3][3][kCount];
  alignas(64) double at[3][kCount];
};

/// Points per axis of the lattice that halves a cell: its faces and its middle.
inline constexpr int kLatticeSide = 3;

struct Kernels {
  const char* name;
  /// Forgets all distances.
  void (*clear)(bool with_nearest, BrickState&);
  /// Lowers the distances of all samples that lie within the thickness of the candidates' boxes.
  void (*gather_band)(const BlockLattice&, const Brick&, const Candidates&, bool with_nearest, BrickState&);
  /// A bit per tile of the brick (x fastest) that holds a sample within the thickness; counts these samples.
  unsigned (*band_tiles)(const BlockLattice&, const Brick&, BrickState&);
  /// Writes one tile's distances in world units, clamped by the thickness, and its nearest triangles where asked for.
  void (*write_tile)(const BlockLattice&, const BrickState&, int tile, const TileTarget&);

  /// For each point of a lattice, x fastest, the position in the list of the box whose centre is nearest. Requires one
  /// box at least.
  void (*nearest_to_lattice)(const BoxArrays&, const float (&at)[3][kLatticeSide], std::uint32_t* nearest);
  /// Replaces points by the points of triangles that are nearest to them.
  void (*nearest_on_triangles)(TriangleLanes&);
  /// The position in the pack of the box whose centre is nearest to the point.
  int (*nearest_in_pack)(const PackContents&, const float* point);
  /// Adds to `kept`, which has the room, the boxes within the cell's reach that may hold a point nearer to some of its
  /// samples than each of the references is.
  void (*cull_boxes)(const BoxArrays&, const CullCell&, const References&, BoxArrays& kept);
  /// The same for the boxes of packs.
  void (*cull_packs)(const PackContents* packs, std::int64_t count, const CullCell&, const References&,
                     BoxArrays& kept);
  /// Lowers the distances of a tile's samples, as gather_band, for candidates of which each sample needs few: chooses
  /// them for each cell of 4x4x4 samples.
  void (*gather_tile)(const BlockLattice&, const Brick&, int tile, const Candidates&, bool with_nearest,
                      CandidateTable&, BrickState&);
  /// The same for one cell and the candidates that its boxes stand for; `mesh` lists none.
  void (*gather_crowded)(const BlockLattice&, const Brick&, const CrowdedCell&, const Candidates& mesh,
                         bool with_nearest, CrowdedTable&, BrickState&);
};

/// The kernels for an instruction set; the best one there is for Simd::automatic. Throws Error{usage} where the
/// processor does not have the set.
const Kernels& kernels_for(Simd simd);

}  // namespace standoff::cpu
