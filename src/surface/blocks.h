// SPDX-License-Identifier: Apache-2.0
// The samples of a field that are inside, one bit each; and the cells that a surface passes through, in blocks of
// 8x8x8, with the numbers of its vertices.
//
// A cell, and an edge of the grid, belong to the block of their lowest sample. Blocks coincide with tiles, but begin
// with number -1 along each axis: the surface is closed where the solid reaches the grid's border, and the cells there
// have their lowest sample before the first sample of the grid.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/memory.h"
#include "core/progress.h"
#include "standoff/field.h"

namespace standoff {

/// The bits of a tile: bit x + 8 y of word z is set if the sample is inside.
using TileBits = std::array<std::uint64_t, 8>;

/// Samples below the level are inside. A sample of exactly the level is outside, and so is everything beyond the grid.
class InsideBits {
 public:
  /// Requires |level| < field.thickness(). Runs on the threads of the calling TBB arena. Throws Error{input} if a value
  /// is not a number, and Error{interrupted}. The field outlives this.
  InsideBits(const DistanceField& field, double level, ProgressMeter& progress);

  /// The bytes of an InsideBits.
  static std::size_t bytes_for(const DistanceField& field);

  const DistanceField& field() const { return *field_; }
  const Size3& tiles() const { return tiles_; }

  /// The bits of a tile; zero beyond the grid.
  TileBits of(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;

  static constexpr std::uint8_t kHasOutside = 1, kHasInside = 2;
  /// The kinds of the tiles().x tiles of a row: whether they have samples inside and outside. A row beyond the grid is
  /// outside.
  const std::uint8_t* kinds_of_row(std::int64_t ty, std::int64_t tz) const;

 private:
  bool is_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return tx >= 0 && ty >= 0 && tz >= 0 && tx < tiles_.x && ty < tiles_.y && tz < tiles_.z;
  }
  TileBits samples_of_grid(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;

  const DistanceField* field_;
  Size3 tiles_;
  std::vector<TileBits> bits_;       // by slot
  std::vector<std::uint8_t> kinds_;  // by tile of the grid
  std::vector<std::uint8_t> outside_;
};

/// The bits of all corners of a block's cells. Word n of layer z has bit x + 8 y for the sample at
/// (x + (n & 1), y + (n >> 1), z).
struct CornerBits {
  std::array<std::array<std::uint64_t, 4>, 9> layers;

  /// The corners of a cell that are inside; bit x + 8 y.
  std::uint32_t corners(int bit, int z) const {
    std::uint32_t inside = 0;
    for (std::uint32_t n = 0; n < 8; ++n)
      inside |= static_cast<std::uint32_t>(layers[static_cast<std::size_t>(z) + n / 4][n % 4] >> bit & 1) << n;
    return inside;
  }
};

/// The same as std::popcount(), which is a slow call of a library function unless the compiler may use the instruction.
constexpr int bit_count(std::uint64_t bits) {
  bits -= bits >> 1 & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
  bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return static_cast<int>(bits * 0x0101010101010101u >> 56);
}

struct Block {
  std::array<std::int32_t, 3> at;                           ///< its first sample is 8 * at
  std::uint32_t first_vertex = 0;                           ///< the number of the vertex of its first crossed edge
  std::uint32_t first_cell = 0;                             ///< the number of its first cell
  std::array<std::array<std::uint64_t, 8>, 3> edges{};      ///< by axis and layer: edges with one end inside
  std::array<std::array<std::uint16_t, 8>, 3> edge_rank{};  ///< the number of edges before this axis and layer
  std::array<std::uint64_t, 8> cells{};                     ///< by layer: cells that the surface passes through
  std::array<std::uint16_t, 8> cell_rank{};
  std::uint16_t edge_count = 0, cell_count = 0;

  /// The number of the vertex on a crossed edge of this block, from 0 to 7 along each axis.
  std::uint32_t vertex(int axis, int x, int y, int z) const {
    const auto a = static_cast<std::size_t>(axis), l = static_cast<std::size_t>(z);
    return first_vertex + edge_rank[a][l] + below(edges[a][l], x + 8 * y);
  }
  std::uint32_t cell(int x, int y, int z) const {
    const auto l = static_cast<std::size_t>(z);
    return first_cell + cell_rank[l] + below(cells[l], x + 8 * y);
  }

 private:
  static std::uint32_t below(std::uint64_t bits, int bit) {
    return static_cast<std::uint32_t>(bit_count(bits & ((std::uint64_t{1} << bit) - 1)));
  }
};

class Blocks {
 public:
  /// Finds all blocks with a cell that the surface passes through, x fastest. `inside` outlives this. Runs on the
  /// threads of the calling TBB arena. Throws Error{limit}, Error{interrupted}.
  Blocks(const InsideBits& inside, MemoryShare& memory, ProgressMeter& progress);

  std::span<Block> all() { return blocks_; }
  std::span<const Block> all() const { return blocks_; }
  const DistanceField& field() const { return inside_->field(); }
  CornerBits corner_bits(const Block& block) const { return corner_bits(block.at[0], block.at[1], block.at[2]); }
  /// The block at a place; nullptr if the surface does not pass through it.
  const Block* find(std::int64_t x, std::int64_t y, std::int64_t z) const;
  /// The block itself and its neighbours: number n is at block.at + step * (n & 1, n >> 1 & 1, n >> 2 & 1), where
  /// `step` is 1 or -1.
  std::array<const Block*, 8> beside(const Block& block, int step) const;
  std::size_t number_of(const Block& block) const { return static_cast<std::size_t>(&block - blocks_.data()); }

 private:
  CornerBits corner_bits(std::int64_t x, std::int64_t y, std::int64_t z) const;
  template <class Use>
  void for_each_of_row(std::int64_t row, const Use& use) const;

  const InsideBits* inside_;
  Size3 count_;  // the number of blocks along each axis
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> first_of_row_;
};

/// Calls use(x + 8 y) for each bit that is set.
template <class Use>
void for_each_bit(std::uint64_t bits, const Use& use) {
  for (; bits != 0; bits &= bits - 1) use(std::countr_zero(bits));
}

}  // namespace standoff
