// SPDX-License-Identifier: Apache-2.0
// The inner loops of the CPU backend, and their data. They are compiled once per instruction set (kernels_*.cpp) and
// chosen at run time. All sets give the same bits.
#pragma once

#include <cstdint>

#include "bvh/bvh.h"
#include "field/backend.h"
#include "field/cpu/mesh_memory.h"
#include "field/lattice.h"
#include "geometry/triangle_frame.h"
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

/// A clump is 2x4x2 neighbouring blocks; a brick has sixteen clumps.
inline constexpr int kClumps = kBlocks / kLanes;
constexpr int block_of_clump(int clump, int lane) {
  return block_index(2 * (clump & 1) + (lane & 1), 4 * (clump >> 1 & 1) + (lane >> 1 & 3),
                     2 * (clump >> 2) + (lane >> 3));
}
static_assert(kLanes == 16 && kClumps == 16 && kBlocksX == 4 && kBlocksY == 8 && kBlocksZ == 8);

/// The shared lattice, and coordinates of a brick's samples and blocks relative to its centre, laid out for wide
/// registers.
struct BlockLattice : Lattice {
  std::int64_t bricks[3];
  float inverse_spacing[3];               ///< 1 / spacing, 1 / grid units
  float block_radius;                     ///< half the diagonal of a block, grid units
  float clump_radius;                     ///< half the diagonal of a clump
  float region_slack;                     ///< regions.h
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

/// Boxes of entries: an array per coordinate, with room for a whole register past the last entry.
struct BoxArrays {
  float* low[3];
  float* high[3];
  std::uint32_t* entry;
  std::int64_t count;
};

/// The frames of sixteen triangles (geometry/triangle_frame.h): a register per number, a lane per triangle.
struct alignas(64) FrameLanes {
  /// A Linear in memory: the gradient and the constant.
  struct Line {
    float gx[kLanes], gy[kLanes], gz[kLanes], c[kLanes];
  };
  /// A HalfTriangle in memory.
  struct Half {
    float leg[kLanes], length[kLanes], nx[kLanes], ny[kLanes];
  };
  Line q, y, z;
  Half left, right;
};

/// A cell of a tile has 4x4x4 samples: it is one block wide, kCellBlocks high and deep.
inline constexpr int kCellSide = 4, kCellBlocks = 2, kBlocksOfCell = kCellBlocks * kCellBlocks;
static_assert(kCellSide == kBlockX && kCellSide == kCellBlocks * kBlockY && kCellSide == kCellBlocks * kBlockZ);

/// The frames of sixteen triangles, relative to the brick's centre.
struct FrameGroup {
  FrameLanes frame;
  alignas(64) std::uint32_t index[kLanes];  ///< the triangles
  std::uint32_t is_long;                    ///< bits of the triangles that must be measured by lines
};

/// Groups of a table, 2048 triangles. A thread's table takes 0.9 MiB; most tiles have far fewer candidates. With fewer
/// groups, crowded tiles need more tables, each with its own reference points.
inline constexpr int kTableGroups = 128;

/// A list of candidates, group * 16 + lane, with room for a register more.
struct CandidateList {
  std::uint32_t candidate[(kTableGroups + 1) * kLanes];
  int count;
};

/// Scratch memory: candidates of a tile while its cells are visited. If more candidates than fit, tables follow each
/// other.
struct CandidateTable {
  static constexpr int kGroups = kTableGroups;
  static constexpr int kCornersPerAxis = 3;
  static constexpr int kCorners = kCornersPerAxis * kCornersPerAxis * kCornersPerAxis;

  /// The data that blocks cull by: the box of each candidate, and a point of it. Axis, candidate.
  template <int kCount>
  struct Extents {
    alignas(64) float low[3][kCount];
    alignas(64) float high[3][kCount];
    alignas(64) float point[3][kCount];
  };

  struct Group : FrameGroup {
    alignas(64) float slack[kLanes];  ///< the error of a distance from the frame
    /// A lower bound of the squared distance from each corner of the lattice.
    alignas(64) float corner_distance_sq[kCorners][kLanes];
    Extents<kLanes> extent;
    std::uint32_t lanes;                 ///< bits of the lanes in use
    std::uint32_t has_lines;             ///< bits of the long triangles whose lines were needed
    TriangleLines<float> lines[kLanes];  ///< of these
  };
  Group groups[kGroups];
  int count;  ///< groups in use

  /// A corner of the tile's 2x2x2 cells, x fastest, and the nearest point of the surface that was found for it.
  struct Corner {
    float at[3];
    float point[3];
    float distance_sq;  ///< infinite if no point is known
    float added_sq;     ///< what its squared distance from a sample is raised by, to bound what the sample gets
  };
  Corner corners[kCorners];

  /// A group with candidates of a cell, and their lanes.
  struct Active {
    std::uint16_t group;
    std::uint16_t lanes;
  };
  Active active[kGroups];
  int active_groups;

  CandidateList list;                             ///< the candidates of a cell
  Extents<(kGroups + 1) * kLanes> listed_extent;  ///< of the candidates in the list; room for a register more
  CandidateList block_list[kBlocksOfCell];        ///< the candidates of each block
};

/// A cell with very many candidates, which are small compared with the spacing.
struct CrowdedCell {
  int at[3];                   ///< its first sample in the brick
  const BoxArrays& boxes;      ///< the boxes of its candidates; all entries are triangles
  const float (*points)[3];    ///< a point of each entry, in the coordinates of the boxes and as exact as they are
  const std::uint32_t* index;  ///< the triangle of each entry
  float brick_center[3];       ///< in the coordinates of the boxes
  float extent;                ///< the largest coordinate of a sample there
};

/// Scratch memory: the candidates of a crowded cell that some block keeps. If more than fit, tables follow each other.
struct CrowdedTable {
  static constexpr int kMost = kTableGroups * kLanes;

  std::uint32_t chosen[kMost];  ///< the triangles kept
  int chosen_count;
  FrameGroup groups[kTableGroups];          ///< their frames
  CandidateList block_list[kBlocksOfCell];  ///< the candidates of each block
  /// Squared distances of the cell's samples from the nearest point of the surface so far, by block.
  alignas(64) float least_sq[kBlocksOfCell][kLanes];

  void forget_points() {
    for (auto& block : least_sq)
      for (float& sq : block) sq = __builtin_inff();
  }
};

/// Scratch memory: triangles that are specks from a brick (lattice.h). If more than fit, tables follow each other.
struct SpeckTable {
  static constexpr int kMost = 4096;

  /// Relative to the brick's centre.
  struct Points {
    alignas(64) float at[3][kMost + kLanes];
    alignas(64) std::uint32_t index[kMost + kLanes];  ///< the triangle with the lowest index of those in a place
    int count;
  };
  Points brick, tile;  ///< those that the brick keeps, and those of them that a tile keeps
  alignas(64) std::uint32_t others[kMost + kLanes];  ///< triangles that are no specks
  int others_count;

  /// The specks nearest to the corners of a box around samples.
  struct Nearest {
    float at[8][3];
    float distance_sq[8];

    void forget() {
      for (float& sq : distance_sq) sq = __builtin_inff();
    }
  };
  Nearest nearest;              ///< to the corners of the brick, of all tables so far
  std::uint16_t places[kMost];  ///< one more than the number of a point, by a hash of its coordinates
};

/// The squared distances of one brick while triangles are gathered into it; one per thread.
struct BrickState {
  alignas(64) float distance_sq[kBlocks][kLanes];
  alignas(64) std::uint32_t nearest[kBlocks][kLanes];  ///< kept only if asked for
  std::int64_t samples_examined = 0;
  std::int64_t samples_band = 0;
};

struct Region;

/// Triangles to gather: `count` indices into the mesh's triangles.
struct Candidates {
  MeshMemory mesh;
  const std::uint32_t* refs;
  std::int64_t count;
  const Region* regions = nullptr;  ///< by triangle of the mesh (regions.h), or null
};

/// The samples of a cell: a box around them, and the largest distance of a triangle that matters.
struct CullCell {
  float center[3];
  float half[3];
  float reach;
};

/// Points of the surface. Boxes that are farther from all samples of a cell than one of them are culled; any points
/// will do, but points near the cell's corners cull the most.
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

/// Points per axis of the lattice that halves a cell: two on its faces and one in the middle.
inline constexpr int kLatticeSide = 3;

/// The bricks that eight triangles may reach, low to high on each axis; low > high on some axis if there are none.
inline constexpr int kReachLanes = 8;
struct BrickRanges {
  alignas(32) std::int32_t low[3][kReachLanes];
  alignas(32) std::int32_t high[3][kReachLanes];
};

struct Kernels {
  const char* name;
  // Of two functions, the second one finds the nearest triangles too.
  /// The bricks with samples in the boxes of eight triangles, grown by the thickness or, where there are regions, by
  /// their reaches. Requires less than 2^31 samples on each axis.
  void (*reached_bricks)(const BlockLattice&, const MeshMemory&, const std::uint32_t* triangles, const Region* regions,
                         BrickRanges&);
  /// Bits of those of eight points whose squared distance from the triangle is at most `reach_sq`.
  unsigned (*within)(const TriangleFrame<double>&, const double (&at)[3][kReachLanes], double reach_sq);
  /// Sets all distances to infinity.
  void (*clear)(bool with_nearest, BrickState&);
  /// Lowers the distances of all samples that lie within the thickness of the candidates' boxes.
  void (*gather_band[2])(const BlockLattice&, const Brick&, const Candidates&, BrickState&);
  /// Returns a bit per tile of the brick (x fastest): whether it holds a sample within the thickness. Counts these
  /// samples.
  unsigned (*band_tiles)(const BlockLattice&, const Brick&, BrickState&);
  /// Writes a tile's distances in world units, clamped by the thickness, and its nearest triangles if asked for.
  void (*write_tile)(const BlockLattice&, const BrickState&, int tile, const TileTarget&);

  /// Finds for each point of a lattice, x fastest, the index of the box whose centre is nearest. Requires at least one
  /// box.
  void (*nearest_to_lattice)(const BoxArrays&, const float (&at)[3][kLatticeSide], std::uint32_t* nearest);
  /// Replaces each point by the closest point of its triangle.
  void (*nearest_on_triangles)(TriangleLanes&);
  /// Returns the child of the node whose box's centre is nearest to the point.
  int (*nearest_child)(const BvhNode&, const float* point);
  /// Adds to `kept`, which must have room, the boxes within the cell's reach that may hold a point nearer to some
  /// sample than every reference is.
  void (*cull_boxes)(const BoxArrays&, const CullCell&, const References&, BoxArrays& kept);
  /// The same for the boxes of nodes.
  void (*cull_nodes)(const BvhNode* nodes, std::int64_t count, const CullCell&, const References&, BoxArrays& kept);
  /// Does the same as gather_band for a tile with many candidates, of which each sample needs few: it culls them for
  /// each cell of 4x4x4 samples.
  void (*gather_tile[2])(const BlockLattice&, const Brick&, int tile, const Candidates&, CandidateTable&, BrickState&);
  /// Finds the specks among the candidates, at most SpeckTable::kMost, and lists the others.
  void (*load_specks)(const BlockLattice&, const Brick&, const Candidates&, SpeckTable&);
  /// Lowers the distances of the samples in those tiles of the brick whose bits are set to the distances from the
  /// table's specks.
  void (*gather_specks[2])(const BlockLattice&, unsigned tiles, SpeckTable&, BrickState&);
  /// Culls the boxes of a crowded cell, of nodes and triangles: writes to `kept`, which may be the same memory, those
  /// that some block keeps. `in_entry`: a triangle of each entry; its point bounds the distances of samples from now
  /// on.
  void (*keep_near)(const BlockLattice&, const CrowdedCell&, const std::uint32_t* in_entry, CrowdedTable&,
                    const BrickState&, BoxArrays& kept);
  /// Gathers a crowded cell, as gather_tile() does a tile. The candidates are the cell's boxes; `mesh` lists none.
  void (*gather_crowded[2])(const BlockLattice&, const Brick&, const CrowdedCell&, const Candidates& mesh,
                            CrowdedTable&, BrickState&);

  static const Kernels portable, avx2, avx512;  ///< defined in kernels_<set>.cpp
};

/// The kernels for an instruction set; the best set for Simd::automatic. Throws Error{usage} if the processor lacks the
/// set.
const Kernels& kernels_for(Simd simd);

}  // namespace standoff::cpu
