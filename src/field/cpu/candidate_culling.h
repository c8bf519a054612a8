// Which triangles each tile has to look at when the thickness is large or infinite: candidates handed down from coarse
// cells to fine ones, and culled on the way (docs/tiles.md).
#pragma once

#include <cstdint>
#include <span>

#include "field/backend.h"
#include "field/cpu/kernels.h"
#include "field/cpu/lattice.h"

namespace standoff::cpu {

/// What is done with the candidates of bricks. Many threads call it, each with one brick after the other.
class CandidateUse {
 public:
  virtual ~CandidateUse() = default;
  virtual void begin_brick() = 0;
  /// A tile of the brick, and at least all triangles (mesh indices) that are nearest to some sample of it within the
  /// thickness; where these are very many, some of them, and the others by further calls.
  virtual void use_tile(const Brick& brick, int tile, std::span<const std::uint32_t> triangles) = 0;
  /// The same for a cell, where the tile would have too many.
  virtual void use_cell(const Brick& brick, const CrowdedCell& cell) = 0;
  virtual void end_brick(const Brick& brick) = 0;
};

/// Tells `use` of every brick that may hold samples within the thickness.
void for_each_brick_by_descent(const Job& job, const BlockLattice& lattice, const Kernels& kernels, CandidateUse& use);

/// Bytes that for_each_brick_by_descent may hold, whatever the triangles.
std::int64_t descent_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads);

}  // namespace standoff::cpu
