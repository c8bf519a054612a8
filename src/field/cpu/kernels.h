// SPDX-License-Identifier: Apache-2.0
// What the inner loops of the CPU backend take, and a table of them. They are compiled once per instruction set
// (kernels_*.cpp) and chosen at run time. All sets give the same bits.
#pragma once

#include <cstdint>

#include "bvh/bvh.h"
#include "field/backend.h"
#include "field/cpu/mesh_memory.h"
#include "field/lattice.h"
#include "standoff/compute.h"

namespace standoff::cpu {

// The samples: bricks of 16x16x16 samples, in blocks of 4x2x2, one block per wide register.

inline constexpr int kBrickTiles = 8;
inline constexpr int kLanes = Boxes16::kLanes;
inline constexpr int kBlockX = 4, kBlockY = 2, kBlockZ = 2;
inline constexpr int kBlocksX = kBrickSide / kBlockX, kBlocksY = kBrickSide / kBlockY, kBlocksZ = kBrickSide / kBlockZ;
inline constexpr int kBlocks = kBlocksX * kBlocksY * kBlocksZ;

/// Block (bx,by,bz) of a brick; x fastest.
constexpr int block_index(int bx, int by, int bz) { return bx + kBlocksX * (by + kBlocksY * bz); }

/// Sixteen blocks that lie together, 2x4x2 of them, and sixteen such clumps to a brick.
inline constexpr int kClumps = kBlocks / kLanes;
constexpr int block_of_clump(int clump, int lane) {
  return block_index(2 * (clump & 1) + (lane & 1), 4 * (clump >> 1 & 1) + (lane >> 1 & 3),
                     2 * (clump >> 2) + (lane >> 3));
}
static_assert(kLanes == 16 && kClumps == 16 && kBlocksX == 4 && kBlocksY == 8 && kBlocksZ == 8);

/// The shared lattice, and what wide registers load: coordinates of a brick's samples and blocks relative to its
/// centre.
struct BlockLattice : Lattice {
  std::int64_t bricks[3];
  float inverse_spacing[3];               ///< 1 / grid units
  float block_radius;                     ///< half the diagonal of a block, grid units
  float clump_radius;                     ///< of a clump
  alignas(64) float x[kBlocksX][kLanes];  ///< sample coordinates, by block column
  alignas(64) float y[kBlocksY][kLanes];
  alignas(64) float z[kBlocksZ][kLanes];
  alignas(64) float clump_centers[3][kClumps];
  alignas(64) float block_centers[kClumps][3][kLanes];

  std::int64_t brick_count() const { return bricks[0] * bricks[1] * bricks[2]; }
};

/// Requires a valid grid and a positive thickness.
BlockLattice make_block_lattice(const Grid& grid, double thickness);

/// A brick and its centre, grid units.
struct Brick {
  std::int64_t at[3];
  double center[4];  // the fourth is zero: loaded as one wide register
};

Brick brick_at(const BlockLattice& lattice, std::int64_t index);

// Boxes of triangles and of nodes of them, as the culling kernels read and write them.

/// Boxes of entries, an array per coordinate with room for a whole register past the last.
struct BoxArrays {
  float* low[3];
  float* high[3];
  std::uint32_t* entry;
  std::int64_t count;
};

// The frames of sixteen triangles in memory: a register for each number of TriangleFrame (geometry/triangle_frame.h),
// lane n of which belongs to triangle n.

struct alignas(64) FrameLanes {
  /// Linear: the gradient and the constant.
  struct Line {
    float gx[kLanes], gy[kLanes], gz[kLanes], c[kLanes];
  };
  /// HalfTriangle.
  struct Half {
    float leg[kLanes], length[kLanes], nx[kLanes], ny[kLanes];
  };
  Line q, y, z;
  Half left, right;
};

// Scratch memory for the candidates of a tile while its cells are visited.

/// Cells of 4x4x4 samples: one block wide, kCellBlocks high and deep.
inline constexpr int kCellSide = 4, kCellBlocks = 2, kBlocksOfCell = kCellBlocks * kCellBlocks;
static_assert(kCellSide == kBlockX && kCellSide == kCellBlocks * kBlockY && kCellSide == kCellBlocks * kBlockZ);

/// Sixteen triangles set up, relative to the brick's centre.
struct FrameGroup {
  FrameLanes frame;
  alignas(64) std::uint32_t index[kLanes];  ///< in the mesh
  std::uint32_t is_long;                    ///< bits of the lanes whose samples need lines
};

/// Groups that are looked at together, 2048 triangles. A thread's table of them takes 0.6 MiB; most tiles have far
/// fewer candidates. With fewer groups, tiles with more candidates go on in more parts, each with reference points of
/// its own.
inline constexpr int kTableGroups = 128;

/// Candidates one by one: group * 16 + lane; room for a register more.
struct CandidateList {
  std::uint32_t candidate[(kTableGroups + 1) * kLanes];
  int count;
};

/// Some candidates of one tile. More candidates than fit come one table after the other.
struct CandidateTable {
  static constexpr int kGroups = kTableGroups;
  static constexpr int kCornersPerAxis = 3;
  static constexpr int kCorners = kCornersPerAxis * kCornersPerAxis * kCornersPerAxis;

  /// What blocks choose by: the box of each candidate, and a point of it. Axis, candidate.
  template <int kCount>
  struct Extents {
    alignas(64) float low[3][kCount];
    alignas(64) float high[3][kCount];
    alignas(64) float point[3][kCount];
  };

  struct Group : FrameGroup {
    alignas(64) float slack[kLanes];  ///< what a distance from the frame may be off by
    /// What the squared distance from each corner of the lattice is at least.
    alignas(64) float corner_distance_sq[kCorners][kLanes];
    Extents<kLanes> extent;
    std::uint32_t lanes;  ///< bits of the lanes in use
  };
  Group groups[kGroups];
  int count;  ///< groups in use

  /// The lattice of the tile's 2x2x2 cells, x fastest, and near each corner the nearest point of the surface found.
  struct Corner {
    float at[3];
    float point[3];
    float distance_sq;  ///< infinite while none was found
    float slack;        ///< how far from the surface the point may be
  };
  Corner corners[kCorners];

  /// The groups a cell has to look at, and the lanes of each.
  struct Active {
    std::uint16_t group;
    std::uint16_t lanes;
  };
  Active active[kGroups];
  int active_groups;

  CandidateList list;                             ///< those of a cell
  Extents<(kGroups + 1) * kLanes> listed_extent;  ///< of the candidates in the list; room for a register more
  CandidateList block_list[kBlocksOfCell];        ///< those that a block has to look at
};

// The candidates of a cell among triangles that are small against the spacing, and scratch memory for those it keeps.

struct CrowdedCell {
  int at[3];                   ///< its first sample in the brick
  const BoxArrays& boxes;      ///< of its candidates; all entries are triangles
  const float (*points)[3];    ///< a point of each entry, in the coordinates of the boxes and as exact as they are
  const std::uint32_t* index;  ///< in the mesh, of each entry
  float brick_center[3];       ///< in the coordinates of the boxes
  float extent;                ///< no sample has larger coordinates there
};

/// Those candidates of a cell that some of its blocks chose. More boxes than fit come one table after the other.
struct CrowdedTable {
  static constexpr int kMost = kTableGroups * kLanes;

  std::uint32_t chosen[kMost];  ///< mesh indices
  int chosen_count;
  FrameGroup groups[kTableGroups];          ///< the same set up
  CandidateList block_list[kBlocksOfCell];  ///< of those, the ones that a block has to look at
};

// The kernels, and what each of them is told.

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
  /// The position in the node of the box whose centre is nearest to the point.
  int (*nearest_child)(const BvhNode&, const float* point);
  /// Adds to `kept`, which has the room, the boxes within the cell's reach that may hold a point nearer to some of its
  /// samples than each of the references is.
  void (*cull_boxes)(const BoxArrays&, const CullCell&, const References&, BoxArrays& kept);
  /// The same for the boxes of nodes.
  void (*cull_nodes)(const BvhNode* nodes, std::int64_t count, const CullCell&, const References&, BoxArrays& kept);
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
