// SPDX-License-Identifier: Apache-2.0
#include "surface/dual_polygons.h"

#include <algorithm>
#include <cmath>

namespace standoff {
namespace {

double cross_2d(Vec3 a, Vec3 b) { return a.x * b.y - a.y * b.x; }

// Whether the quad may be cut along a-c, where b is the vertex before c and d the one before a. The edge of the grid is
// the z axis from 0 to 1.
bool stays_at_edge(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  // The diagonal passes the edge on the side of b or of d.
  const bool at_b = (cross_2d(a, c) > 0) != (cross_2d(a, b) > 0) ? false : true;
  const Vec3 near = at_b ? b : d, far = at_b ? d : b;
  // Where the diagonal pierces the half plane from the edge through `near`: between the edge and `near`.
  const double on_a = cross_2d(near, c), on_c = cross_2d(a, near);
  const double sum = on_a + on_c;
  if (!(std::abs(sum) > 0)) return false;
  const Vec3 pierced = (a * on_a + c * on_c) * (1 / sum);
  const double reach = dot(Vec3{near.x, near.y, 0}, pierced) / dot(Vec3{near.x, near.y, 0}, near);
  if (!(reach >= 0 && reach <= 1)) return false;
  const double low = reach * near.z, high = reach * near.z + (1 - reach);
  if (!(pierced.z >= low && pierced.z <= high)) return false;
  // Where the triangle of the other three pierces the edge.
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
  // The four cells, anticlockwise as seen from above: how far each lies back along u and v.
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
    // The face between the two cells: perpendicular to u between 0 and 1, and 2 and 3; to v between 1 and 2, 3 and 0.
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
