// SPDX-License-Identifier: Apache-2.0
#include "surface/dual_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/threads.h"
#include "surface/cells.h"
#include "surface/each_block.h"
#include "surface/surface_counts.h"

namespace standoff {

DualCells::DualCells(Blocks& blocks, const UniformTiles& uniform, double level, std::uint64_t first_vertex,
                     ProgressMeter& progress)
    : blocks_(&blocks), is_special_(blocks.all().size()), special_(blocks.all().size()), doubled_(blocks.all().size()) {
  std::vector<std::uint16_t> more_loops(blocks.all().size());
  PerThread<SurfaceCounts> counted;
  for_each_block(blocks, uniform, progress,
                 [&](std::size_t n, const Block& block, const CornerBits& corners, const Neighbourhood& values) {
                   std::uint16_t more = 0;
                   for_each_cell(block, corners, values, level,
                                 [&](CellAt at, const CellCase& found, std::uint32_t ambiguous) {
                                   if (found.loop_count == 1 && ambiguous == 0) return;
                                   const CellOf cell{&block, at.x, at.y, at.z};
                                   is_special_[n][static_cast<std::size_t>(at.z)] |= std::uint64_t{1} << cell.bit();
                                   special_[n].push_back({cell.number(), more, &found, ambiguous});
                                   more = static_cast<std::uint16_t>(more + found.loop_count - 1);
                                   counted.local().ambiguous += std::popcount(ambiguous);
                                 });
                   more_loops[n] = more;
                 });
  end_ = first_vertex;
  for (std::size_t n = 0; n < more_loops.size(); ++n) {
    Block& block = blocks.all()[n];
    expect_countable(end_);
    block.first_cell = static_cast<std::uint32_t>(end_);
    end_ += block.cell_count + std::uint64_t{more_loops[n]};
  }
  expect_countable(end_);
  counted.for_each([&](const SurfaceCounts& one) { ambiguous_faces_ += one.ambiguous; });
  ambiguous_faces_ /= 2;
  if (ambiguous_faces_ > 0) find_doubled_faces(progress);
}

std::size_t DualCells::memory_bytes() const {
  std::size_t bytes = is_special_.size() * (sizeof is_special_[0] + sizeof special_[0] + sizeof doubled_[0]);
  for (const auto& cells : special_) bytes += cells.capacity() * sizeof cells[0];
  for (const auto& faces : doubled_) bytes += faces.capacity() * sizeof faces[0];
  return bytes;
}

const SpecialCell* DualCells::special(const CellOf& cell) const {
  const std::size_t n = blocks_->number_of(*cell.block);
  if ((is_special_[n][static_cast<std::size_t>(cell.z)] >> cell.bit() & 1) == 0) return nullptr;
  return &*std::ranges::lower_bound(special_[n], cell.number(), {}, &SpecialCell::cell);
}

std::uint32_t DualCells::vertex_of_loop(const CellOf& cell, const SpecialCell* special, int loop) const {
  if (loop == 0) return cell.block->cell(cell.x, cell.y, cell.z);
  return cell.block->first_cell + cell.block->cell_count + special->first_loop + static_cast<std::uint32_t>(loop - 1);
}

std::uint32_t DualCells::vertex(const CellOf& cell, int edge) const {
  const SpecialCell* const found = special(cell);
  return vertex_of_loop(cell, found, found ? found->found->loop_of[static_cast<std::size_t>(edge)] : 0);
}

int DualCells::find_doubled(const CellOf& lower, int axis) const {
  const auto faces = doubled(*lower.block);
  const auto found = std::ranges::find_if(
      faces, [&](const DoubledFace& face) { return face.cell == lower.number() && face.axis == axis; });
  return found == faces.end() ? -1 : static_cast<int>(found - faces.begin());
}

void DualCells::find_doubled_faces(ProgressMeter& progress) {
  tbb::parallel_for(std::size_t{0}, special_.size(), [&](std::size_t n) {
    if (special_[n].empty()) return;
    progress.check();
    const Block& block = blocks_->all()[n];
    const auto beside = blocks_->beside(block, 1);
    for (const SpecialCell& lower : special_[n])
      for (int axis = 0; axis < 3; ++axis) {
        const int face = 2 * axis + 1;
        if ((lower.ambiguous >> face & 1) == 0) continue;
        const int x = (lower.cell & 7) + (axis == 0), y = (lower.cell >> 3 & 7) + (axis == 1),
                  z = (lower.cell >> 6) + (axis == 2);
        const Block* const block_above = beside[static_cast<std::size_t>((x >> 3) + 2 * (y >> 3) + 4 * (z >> 3))];
        const SpecialCell* const upper = special({block_above, x & 7, y & 7, z & 7});
        // All four edges of the face are crossed: one loop in each cell means that both segments join the same two.
        bool one_below = true, one_above = true;
        const auto corners = face_corners(face);
        const int first = edge_between(corners[0], corners[1]);
        for (std::size_t k = 0; k < 4; ++k) {
          const int edge = edge_between(corners[k], corners[(k + 1) % 4]);
          const int same = edge_between(corners[k] ^ 1 << axis, corners[(k + 1) % 4] ^ 1 << axis);
          const int same_first = edge_between(corners[0] ^ 1 << axis, corners[1] ^ 1 << axis);
          const auto loop = [](const SpecialCell& cell, int e) {
            return cell.found->loop_of[static_cast<std::size_t>(e)];
          };
          one_below &= loop(lower, edge) == loop(lower, first);
          one_above &= loop(*upper, same) == loop(*upper, same_first);
        }
        if (one_below && one_above) doubled_[n].push_back({lower.cell, static_cast<std::uint8_t>(axis)});
      }
  });
}

int segment_end(const CellCase& found, int edge, int face) {
  const auto loop = found.loop(found.loop_of[static_cast<std::size_t>(edge)]);
  const auto at = static_cast<std::size_t>(std::ranges::find(loop, edge) - loop.begin());
  const int next = loop[(at + 1) % loop.size()], last = loop[(at + loop.size() - 1) % loop.size()];
  return (edge_faces(next) >> face & 1) != 0 ? next : last;
}

int first_edge_of(int face) {
  int edge = 0;
  while ((edge_faces(edge) >> face & 1) == 0) ++edge;
  return edge;
}

}  // namespace standoff
