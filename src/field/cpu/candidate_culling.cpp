// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/candidate_culling.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bvh/order.h"

namespace standoff::cpu {
namespace {

// The most entries of a list. If there are more candidates, some nodes stay closed, and the tile opens them part by
// part: so the memory of a thread does not grow with the mesh. Lists of scenes and scans are shorter (docs/tiles.md,
// Memory).
constexpr std::int64_t kMostEntries = std::int64_t{1} << 15;
// Nodes opened at once if not all fit into the list; this bounds the entries that each level of nodes adds to a list.
constexpr std::int64_t kNodesAtOnce = 64;
constexpr std::int64_t kOpening = kNodesAtOnce * (Bvh::kFanout - 1) * Bvh::kMostLevels;
static_assert((std::uint64_t{1} << 4 * Bvh::kMostLevels) >= kMaxTriangles);

std::int64_t list_capacity(std::int64_t entries) { return std::min(kMostEntries + kOpening, entries); }

// A tile with this many small triangles is crowded. Setting up a triangle costs more than testing its box, but each of
// eight cells tests the box. The value is arbitrary within a factor of two: it was not fitted.
constexpr std::int64_t kCrowd = 800;
// From a tile this many times its half diagonal away, all its cells see nearly the same candidates, and setting them up
// once for the tile takes less. Far above 8, a mesh smaller than a sample takes twice as long; at 3, a scene whose far
// tiles have many candidates takes a fifth longer.
constexpr float kAfar = 8;

// The half extents of cells are rounded up by this share, and by this number of grid units.
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

BvhFrame frame_of(const BlockLattice& lattice) {
  const auto middle = [&](int axis) { return static_cast<double>(lattice.size[axis] - 1) / 2; };
  const Triple<double> center = position(lattice, middle(0), middle(1), middle(2));
  BvhFrame frame{{center.x, center.y, center.z}, lattice.scale, 0};
  for (int axis = 0; axis < 3; ++axis)
    frame.extent = std::max(frame.extent, static_cast<float>(lattice.spacing[axis] * lattice.scale *
                                                             static_cast<double>(lattice.size[axis]) / 2));
  return frame;
}

float opened_length(const CullCell& samples) { return std::max({samples.half[0], samples.half[1], samples.half[2]}); }

CandidateLists::CandidateLists(int level_count, std::int64_t capacity)
    : tile(capacity), cell(capacity), part(capacity) {
  levels.reserve(static_cast<std::size_t>(level_count));
  for (int n = 0; n < level_count; ++n) levels.emplace_back(capacity);
  nodes.reserve(static_cast<std::size_t>(capacity));
  triangles.reserve(static_cast<std::size_t>(capacity));
  in_entries.reserve(static_cast<std::size_t>(capacity));
}

std::int64_t CandidateLists::bytes(int level_count, std::int64_t capacity) {
  return level_count * (BoxList::bytes(capacity) + std::int64_t{sizeof(CellCandidates)}) +
         3 * BoxList::bytes(capacity) + capacity * std::int64_t{sizeof(BvhNode) + 2 * sizeof(std::uint32_t)};
}

CandidateCulling::CandidateCulling(const Job& job, const BlockLattice& lattice, const Kernels& kernels,
                                   std::vector<std::uint32_t> order)
    : job_(job),
      lattice_(lattice),
      kernels_(kernels),
      centroids_(order.size()),
      bvh_(job.mesh, std::move(order), frame_of(lattice), job.progress, centroids_.data()),
      roots_(Bvh::kFanout) {
  const BvhNode top = bvh_.node(bvh_.root());
  for (int n = 0; n < top.count; ++n) roots_.add(top.first + static_cast<std::uint32_t>(n), *top.boxes, n);
}

std::int64_t CandidateCulling::bytes(std::int64_t triangles, const BlockLattice& lattice, int threads) {
  return bvh_bytes(triangles, threads) +
         threads * CandidateLists::bytes(levels_of(lattice), list_capacity(Bvh::entries_of(triangles)));
}

std::int64_t CandidateCulling::bvh_bytes(std::int64_t triangles, int threads) {
  return Bvh::bytes_of(triangles) + triangles * std::int64_t{sizeof(float[3])} + radix_sort_bytes(triangles, threads);
}

CandidateLists CandidateCulling::make_lists(int level_count) const {
  return {level_count, list_capacity(bvh_.entries())};
}

// Centre and half extents are in grid units relative to the grid's centre. The half extents are rounded up.
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
  narrow(parent, target, opened_length(target.samples), own.list, lists.nodes);
  if (own.list.size() != 0) own.points = points_of(target.samples, own.list.arrays());
  own.cell = cell;
  return own;
}

bool CandidateCulling::narrow(const BoxArrays& parent, const CellTarget& target, float largest, BoxList& result,
                              std::vector<BvhNode>& nodes) const {
  result.clear();
  kernels_.cull_boxes(parent, target.samples, target.near, result.arrays());
  return open_nodes(target, largest, result, nodes);
}

bool CandidateCulling::open_nodes(const CellTarget& target, float largest, BoxList& list,
                                  std::vector<BvhNode>& nodes) const {
  bool all = take_large(0, largest, list, nodes);
  while (!nodes.empty()) {
    const std::int64_t first = list.size();
    kernels_.cull_nodes(nodes.data(), std::ssize(nodes), target.samples, target.near, list.arrays());
    all &= take_large(first, largest, list, nodes);
  }
  return all;
}

// Moves nodes longer than `largest` from the list to `nodes`, beginning at entry `first`, while the list has room for
// their children. Returns whether all such nodes were moved.
bool CandidateCulling::take_large(std::int64_t first, float largest, BoxList& list, std::vector<BvhNode>& nodes) const {
  nodes.clear();
  const auto most =
      static_cast<std::size_t>(std::max<std::int64_t>(0, kMostEntries - list.size()) / (Bvh::kFanout - 1));
  bool all = true;
  std::int64_t kept = first;
  for (std::int64_t n = first; n < list.size(); ++n) {
    if (bvh_.is_node(list.entry(n)) && list.longest_side(n) > largest) {
      if (nodes.size() < most) {
        bvh_.prefetch(list.entry(n));
        nodes.push_back(bvh_.node(list.entry(n)));
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

// Opens the last nodes first, so that few wait.
bool CandidateCulling::next_part(const CellTarget& target, BoxList& list, CandidateLists& lists) const {
  job_.progress.check();
  BoxList& part = lists.part;
  part.clear();
  while (list.size() != 0 && part.size() < kMostEntries) {
    lists.nodes.clear();
    std::int64_t left = list.size();
    for (; left != 0 && part.size() < kMostEntries && std::ssize(lists.nodes) < kNodesAtOnce; --left) {
      const std::uint32_t entry = list.entry(left - 1);
      if (bvh_.is_node(entry))
        lists.nodes.push_back(bvh_.node(entry));
      else
        part.add(list, left - 1);
    }
    list.shrink(left);
    kernels_.cull_nodes(lists.nodes.data(), std::ssize(lists.nodes), target.samples, target.near, list.arrays());
  }
  return part.size() != 0;
}

bool CandidateCulling::is_crowded(const BoxList& list, const CellTarget& tile) const {
  float half_sq = 0;
  for (const float half : tile.samples.half) half_sq += half * half;
  const auto is_afar = [&](const float(&point)[3]) {
    float distance_sq = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float along = point[axis] - tile.samples.center[axis];
      distance_sq += along * along;
    }
    return distance_sq > kAfar * kAfar * half_sq;
  };
  if (std::all_of(tile.near.at, tile.near.at + tile.near.count, is_afar)) return false;
  const float small = opened_length(tile.samples);
  std::int64_t triangles = 0;
  for (std::int64_t n = 0; n < list.size(); ++n)
    if (list.longest_side(n) < small) triangles += bvh_.triangles_in(list.entry(n));
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
    const auto place = [&](int lane) {  // lanes past the end repeat the last entry
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

// Finds a triangle near `at` by following the nearest boxes down.
std::uint32_t CandidateCulling::near_triangle(std::uint32_t entry, const float (&at)[3]) const {
  while (bvh_.is_node(entry)) {
    const BvhNode node = bvh_.node(entry);
    entry = node.first + static_cast<std::uint32_t>(kernels_.nearest_child(node, at));
  }
  return bvh_.order()[entry];
}

void CandidateCulling::set_triangle(std::uint32_t triangle, int lane, TriangleLanes& lanes) const {
  for (int k = 0; k < 3; ++k) {
    const Vec3 at = bvh_.frame().local(job_.mesh.corner(triangle, k));
    for (int axis = 0; axis < 3; ++axis) lanes.corner[k][axis][lane] = at[axis];
  }
}

std::int64_t CandidateCulling::nodes_below(float longest, const BoxList& list) const {
  std::int64_t nodes = 0;
  for (std::int64_t n = 0; n < list.size(); ++n)
    nodes += bvh_.is_node(list.entry(n)) && list.longest_side(n) <= longest;
  return nodes;
}

const std::uint32_t* CandidateCulling::first_triangles(const BoxList& list, CandidateLists& lists) const {
  lists.in_entries.clear();
  for (std::int64_t n = 0; n < list.size(); ++n) lists.in_entries.push_back(bvh_.first_triangle(list.entry(n)));
  return lists.in_entries.data();
}

CrowdedCell CandidateCulling::crowded_cell(const Brick& brick, const Cell& cell, const BoxArrays& boxes) const {
  CrowdedCell crowded{.at = {},
                      .boxes = boxes,
                      .points = centroids_.data(),
                      .index = bvh_.order().data(),
                      .brick_center = {},
                      .extent = bvh_.frame().extent};
  for (int axis = 0; axis < 3; ++axis) {
    crowded.at[axis] = static_cast<int>(cell.low[axis] % kBrickSide);
    crowded.brick_center[axis] = static_cast<float>(brick.center[axis] - bvh_.frame().center[axis]);
  }
  return crowded;
}

}  // namespace standoff::cpu
