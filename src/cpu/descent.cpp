#include "cpu/descent.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "cpu/box_list.h"
#include "cpu/clusters.h"
#include "cpu/radix_sort.h"
#include "geometry/closest_point.h"

namespace difi::cpu {
namespace {

constexpr int kTileSide = DistanceField::kTileSide;

// A cell: samples [low, high) per axis of the grid, 2^n of them on a side before the grid cuts it.
struct Cell {
  std::int64_t low[3], high[3];
  std::int64_t side;
};

// The lattice that divides a cell into its eight children, and a point of the surface near each of its corners.
struct Points {
  float at[kLatticeSide][kLatticeSide][kLatticeSide][3];  // z, y, x, coordinate
};

class Descent {
 public:
  Descent(const Job& job, const Lattice& lattice, const Kernels& kernels, CandidateUse& use)
      : job_(job), lattice_(lattice), kernels_(kernels), use_(use), clusters_(job, lattice) {}

  void run() {
    BoxList roots;
    const PackContents top = clusters_.contents(clusters_.top());
    roots.make_room(top.count);
    for (int n = 0; n < top.count; ++n) roots.add(top.first + static_cast<std::uint32_t>(n), *top.boxes, n);
    Cell whole{{0, 0, 0}, {lattice_.size[0], lattice_.size[1], lattice_.size[2]}, kBrickSide};
    while (whole.side < *std::max_element(lattice_.size, lattice_.size + 3)) whole.side *= 2;
    visit(whole, roots.arrays(), {});
  }

 private:
  // Lists that a thread uses again for each brick.
  struct Scratch {
    BoxList brick, tile, cell;
    std::vector<PackContents> packs;
    std::vector<std::uint32_t> triangles;
  };

  // The samples of a cell: centre and half extents in grid units, relative to the grid's centre.
  CullCell samples_of(const Cell& cell) const {
    CullCell box{};
    for (int axis = 0; axis < 3; ++axis) {
      const double step = lattice_.spacing[axis] * lattice_.scale;
      const double first = static_cast<double>(cell.low[axis]), last = static_cast<double>(cell.high[axis] - 1);
      const double middle = static_cast<double>(lattice_.size[axis] - 1) / 2;
      box.center[axis] = static_cast<float>(((first + last) / 2 - middle) * step);
      box.half[axis] = static_cast<float>((last - first) / 2 * step) * (1 + 1e-6f) + 1e-6f;
    }
    box.reach = lattice_.thickness;
    return box;
  }

  // The eight or fewer halves of a cell.
  static int halves(const Cell& cell, Cell (&parts)[8]) {
    int count = 0;
    const std::int64_t half = cell.side / 2;
    for (int n = 0; n < 8; ++n) {
      Cell& part = parts[count];
      part.side = half;
      bool some = true;
      for (int axis = 0; axis < 3; ++axis) {
        part.low[axis] = cell.low[axis] + ((n >> axis & 1) != 0 ? half : 0);
        part.high[axis] = std::min(part.low[axis] + half, cell.high[axis]);
        some = some && part.low[axis] < part.high[axis];
      }
      count += some;
    }
    return count;
  }

  // A point of the surface near `at`: the closest point of a triangle found by following the nearest boxes down.
  std::array<float, 3> surface_point(std::uint32_t entry, const float (&at)[3]) const {
    while (clusters_.is_pack(entry)) {
      const PackContents pack = clusters_.contents(entry);
      entry = pack.first + static_cast<std::uint32_t>(kernels_.nearest_in_pack(pack, at));
    }
    Triple<double> corner[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3 v = job_.mesh.corner(clusters_.triangle(entry), k) * lattice_.scale;
      const double* center = clusters_.center();
      corner[k] = {v.x - center[0], v.y - center[1], v.z - center[2]};
    }
    const auto q = closest_on_triangle(Triple<double>{at[0], at[1], at[2]}, corner[0], corner[1], corner[2]);
    return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
  }

  Points points_of(const CullCell& cell, const BoxArrays& list) const {
    float at[3][kLatticeSide];
    for (int axis = 0; axis < 3; ++axis)
      for (int n = 0; n < kLatticeSide; ++n)
        at[axis][n] = cell.center[axis] + static_cast<float>(n - 1) * cell.half[axis];
    std::uint32_t nearest[kLatticeSide * kLatticeSide * kLatticeSide];
    kernels_.nearest_to_lattice(list, at, nearest);
    Points points;
    for (int z = 0, n = 0; z < kLatticeSide; ++z)
      for (int y = 0; y < kLatticeSide; ++y)
        for (int x = 0; x < kLatticeSide; ++x, ++n) {
          const auto q = surface_point(list.entry[nearest[n]], {at[0][x], at[1][y], at[2][z]});
          std::copy(q.begin(), q.end(), points.at[z][y][x]);
        }
    return points;
  }

  // The corners of the child of `cell` that begins at `low`.
  static References corners_of(const Points& points, const Cell& cell, const Cell& child) {
    References corners;
    corners.count = References::kMost;
    int at[3];
    for (int axis = 0; axis < 3; ++axis) at[axis] = child.low[axis] > cell.low[axis] ? 1 : 0;
    for (int n = 0; n < References::kMost; ++n) {
      const float* q = points.at[at[2] + (n >> 2 & 1)][at[1] + (n >> 1 & 1)][at[0] + (n & 1)];
      std::copy(q, q + 3, corners.at[n]);
    }
    return corners;
  }

  // Takes the packs that are longer than `largest` out of the list, looking at its entries from the first on.
  void take_large(std::int64_t first, float largest, BoxList& list, std::vector<PackContents>& packs) const {
    packs.clear();
    std::int64_t kept = first;
    for (std::int64_t n = first; n < list.size(); ++n) {
      if (clusters_.is_pack(list.entry(n)) && list.longest_side(n) > largest) {
        clusters_.prefetch(list.entry(n));
        packs.push_back(clusters_.contents(list.entry(n)));
        continue;
      }
      if (kept != n) list.move(n, kept);
      ++kept;
    }
    list.arrays().count = kept;
  }

  // What of the parent's list may be nearest to a sample of the cell, with no pack longer than `largest`.
  void narrow(const BoxArrays& parent, const CullCell& cell, const References& corners, float largest, BoxList& result,
              std::vector<PackContents>& packs) const {
    result.clear();
    result.make_room(parent.count);
    kernels_.cull_boxes(parent, cell, corners, result.arrays());
    open_packs(cell, corners, largest, result, packs);
  }

  // Puts in the place of packs longer than `largest` what of them may be nearest.
  void open_packs(const CullCell& cell, const References& corners, float largest, BoxList& result,
                  std::vector<PackContents>& packs) const {
    take_large(0, largest, result, packs);
    while (!packs.empty()) {
      const auto count = static_cast<std::int64_t>(packs.size());
      const std::int64_t first = result.size();
      result.make_room(Clusters::kFanout * count);
      kernels_.cull_packs(packs.data(), count, cell, corners, result.arrays());
      take_large(first, largest, result, packs);
    }
  }

  static float longest_side(const CullCell& cell) { return 2 * std::max({cell.half[0], cell.half[1], cell.half[2]}); }

  void visit(const Cell& cell, const BoxArrays& parent, const References& corners) {
    if (cell.side == kBrickSide) return visit_brick(cell, parent, corners);
    const CullCell samples = samples_of(cell);
    BoxList list;
    std::vector<PackContents> packs;
    narrow(parent, samples, corners, longest_side(samples) / 2, list, packs);
    if (list.size() == 0) {
      job_.progress.advance(bricks_in(cell));
      return;
    }
    const Points points = points_of(samples, list.arrays());
    Cell parts[8];
    const int count = halves(cell, parts);
    tbb::parallel_for(0, count, [&](int n) { visit(parts[n], list.arrays(), corners_of(points, cell, parts[n])); });
  }

  static std::int64_t bricks_in(const Cell& cell) {
    std::int64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) count *= (cell.high[axis] - cell.low[axis] + kBrickSide - 1) / kBrickSide;
    return count;
  }

  void visit_brick(const Cell& cell, const BoxArrays& parent, const References& corners) {
    const CullCell samples = samples_of(cell);
    Scratch& scratch = scratch_.local();
    narrow(parent, samples, corners, longest_side(samples) / 2, scratch.brick, scratch.packs);
    if (scratch.brick.size() != 0) {
      const auto at = [&](int axis) { return cell.low[axis] / kBrickSide; };
      const Brick brick = brick_at(lattice_, at(0) + lattice_.bricks[0] * (at(1) + lattice_.bricks[1] * at(2)));
      const Points points = points_of(samples, scratch.brick.arrays());
      use_.begin_brick();
      Cell tiles[kBrickTiles];
      const int count = halves(cell, tiles);
      for (int n = 0; n < count; ++n)
        visit_tile(brick, tiles[n], tile_in(cell, tiles[n]), corners_of(points, cell, tiles[n]), scratch);
      use_.end_brick(brick);
    }
    job_.progress.advance();
  }

  void visit_tile(const Brick& brick, const Cell& tile, int number, const References& corners, Scratch& scratch) const {
    const CullCell samples = samples_of(tile);
    BoxList& list = scratch.tile;
    narrow(scratch.brick.arrays(), samples, corners, longest_side(samples) / 2, list, scratch.packs);
    if (is_crowded(list, longest_side(samples) / 2)) {
      const Points points = points_of(samples, list.arrays());
      Cell cells[8];
      const int count = halves(tile, cells);
      for (int n = 0; n < count; ++n) visit_cell(brick, cells[n], corners_of(points, tile, cells[n]), scratch);
      return;
    }
    open_packs(samples, corners, 0, list, scratch.packs);
    scratch.triangles.clear();
    for (std::int64_t n = 0; n < list.size(); ++n) scratch.triangles.push_back(clusters_.triangle(list.entry(n)));
    use_.use_tile(brick, number, scratch.triangles);
  }

  // Whether a tile has so many candidates, small ones, that its cells had better choose theirs by boxes.
  bool is_crowded(const BoxList& list, float small) const {
    constexpr std::int64_t kCrowd = 800;
    std::int64_t triangles = 0;
    for (std::int64_t n = 0; n < list.size(); ++n)
      if (list.longest_side(n) < small) triangles += clusters_.triangles_in(list.entry(n));
    return triangles > kCrowd;
  }

  void visit_cell(const Brick& brick, const Cell& cell, const References& corners, Scratch& scratch) const {
    narrow(scratch.tile.arrays(), samples_of(cell), corners, 0, scratch.cell, scratch.packs);
    CrowdedCell found{.at = {},
                      .boxes = scratch.cell.arrays(),
                      .points = clusters_.points(),
                      .index = clusters_.indices(),
                      .brick_center = {},
                      .extent = clusters_.extent()};
    for (int axis = 0; axis < 3; ++axis) {
      found.at[axis] = static_cast<int>(cell.low[axis] % kBrickSide);
      found.brick_center[axis] = static_cast<float>(brick.center[axis] - clusters_.center()[axis]);
    }
    use_.use_cell(brick, found);
  }

  // Which of a brick's tiles a half of it is.
  static int tile_in(const Cell& brick, const Cell& tile) {
    int number = 0;
    for (int axis = 0; axis < 3; ++axis) number += tile.low[axis] > brick.low[axis] ? 1 << axis : 0;
    return number;
  }

  const Job& job_;
  const Lattice& lattice_;
  const Kernels& kernels_;
  CandidateUse& use_;
  const Clusters clusters_;
  tbb::enumerable_thread_specific<Scratch> scratch_;
};

}  // namespace

void for_each_brick_by_descent(const Job& job, const Lattice& lattice, const Kernels& kernels, CandidateUse& use) {
  Descent(job, lattice, kernels, use).run();
}

std::int64_t descent_scratch_bytes(std::int64_t triangles) {
  constexpr std::int64_t sorting = 2 * sizeof(KeyedIndex), order = sizeof(std::uint32_t), box = 6 * sizeof(float),
                         point = 3 * sizeof(float);
  return triangles * (sorting + order + point + box + box / (Clusters::kFanout - 1) + 1);
}

}  // namespace difi::cpu
