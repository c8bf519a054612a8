#include "field/cpu/candidate_culling.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/per_thread.h"
#include "field/cpu/box_list.h"
#include "field/cpu/cells.h"
#include "field/cpu/clusters.h"
#include "geometry/closest_point.h"

namespace standoff::cpu {
namespace {

// The most entries of a list. Where more candidates are left, packs of them stay closed, and are opened part by part
// where the tile is: so what a thread holds does not grow with the mesh. Lists of scenes and scans are shorter
// (docs/tiles.md, Memory).
constexpr std::int64_t kMostEntries = std::int64_t{1} << 15;
// Packs opened at once where not all have room; what that adds to a list, level by level of packs within packs.
constexpr std::int64_t kPacksAtOnce = 64, kMostPackLevels = 8;
constexpr std::int64_t kOpening = kPacksAtOnce * (Clusters::kFanout - 1) * kMostPackLevels;
static_assert((std::uint64_t{1} << 4 * kMostPackLevels) >= kMaxTriangles);

std::int64_t list_capacity(std::int64_t entries) { return std::min(kMostEntries + kOpening, entries); }

// The lattice that divides a cell into its eight children, and a point of the surface near each of its corners.
struct Points {
  float at[kLatticeSide][kLatticeSide][kLatticeSide][3];  // z, y, x, coordinate
};

// What a cell's halves start from.
struct Level {
  explicit Level(std::int64_t capacity) : list(capacity) {}

  Cell cell{};  ///< none yet: its side is zero
  BoxList list;
  Points points;  ///< where the list is not empty
};

// What one thread uses again and again. A level holds the cell that it has visited last, so that the bricks of one cell
// share its list.
struct Scratch {
  Scratch(int level_count, std::int64_t capacity) : tile(capacity), cell(capacity), part(capacity) {
    levels.reserve(static_cast<std::size_t>(level_count));
    for (int n = 0; n < level_count; ++n) levels.emplace_back(capacity);
    packs.reserve(static_cast<std::size_t>(capacity));
    triangles.reserve(static_cast<std::size_t>(capacity));
  }
  static constexpr std::int64_t bytes(int level_count, std::int64_t capacity) {
    return level_count * (BoxList::bytes(capacity) + std::int64_t{sizeof(Level)}) + 3 * BoxList::bytes(capacity) +
           capacity * std::int64_t{sizeof(PackContents) + sizeof(std::uint32_t)} + std::int64_t{sizeof(Scratch)};
  }

  std::vector<Level> levels;  // the whole grid first, a brick last
  BoxList tile, cell;
  BoxList part;  // of the candidates of a tile or cell, where they are too many for one list
  std::vector<PackContents> packs;
  std::vector<std::uint32_t> triangles;
};

class Descent {
 public:
  Descent(const Job& job, const BlockLattice& lattice, const Kernels& kernels, CandidateUse& use)
      : job_(job),
        lattice_(lattice),
        kernels_(kernels),
        use_(use),
        clusters_(job, lattice),
        roots_(Clusters::kFanout),
        scratch_([this] { return Scratch(levels_of(lattice_), list_capacity(clusters_.entries())); }) {
    const PackContents top = clusters_.contents(clusters_.top());
    for (int n = 0; n < top.count; ++n) roots_.add(top.first + static_cast<std::uint32_t>(n), *top.boxes, n);
  }

  void run() {
    tbb::parallel_for(BrickRange(lattice_),
                      [this](const BrickRange& range) { visit(0, whole_grid(lattice_), {}, range, scratch_.local()); });
  }

 private:
  // The samples of a cell: centre and half extents in grid units, relative to the grid's centre.
  CullCell samples_of(const Cell& cell) const {
    CullCell box{};
    for (int axis = 0; axis < 3; ++axis) {
      const double step = lattice_.unit[axis];
      const double first = static_cast<double>(cell.low[axis]), last = static_cast<double>(cell.high[axis] - 1);
      const double middle = static_cast<double>(lattice_.size[axis] - 1) / 2;
      box.center[axis] = static_cast<float>(((first + last) / 2 - middle) * step);
      box.half[axis] = static_cast<float>((last - first) / 2 * step) * (1 + 1e-6f) + 1e-6f;
    }
    box.reach = lattice_.thickness;
    return box;
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

  // Takes packs that are longer than `largest` out of the list, looking at its entries from the first on, as long as
  // what they hold has room in it. Returns whether all such packs were taken.
  bool take_large(std::int64_t first, float largest, BoxList& list, std::vector<PackContents>& packs) const {
    packs.clear();
    auto most =
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

  // What of the parent's list may be nearest to a sample of the cell, with no pack longer than `largest` where there is
  // room for what they hold. Returns whether there was.
  bool narrow(const BoxArrays& parent, const CullCell& cell, const References& corners, float largest, BoxList& result,
              std::vector<PackContents>& packs) const {
    result.clear();
    kernels_.cull_boxes(parent, cell, corners, result.arrays());
    return open_packs(cell, corners, largest, result, packs);
  }

  // Puts in the place of packs longer than `largest` what of them may be nearest; returns as above.
  bool open_packs(const CullCell& cell, const References& corners, float largest, BoxList& result,
                  std::vector<PackContents>& packs) const {
    bool all = take_large(0, largest, result, packs);
    while (!packs.empty()) {
      const std::int64_t first = result.size();
      kernels_.cull_packs(packs.data(), static_cast<std::int64_t>(packs.size()), cell, corners, result.arrays());
      all &= take_large(first, largest, result, packs);
    }
    return all;
  }

  // Calls use(boxes) with parts of a list, each of triangles alone: all packs are opened, the last ones first, so that
  // few wait. Leaves the list empty.
  template <class Use>
  void in_parts(const CullCell& cell, const References& corners, BoxList& list, Scratch& scratch,
                const Use& use) const {
    BoxList& part = scratch.part;
    part.clear();
    while (list.size() != 0) {
      scratch.packs.clear();
      std::int64_t left = list.size();
      for (; left != 0 && part.size() < kMostEntries && std::ssize(scratch.packs) < kPacksAtOnce; --left) {
        const std::uint32_t entry = list.entry(left - 1);
        if (clusters_.is_pack(entry))
          scratch.packs.push_back(clusters_.contents(entry));
        else
          part.add(list, left - 1);
      }
      list.shrink(left);
      kernels_.cull_packs(scratch.packs.data(), std::ssize(scratch.packs), cell, corners, list.arrays());
      if (part.size() == kMostEntries || list.size() == 0) {
        use(part.arrays());
        part.clear();
        job_.progress.check();
      }
    }
  }

  static float longest_side(const CullCell& cell) { return 2 * std::max({cell.half[0], cell.half[1], cell.half[2]}); }

  // Visits the bricks of a cell that are in the range.
  void visit(int level, const Cell& cell, const References& corners, const BrickRange& range, Scratch& scratch) {
    Level& own = scratch.levels[static_cast<std::size_t>(level)];
    if (own.cell != cell) {
      const CullCell samples = samples_of(cell);
      const BoxArrays& parent =
          level == 0 ? roots_.arrays() : scratch.levels[static_cast<std::size_t>(level) - 1].list.arrays();
      narrow(parent, samples, corners, longest_side(samples) / 2, own.list, scratch.packs);
      if (own.list.size() != 0) own.points = points_of(samples, own.list.arrays());
      own.cell = cell;
    }
    if (own.list.size() == 0) return job_.progress.advance(range.bricks_of(cell));
    if (cell.side == kBrickSide) return visit_brick(own, scratch);
    Cell parts[8];
    const int count = halves(cell, parts);
    for (int n = 0; n < count; ++n)
      if (range.bricks_of(parts[n]) != 0)
        visit(level + 1, parts[n], corners_of(own.points, cell, parts[n]), range, scratch);
  }

  void visit_brick(const Level& own, Scratch& scratch) {
    const auto at = [&](int axis) { return own.cell.low[axis] / kBrickSide; };
    const Brick brick = brick_at(lattice_, at(0) + lattice_.bricks[0] * (at(1) + lattice_.bricks[1] * at(2)));
    use_.begin_brick();
    Cell tiles[kBrickTiles];
    const int count = halves(own.cell, tiles);
    for (int n = 0; n < count; ++n) visit_tile(brick, own, tiles[n], scratch);
    use_.end_brick(brick);
    job_.progress.advance();
  }

  void visit_tile(const Brick& brick, const Level& parent, const Cell& tile, Scratch& scratch) const {
    const References corners = corners_of(parent.points, parent.cell, tile);
    const CullCell samples = samples_of(tile);
    BoxList& list = scratch.tile;
    narrow(parent.list.arrays(), samples, corners, longest_side(samples) / 2, list, scratch.packs);
    if (is_crowded(list, longest_side(samples) / 2)) {
      const Points points = points_of(samples, list.arrays());
      Cell cells[8];
      const int count = halves(tile, cells);
      for (int n = 0; n < count; ++n) visit_cell(brick, cells[n], corners_of(points, tile, cells[n]), scratch);
      return;
    }
    const int number = tile_in(parent.cell, tile);
    const auto use = [&](const BoxArrays& boxes) {
      scratch.triangles.clear();
      for (std::int64_t n = 0; n < boxes.count; ++n) scratch.triangles.push_back(clusters_.triangle(boxes.entry[n]));
      use_.use_tile(brick, number, scratch.triangles);
    };
    if (open_packs(samples, corners, 0, list, scratch.packs))
      use(list.arrays());
    else
      in_parts(samples, corners, list, scratch, use);
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
    const CullCell samples = samples_of(cell);
    const auto use = [&](const BoxArrays& boxes) {
      CrowdedCell found{.at = {},
                        .boxes = boxes,
                        .points = clusters_.points(),
                        .index = clusters_.indices(),
                        .brick_center = {},
                        .extent = clusters_.extent()};
      for (int axis = 0; axis < 3; ++axis) {
        found.at[axis] = static_cast<int>(cell.low[axis] % kBrickSide);
        found.brick_center[axis] = static_cast<float>(brick.center[axis] - clusters_.center()[axis]);
      }
      use_.use_cell(brick, found);
    };
    if (narrow(scratch.tile.arrays(), samples, corners, 0, scratch.cell, scratch.packs))
      use(scratch.cell.arrays());
    else
      in_parts(samples, corners, scratch.cell, scratch, use);
  }

  const Job& job_;
  const BlockLattice& lattice_;
  const Kernels& kernels_;
  CandidateUse& use_;
  const Clusters clusters_;
  BoxList roots_;
  PerThread<Scratch> scratch_;
};

}  // namespace

void for_each_brick_by_descent(const Job& job, const BlockLattice& lattice, const Kernels& kernels, CandidateUse& use) {
  Descent(job, lattice, kernels, use).run();
}

std::int64_t descent_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads) {
  return Clusters::bytes(triangles, threads) +
         threads * Scratch::bytes(levels_of(lattice), list_capacity(Clusters::entries_of(triangles)));
}

}  // namespace standoff::cpu
