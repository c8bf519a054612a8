// Which triangles each tile has to look at when the thickness is large or infinite: candidates handed down from coarse
// cells to fine ones, and culled on the way (docs/tiles.md).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "cpu/kernels.h"
#include "cpu/lattice.h"
#include "field/backend.h"

namespace difi::cpu {

/// The candidates of a brick: those of tile n are triangles[ends[n - 1]] to triangles[ends[n] - 1], mesh indices.
struct BrickCandidates {
  std::span<const std::uint32_t> triangles;
  std::int64_t ends[kBrickTiles];

  std::span<const std::uint32_t> of_tile(int tile) const {
    const std::int64_t begin = tile == 0 ? 0 : ends[tile - 1];
    return triangles.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(ends[tile] - begin));
  }
};

/// Calls use(brick, candidates) for every brick that may hold samples within the thickness, from many threads. A tile's
/// candidates are at least all triangles that are nearest to some sample of it within the thickness.
void for_each_brick_by_descent(const Job& job, const Lattice& lattice, const Kernels& kernels,
                               const std::function<void(std::int64_t, const BrickCandidates&)>& use);

/// Bytes that for_each_brick_by_descent may hold, its lists of candidates counted once for each triangle.
std::int64_t descent_scratch_bytes(std::int64_t triangles);

}  // namespace difi::cpu
