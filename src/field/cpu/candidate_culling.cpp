// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/candidate_culling.h"

#include <algorithm>
#include <array>
#include <utility>

namespace standoff::cpu {
namespace {

// The most entries of a list. Where more candidates are left, packs of them stay closed, and are opened part by part
// where the tile is: so what a thread holds does not grow with the mesh. Lists of scenes and scans are shorter
// (docs/tiles.md, Memory).
constexpr std::int64_t kMostEntries = std::int64_t{1} << 15;
// Packs opened at once where not all fit into the list; what that adds to a list, level by level of packs within packs.
constexpr std::int64_t kPacksAtOnce = 64, kMostPackLevels = 8;
constexpr std::int64_t kOpening = kPacksAtOnce * (Clusters::kFanout - 1) * kMostPackLevels;
static_assert((std::uint64_t{1} << 4 * kMostPackLevels) >= kMaxTriangles);

std::int64_t list_capacity(std::int64_t entries) { return std::min(kMostEntries + kOpening, entries); }

// Small triangles from which on a tile is crowded. Setting a triangle up costs more than looking at its box, but a box
// is looked at by each of eight cells. The value is arbitrary within a factor of two: it was not fitted.
constexpr std::int64_t kCrowd = 800;

// What the half extents of cells are rounded up by: this share, and as many grid units.
constexpr float kCellSlack = 1e-6f;
static_assert(kCellSlack > gamma_float(16));

}  // namespace

References references_of(const SurfacePoints& points, const Cell& cell, const Cell& half) {
  References near;
  near.count = References::kMost;
  int at[3];
  for (int axis = 0; axis < 3; ++axis) at[axis] = half.low[axis] > cell.low[axis] ? 1 : 0;
  for (int n = 0; n < References::kMost; ++n) {
    const float* q = points.at[at[2] + (n >> 2 & 1)][at[1] + (n >> 1 & 1)][at[0] + (n & 1)];
    std::copy(q, q + 3, near.at[n]);
  }
  return near;
}

float opened_length(const CullCell& samples) { return std::max({samples.half[0], samples.half[1], samples.half[2]}); }

CandidateLists::CandidateLists(int level_count, std::int64_t capacity)
    : tile(capacity), cell(capacity), part(capacity) {
  levels.reserve(static_cast<std::size_t>(level_count));
  for (int n = 0; n < level_count; ++n) levels.emplace_back(capacity);
  packs.reserve(static_cast<std::size_t>(capacity));
  triangles.reserve(static_cast<std::size_t>(capacity));
}

std::int64_t CandidateLists::bytes(int level_count, std::int64_t capacity) {
  return level_count * (BoxList::bytes(capacity) + std::int64_t{sizeof(CellCandidates)}) +
         3 * BoxList::bytes(capacity) + capacity * std::int64_t{sizeof(PackContents) + sizeof(std::uint32_t)};
}

CandidateCulling::CandidateCulling(const Job& job, const BlockLattice& lattice, const Kernels& kernels,
                                   std::vector<std::uint32_t> order)
    : job_(job),
      lattice_(lattice),
      kernels_(kernels),
      clusters_(job, lattice, std::move(order)),
      roots_(Clusters::kFanout) {
  const PackContents top = clusters_.contents(clusters_.top());
  for (int n = 0; n < top.count; ++n) roots_.add(top.first + static_cast<std::uint32_t>(n), *top.boxes, n);
}

std::int64_t CandidateCulling::bytes(std::int64_t triangles, const BlockLattice& lattice, int threads) {
  return Clusters::bytes(triangles, threads) +
         threads * CandidateLists::bytes(levels_of(lattice), list_capacity(Clusters::entries_of(triangles)));
}

CandidateLists CandidateCulling::make_lists(int level_count) const {
  return {level_count, list_capacity(clusters_.entries())};
}

// Centre and half extents in grid units, relative to the grid's centre. The half extents are rounded up.
CellTarget CandidateCulling::target(const Cell& cell, const References& near) const {
  CellTarget target{{}, near};
  for (int axis = 0; axis < 3; ++axis) {
    const double step = lattice_.unit[axis];
    const double first = static_cast<double>(cell.low[axis]), last = static_cast<double>(cell.high[axis] - 1);
    const double middle = static_cast<double>(lattice_.size[axis] - 1) / 2;
    target.samples.center[axis] = static_cast<float>(((first + last) / 2 - middle) * step);
    target.samples.half[axis] = static_cast<float>((last - first) / 2 * step) * (1 + kCellSlack) + kCellSlack;
  }
  target.samples.reach = lattice_.thickness;
  return target;
}

const CellCandidates& CandidateCulling::enter(int level, const Cell& cell, const References& near,
                                              CandidateLists& lists) const {
  CellCandidates& own = lists.levels[static_cast<std::size_t>(level)];
  if (own.cell == cell) return own;
  const CellTarget target = this->target(cell, near);
  const BoxArrays& parent =
      level == 0 ? roots_.arrays() : lists.levels[static_cast<std::size_t>(level) - 1].list.arrays();
  narrow(parent, target, opened_length(target.samples), own.list, lists.packs);
  if (own.list.size() != 0) own.points = points_of(target.samples, own.list.arrays());
  own.cell = cell;
  return own;
}

bool CandidateCulling::narrow(const BoxArrays& parent, const CellTarget& target, float largest, BoxList& result,
                              std::vector<PackContents>& packs) const {
  result.clear();
  kernels_.cull_boxes(parent, target.samples, target.near, result.arrays());
  return open_packs(target, largest, result, packs);
}

bool CandidateCulling::open_packs(const CellTarget& target, float largest, BoxList& list,
                                  std::vector<PackContents>& packs) const {
  bool all = take_large(0, largest, list, packs);
  while (!packs.empty()) {
    const std::int64_t first = list.size();
    kernels_.cull_packs(packs.data(), std::ssize(packs), target.samples, target.near, list.arrays());
    all &= take_large(first, largest, list, packs);
  }
  return all;
}

// Takes packs that are longer than `largest` out of the list, looking at its entries from the first on, as long as what
// they hold has room in it. Returns whether all such packs were taken.
bool CandidateCulling::take_large(std::int64_t first, float largest, BoxList& list,
                                  std::vector<PackContents>& packs) const {
  packs.clear();
  const auto most =
      static_cast<std::size_t>(std::max<std::int64_t>(0, kMostEntries - list.size()) / (Clusters::kFanout - 1));
  bool all = true;
  std::int64_t kept = first;
  for (std::int64_t n = first; n < list.size(); ++n) {
    if (clusters_.is_pack(list.entry(n)) && list.longest_side(n) > largest) {
      if (packs.size() < most) {
        clusters_.prefetch(list.entry(n));
        packs.push_back(clusters_.contents(list.entry(n)));
        continue;
      }
      all = false;
    }
    if (kept != n) list.move(n, kept);
    ++kept;
  }
  list.shrink(kept);
  return all;
}

// The last packs are opened first, so that few wait.
bool CandidateCulling::next_part(const CellTarget& target, BoxList& list, CandidateLists& lists) const {
  job_.progress.check();
  BoxList& part = lists.part;
  part.clear();
  while (list.size() != 0 && part.size() < kMostEntries) {
    lists.packs.clear();
    std::int64_t left = list.size();
    for (; left != 0 && part.size() < kMostEntries && std::ssize(lists.packs) < kPacksAtOnce; --left) {
      const std::uint32_t entry = list.entry(left - 1);
      if (clusters_.is_pack(entry))
        lists.packs.push_back(clusters_.contents(entry));
      else
        part.add(list, left - 1);
    }
    list.shrink(left);
    kernels_.cull_packs(lists.packs.data(), std::ssize(lists.packs), target.samples, target.near, list.arrays());
  }
  return part.size() != 0;
}

bool CandidateCulling::is_crowded(const BoxList& list, const CellTarget& tile) const {
  const float small = opened_length(tile.samples);
  std::int64_t triangles = 0;
  for (std::int64_t n = 0; n < list.size(); ++n)
    if (list.longest_side(n) < small) triangles += clusters_.triangles_in(list.entry(n));
  return triangles > kCrowd;
}

SurfacePoints CandidateCulling::points_of(const CullCell& samples, const BoxArrays& list) const {
  constexpr int kLatticePoints = kLatticeSide * kLatticeSide * kLatticeSide;
  float at[3][kLatticeSide];
  for (int axis = 0; axis < 3; ++axis)
    for (int n = 0; n < kLatticeSide; ++n)
      at[axis][n] = samples.center[axis] + static_cast<float>(n - 1) * samples.half[axis];
  std::uint32_t nearest[kLatticePoints];
  kernels_.nearest_to_lattice(list, at, nearest);
  SurfacePoints points;
  for (int first = 0; first < kLatticePoints; first += TriangleLanes::kCount) {
    TriangleLanes lanes;
    const auto place = [&](int lane) {  // past the end, the last one again
      const int n = std::min(first + lane, kLatticePoints - 1);
      return std::array{n % kLatticeSide, n / kLatticeSide % kLatticeSide, n / (kLatticeSide * kLatticeSide)};
    };
    for (int lane = 0; lane < TriangleLanes::kCount; ++lane) {
      const auto [x, y, z] = place(lane);
      const std::uint32_t box = nearest[std::min(first + lane, kLatticePoints - 1)];
      set_triangle(near_triangle(list.entry[box], {at[0][x], at[1][y], at[2][z]}), lane, lanes);
      lanes.at[0][lane] = at[0][x], lanes.at[1][lane] = at[1][y], lanes.at[2][lane] = at[2][z];
    }
    kernels_.nearest_on_triangles(lanes);
    for (int lane = 0; lane < TriangleLanes::kCount; ++lane) {
      const auto [x, y, z] = place(lane);
      for (int axis = 0; axis < 3; ++axis) points.at[z][y][x][axis] = static_cast<float>(lanes.at[axis][lane]);
    }
  }
  return points;
}

// A triangle near `at`: the one found by following the nearest boxes down.
std::uint32_t CandidateCulling::near_triangle(std::uint32_t entry, const float (&at)[3]) const {
  while (clusters_.is_pack(entry)) {
    const PackContents pack = clusters_.contents(entry);
    entry = pack.first + static_cast<std::uint32_t>(kernels_.nearest_in_pack(pack, at));
  }
  return clusters_.triangle(entry);
}

void CandidateCulling::set_triangle(std::uint32_t triangle, int lane, TriangleLanes& lanes) const {
  const double(&center)[3] = clusters_.center();
  for (int k = 0; k < 3; ++k) {
    const Vec3 v = job_.mesh.corner(triangle, k) * lattice_.scale;
    lanes.corner[k][0][lane] = v.x - center[0];
    lanes.corner[k][1][lane] = v.y - center[1];
    lanes.corner[k][2][lane] = v.z - center[2];
  }
}

CrowdedCell CandidateCulling::crowded_cell(const Brick& brick, const Cell& cell, const BoxArrays& boxes) const {
  CrowdedCell crowded{.at = {},
                      .boxes = boxes,
                      .points = clusters_.points(),
                      .index = clusters_.indices(),
                      .brick_center = {},
                      .extent = clusters_.extent()};
  for (int axis = 0; axis < 3; ++axis) {
    crowded.at[axis] = static_cast<int>(cell.low[axis] % kBrickSide);
    crowded.brick_center[axis] = static_cast<float>(brick.center[axis] - clusters_.center()[axis]);
  }
  return crowded;
}

}  // namespace standoff::cpu
