// SPDX-License-Identifier: Apache-2.0
// Numbers the vertices of dual contouring, and finds and cuts its polygons.
#include "surface/dual_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/threads.h"
#include "surface/vertices.h"

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
        // All four edges of the face are crossed. If each cell has one loop there, both segments join the same two
        // loops.
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

namespace {

double cross_2d(Vec3 a, Vec3 b) { return a.x * b.y - a.y * b.x; }

// Whether the quad may be cut along a-c, where b is the vertex before c and d the vertex before a. The edge of the grid
// is the z axis from 0 to 1.
bool stays_at_edge(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  // The diagonal passes the edge on the side of b or of d.
  const bool at_b = (cross_2d(a, c) > 0) != (cross_2d(a, b) > 0) ? false : true;
  const Vec3 near = at_b ? b : d, far = at_b ? d : b;
  // The diagonal must pierce the half plane from the edge through `near` between the edge and `near`.
  const double on_a = cross_2d(near, c), on_c = cross_2d(a, near);
  const double sum = on_a + on_c;
  if (!(std::abs(sum) > 0)) return false;
  const Vec3 pierced = (a * on_a + c * on_c) * (1 / sum);
  const double reach = dot(Vec3{near.x, near.y, 0}, pierced) / dot(Vec3{near.x, near.y, 0}, near);
  if (!(reach >= 0 && reach <= 1)) return false;
  const double low = reach * near.z, high = reach * near.z + (1 - reach);
  if (!(pierced.z >= low && pierced.z <= high)) return false;
  // The triangle of the other three must pierce the edge.
  const double of_far = cross_2d(a, c), of_a = cross_2d(c, far), of_c = cross_2d(far, a);
  const double all = of_far + of_a + of_c;
  if (!(std::abs(all) > 0)) return false;
  const double z = (far.z * of_far + a.z * of_a + c.z * of_c) / all;
  return z >= 0 && z <= 1;
}

}  // namespace

Cut cut_of(const std::array<Vec3, 4>& corner) {
  const auto& [a, b, c, d] = corner;
  const auto length_sq = [](Vec3 v) { return dot(v, v); };
  const bool first = stays_at_edge(a, b, c, d), second = stays_at_edge(b, c, d, a);
  if (first && second) return length_sq(a - c) <= length_sq(b - d) ? Cut::first : Cut::second;
  if (first) return Cut::first;
  return second ? Cut::second : Cut::fan;
}

CellOf DualPolygons::cell(int x, int y, int z) const {
  return {beside_[static_cast<std::size_t>((x < 0) + 2 * (y < 0) + 4 * (z < 0))], x & 7, y & 7, z & 7};
}

DualPolygon DualPolygons::around(int axis, int x, int y, int z, bool outwards_up) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  // The four cells, anticlockwise as seen from above: their offsets back along u and v.
  constexpr std::array<std::array<int, 2>, 4> kBack{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::array<CellOf, 4> cells{};
  std::array<const SpecialCell*, 4> special{};
  std::array<int, 4> edge{};
  for (std::size_t n = 0; n < 4; ++n) {
    std::array<int, 3> at{x, y, z};
    at[static_cast<std::size_t>(u)] -= kBack[n][0];
    at[static_cast<std::size_t>(v)] -= kBack[n][1];
    cells[n] = cell(at[0], at[1], at[2]);
    edge[n] = edge_at(kBack[n][0] << u | kBack[n][1] << v, axis);
    special[n] = cells_->special(cells[n]);
  }
  DualPolygon polygon;
  for (std::size_t n = 0; n < 4; ++n) {
    const int loop = special[n] ? special[n]->found->loop_of[static_cast<std::size_t>(edge[n])] : 0;
    polygon.add(cells_->vertex_of_loop(cells[n], special[n], loop));
    const std::size_t next = (n + 1) % 4;
    if (!special[n] || !special[next]) continue;
    // The face between two cells is perpendicular to u between 0 and 1, and 2 and 3; to v between 1 and 2, and 3 and 0.
    const int across = n % 2 == 0 ? u : v;
    const std::size_t lower = kBack[n][n % 2] == 1 ? n : next;
    const int found = cells_->find_doubled(cells[lower], across);
    if (found < 0) continue;
    const int face = 2 * across + 1, first = first_edge_of(face);
    const bool is_first = edge[lower] == first || segment_end(*special[lower]->found, edge[lower], face) == first;
    polygon.add((*first_face_)[blocks_->number_of(*cells[lower].block)] + 2 * static_cast<std::uint32_t>(found) +
                (is_first ? 0 : 1));
  }
  if (!outwards_up) std::reverse(polygon.vertices.begin(), polygon.vertices.begin() + polygon.size);
  return polygon;
}

}  // namespace standoff
