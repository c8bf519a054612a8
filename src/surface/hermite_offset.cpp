// SPDX-License-Identifier: Apache-2.0
// Hermite data of a surface at a distance from a mesh: Newton's method along the edges of the grid, by exact distances.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "standoff/points.h"
#include "surface/cells.h"
#include "surface/hermite.h"

namespace standoff {
namespace {

// An edge of the grid whose ends are samples.
struct OffsetSearch {
  std::uint32_t edge;
  Vec3 lower, step;  // its lower end, and the way to its upper end
  double t;
  double low = 0, high = 1;  // the crossing lies between them
};

constexpr int kMostRounds = 30;       // three are enough for most
constexpr double kNearEnough = 1e-7;  // spacings: what a float of t can tell

// Finds as many as there are room for; `searches` is empty after it.
void find_points(std::vector<OffsetSearch>& searches, const MeshOffset& offset, std::span<HermitePoint> data,
                 ProgressMeter& progress) {
  std::vector<Vec3> asked;
  for (int round = 0; round < kMostRounds && !searches.empty(); ++round) {
    progress.check();
    asked.clear();
    for (const OffsetSearch& search : searches) asked.push_back(search.lower + search.step * search.t);
    const std::vector<ClosestPoint> found = offset.closest(asked);
    std::size_t left = 0;
    for (std::size_t n = 0; n < searches.size(); ++n) {
      OffsetSearch search = searches[n];
      const ClosestPoint& nearest = found[n];
      const double edge = max_norm(search.step), miss = nearest.distance - offset.distance;
      if (!(nearest.distance > 0)) continue;  // on the mesh: no direction
      // The gradient of the value, and its part along the edge, per edge.
      const Vec3 away = (asked[n] - nearest.point) * (1 / nearest.distance);
      const double slope = dot(away, search.step);
      const Vec3 outwards = offset.inside ? away * -1.0 : away;
      // The value must grow from the end inside to the end outside.
      const double grows = dot(outwards, search.step), expected = dot(data[search.edge].normal(), search.step);
      if (std::abs(miss) <= kNearEnough * edge) {
        if (grows * expected <= 0) continue;  // another surface
        data[search.edge].t = static_cast<float>(search.t);
        data[search.edge].set_normal(outwards);
        continue;
      }
      // Newton's step, or half of what is left where it leads out: past a ridge another triangle is the closest one.
      const bool is_inside = (miss > 0) == offset.inside, rises = expected > 0;
      (is_inside == rises ? search.low : search.high) = search.t;
      double next = search.t - miss / slope;
      if (!(next > search.low && next < search.high)) next = (search.low + search.high) / 2;
      if (next == search.t) continue;
      search.t = next;
      searches[left++] = search;
    }
    searches.resize(left);
  }
  searches.clear();  // where no point was found the interpolation stays
}

}  // namespace

void hermite_of_offset(const Blocks& blocks, const EdgePoints& points, const MeshOffset& offset,
                       std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress) {
  hermite_of_field(blocks, points, data, progress);
  MemoryShare memory(budget);
  const std::size_t at_once = std::min(data.size(), kAskedAtOnce);
  memory.take(at_once * (sizeof(OffsetSearch) + kBytesPerAsked));
  std::vector<OffsetSearch> searches;
  searches.reserve(at_once);
  const Grid& grid = blocks.field().grid();
  const Size3& size = grid.size;
  for (const Block& block : blocks.all()) {
    std::uint32_t edge = block.first_vertex;
    for_each_edge(block, [&](int axis, int x, int y, int z) {
      const std::int64_t i = 8 * std::int64_t{block.at[0]} + x, j = 8 * std::int64_t{block.at[1]} + y,
                         k = 8 * std::int64_t{block.at[2]} + z;
      const std::uint32_t n = edge++;
      if (i < 0 || j < 0 || k < 0 || i + (axis == 0) >= size.x || j + (axis == 1) >= size.y ||
          k + (axis == 2) >= size.z)
        return;
      Vec3 step;
      step[axis] = grid.spacing[axis];
      searches.push_back({n, grid.position(i, j, k), step, data[n].t});
      if (searches.size() == at_once) find_points(searches, offset, data, progress);
    });
  }
  find_points(searches, offset, data, progress);
}

}  // namespace standoff
