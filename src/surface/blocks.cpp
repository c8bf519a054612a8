// SPDX-License-Identifier: Apache-2.0
#include "surface/blocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace standoff {
namespace {

constexpr std::uint64_t kFirstColumn = 0x0101010101010101u;

// The samples one further along x; `next` is the tile there.
std::uint64_t along_x(std::uint64_t bits, std::uint64_t next) {
  return (bits >> 1 & ~(kFirstColumn << 7)) | (next & kFirstColumn) << 7;
}
std::uint64_t along_y(std::uint64_t bits, std::uint64_t next) { return bits >> 8 | next << 56; }

// The cells of a layer that have corners inside and corners outside.
std::uint64_t crossed_cells(const CornerBits& corners, std::size_t z) {
  std::uint64_t any = 0, all = ~std::uint64_t{0};
  for (const std::size_t layer : {z, z + 1})
    for (const std::uint64_t word : corners.layers[layer]) {
      any |= word;
      all &= word;
    }
  return any & ~all;
}

bool is_crossed(const CornerBits& corners) {
  std::uint64_t cells = 0;
  for (std::size_t z = 0; z < 8; ++z) cells |= crossed_cells(corners, z);
  return cells != 0;
}

void fill(Block& block, const CornerBits& corners) {
  for (std::size_t z = 0; z < 8; ++z) {
    const auto& here = corners.layers[z];
    block.edges[0][z] = here[0] ^ here[1];
    block.edges[1][z] = here[0] ^ here[2];
    block.edges[2][z] = here[0] ^ corners.layers[z + 1][0];
    block.cells[z] = crossed_cells(corners, z);
    block.cell_rank[z] = block.cell_count;
    block.cell_count = static_cast<std::uint16_t>(block.cell_count + bit_count(block.cells[z]));
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t z = 0; z < 8; ++z) {
      block.edge_rank[axis][z] = block.edge_count;
      block.edge_count = static_cast<std::uint16_t>(block.edge_count + bit_count(block.edges[axis][z]));
    }
}

}  // namespace

Blocks::Blocks(const InsideBits& inside, MemoryShare& memory, ProgressMeter& progress)
    : inside_(&inside), count_{inside.tiles().x + 1, inside.tiles().y + 1, inside.tiles().z + 1} {
  const std::int64_t rows = count_.y * count_.z;
  memory.take((static_cast<std::size_t>(rows) + 1) * sizeof first_of_row_[0]);
  first_of_row_.resize(static_cast<std::size_t>(rows) + 1);
  tbb::parallel_for(std::int64_t{0}, rows, [&](std::int64_t row) {
    progress.advance();
    std::uint32_t found = 0;
    for_each_of_row(row, [&](std::int64_t, const CornerBits&) { ++found; });
    first_of_row_[static_cast<std::size_t>(row) + 1] = found;
  });
  for (std::size_t n = 1; n < first_of_row_.size(); ++n) first_of_row_[n] += first_of_row_[n - 1];
  memory.take(first_of_row_.back() * sizeof(Block));
  blocks_.resize(first_of_row_.back());
  tbb::parallel_for(std::int64_t{0}, rows, [&](std::int64_t row) {
    std::size_t n = first_of_row_[static_cast<std::size_t>(row)];
    if (n == first_of_row_[static_cast<std::size_t>(row) + 1]) return;
    for_each_of_row(row, [&](std::int64_t x, const CornerBits& corners) {
      Block& block = blocks_[n++];
      block.at = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(row % count_.y - 1),
                  static_cast<std::int32_t>(row / count_.y - 1)};
      fill(block, corners);
    });
  });
}

CornerBits Blocks::corner_bits(std::int64_t x, std::int64_t y, std::int64_t z) const {
  std::array<TileBits, 8> tile;
  for (std::size_t n = 0; n < 8; ++n)
    tile[n] = inside_->of(x + std::int64_t(n & 1), y + std::int64_t(n >> 1 & 1), z + std::int64_t(n >> 2));
  CornerBits corners;
  for (std::size_t layer = 0; layer < 9; ++layer) {
    const std::size_t first = layer < 8 ? 0 : 4;
    const auto of = [&](std::size_t n) { return tile[first + n][layer % 8]; };
    const std::uint64_t here = of(0), next_x = along_x(here, of(1));
    corners.layers[layer] = {here, next_x, along_y(here, of(2)), along_y(next_x, along_x(of(2), of(3)))};
  }
  return corners;
}

// Calls use(x, corners) for each block of a row that the surface passes through.
template <class Use>
void Blocks::for_each_of_row(std::int64_t row, const Use& use) const {
  const std::int64_t y = row % count_.y - 1, z = row / count_.y - 1;
  const std::array rows{inside_->kinds_of_row(y, z), inside_->kinds_of_row(y + 1, z), inside_->kinds_of_row(y, z + 1),
                        inside_->kinds_of_row(y + 1, z + 1)};
  constexpr std::uint8_t kBoth = InsideBits::kHasInside | InsideBits::kHasOutside;
  std::uint8_t last = InsideBits::kHasOutside;  // before the first tile
  for (std::int64_t x = -1; x + 1 < count_.x; ++x) {
    std::uint8_t next = InsideBits::kHasOutside;
    if (x + 2 < count_.x) {
      next = 0;
      for (const std::uint8_t* kinds : rows) next = static_cast<std::uint8_t>(next | kinds[x + 1]);
    }
    if ((std::exchange(last, next) | next) != kBoth) continue;
    const CornerBits corners = corner_bits(x, y, z);
    if (is_crossed(corners)) use(x, corners);
  }
}

const Block* Blocks::find(std::int64_t x, std::int64_t y, std::int64_t z) const {
  if (y < -1 || z < -1 || y + 1 >= count_.y || z + 1 >= count_.z) return nullptr;
  const auto row = static_cast<std::size_t>(y + 1 + count_.y * (z + 1));
  const auto begin = blocks_.begin() + first_of_row_[row], end = blocks_.begin() + first_of_row_[row + 1];
  const auto found =
      std::lower_bound(begin, end, x, [](const Block& block, std::int64_t at) { return block.at[0] < at; });
  return found != end && found->at[0] == x ? &*found : nullptr;
}

std::array<const Block*, 8> Blocks::beside(const Block& block, int step) const {
  std::array<const Block*, 8> found;
  for (std::size_t n = 0; n < 8; ++n) {
    const auto along = [&](std::size_t axis) { return block.at[axis] + step * std::int64_t(n >> axis & 1); };
    found[n] = n == 0 ? &block : find(along(0), along(1), along(2));
  }
  return found;
}

}  // namespace standoff
