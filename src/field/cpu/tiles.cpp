// SPDX-License-Identifier: Apache-2.0
// The method `tiles` on the CPU. For thin bands, triangles are sorted into the bricks that they reach (bins.h). For
// thick bands and full fields, candidates pass down from coarse cells to tiles (candidate_culling.h). Counts decide
// which bands are thin (band_choice.h).
#include "field/cpu/tiles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "bvh/order.h"
#include "core/threads.h"
#include "field/cpu/bins.h"
#include "field/cpu/candidate_culling.h"
#include "field/cpu/regions.h"

namespace standoff::cpu {

namespace {

// Resets the samples past the grid's far faces, so that stored tiles hold the thickness there.
void clear_outside(const BlockLattice& lattice, const Brick& brick, bool with_nearest, BrickState& state) {
  int size[3];
  for (int axis = 0; axis < 3; ++axis) size[axis] = inside<kBrickSide>(lattice, brick.at, axis);
  for (int z = 0; z < kBrickSide; ++z)
    for (int y = 0; y < kBrickSide; ++y)
      for (int x = z < size[2] && y < size[1] ? size[0] : 0; x < kBrickSide; ++x) {
        const int block = block_index(x / kBlockX, y / kBlockY, z / kBlockZ);
        const int lane = x % kBlockX + kBlockX * (y % kBlockY + kBlockY * (z % kBlockZ));
        state.distance_sq[block][lane] = std::numeric_limits<float>::infinity();
        if (with_nearest) state.nearest[block][lane] = kNoTriangle;
      }
}

Candidates candidates_of(const Job& job, std::span<const std::uint32_t> refs) {
  return {memory_of(job.mesh), refs.data(), static_cast<std::int64_t>(refs.size())};
}

void write_brick(const BlockLattice& lattice, const Brick& brick, const Kernels& kernels, BrickState& state,
                 Sink& sink) {
  const unsigned tiles = kernels.band_tiles(lattice, brick, state);
  if (tiles != 0) clear_outside(lattice, brick, sink.with_nearest(), state);
  for (int tile = 0; tile < kBrickTiles; ++tile)
    if (tiles >> tile & 1)
      kernels.write_tile(
          lattice, state, tile,
          sink.open(2 * brick.at[0] + (tile & 1), 2 * brick.at[1] + (tile >> 1 & 1), 2 * brick.at[2] + (tile >> 2)));
}

// Thin bands.

// Gathers bricks by the triangles in their bins.
class BandBricks {
 public:
  BandBricks(const Job& job, Regions&& regions)
      : job_(job),
        lattice_(make_block_lattice(job.grid, job.thickness)),
        kernels_(kernels_for(job.simd)),
        regions_(std::move(regions)) {}

  const BlockLattice& lattice() const { return lattice_; }
  const Region* regions() const { return regions_.empty() ? nullptr : regions_.data(); }
  void gather(const Bins& bins, std::int64_t n, Sink& sink, ProgressMeter& progress) {
    const auto refs = bins.of(n);
    if (!refs.empty()) {
      BrickState& state = states_.local();
      const Brick brick = brick_at(lattice_, bins.first_brick + n);
      kernels_.clear(sink.with_nearest(), state);
      Candidates triangles = candidates_of(job_, refs);
      triangles.regions = regions();
      kernels_.gather_band[sink.with_nearest()](lattice_, brick, triangles, state);
      write_brick(lattice_, brick, kernels_, state, sink);
    }
    progress.advance();
  }
  /// Of all bricks so far.
  Counts counts() {
    Counts counts;
    states_.for_each([&](const BrickState& state) {
      counts.samples_examined += state.samples_examined;
      counts.samples_band += state.samples_band;
    });
    return counts;
  }

 private:
  const Job& job_;
  BlockLattice lattice_;
  const Kernels& kernels_;
  Regions regions_;
  PerThread<BrickState> states_;
};

Counts run_thin_band(const Job& job, Regions&& regions, Sink& sink) {
  BandBricks bricks(job, std::move(regions));
  const auto gather = [&](const Bins& bins) {
    tbb::parallel_for(std::int64_t{0}, bins.bricks(),
                      [&](std::int64_t n) { bricks.gather(bins, n, sink, job.progress); });
  };
  for_each_batch(job, bricks.lattice(), most_refs(job.triangle_count()), gather, Reach::distance, bricks.regions());
  return bricks.counts();
}

// Windows of a band whose triangles are sorted once, for all of them.
class ThinBand final : public WindowGather {
 public:
  ThinBand(const Job& job, Regions&& regions)
      : job_(job),
        bricks_(job, std::move(regions)),
        bins_(all_bins(job, bricks_.lattice(), most_refs(job.triangle_count()), bricks_.regions())) {}

  bool has_bins() const { return bins_.has_value(); }

  Counts gather(const Grid& window, Sink& sink, ProgressMeter& progress) override {
    Sink whole = sink.of_window(window, job_.grid);
    const Counts before = bricks_.counts();
    tbb::parallel_for(std::int64_t{0}, brick_count(window),
                      [&](std::int64_t n) { bricks_.gather(*bins_, brick_of(window, n), whole, progress); });
    const Counts now = bricks_.counts();
    return {now.samples_examined - before.samples_examined, now.samples_band - before.samples_band};
  }

  std::optional<bool> is_reached(const Grid& window) const override {
    for (std::int64_t n = 0; n < brick_count(window); ++n)
      if (!bins_->of(brick_of(window, n)).empty()) return true;
    return false;
  }

 private:
  // The number in the grid of a window's brick.
  std::int64_t brick_of(const Grid& window, std::int64_t n) const {
    const auto along = [](std::int64_t samples) { return (samples + kBrickSide - 1) / kBrickSide; };
    const auto first = [&](std::size_t axis) { return (window.first[axis] - job_.grid.first[axis]) / kBrickSide; };
    const std::int64_t x = along(window.size.x), y = along(window.size.y);
    return first(0) + n % x +
           along(job_.grid.size.x) * (first(1) + n / x % y + along(job_.grid.size.y) * (first(2) + n / (x * y)));
  }

  const Job& job_;
  BandBricks bricks_;
  std::optional<Bins> bins_;
};

std::int64_t thin_scratch_bytes(const MeshLoad& mesh, const BlockLattice& lattice, bool with_regions, int threads) {
  const std::int64_t bins = bins_scratch_bytes(mesh, lattice, most_refs(mesh.triangles), threads) +
                            static_cast<std::int64_t>(sizeof(BrickState)) * threads;
  if (!with_regions) return bins;
  return std::max(regions_scratch_bytes(mesh.triangles, threads), regions_bytes(mesh.triangles) + bins);
}

// Thick bands and full fields.

// From so many small nodes in the list of a crowded cell on, its samples cull nodes before they are opened. With fewer,
// and with nodes that are larger than a few samples, it takes more than it saves.
constexpr std::int64_t kManyNodes = 48;

// Nodes longer than this share of their distance count as no specks: their triangles are some hundredth as long.
constexpr float kSpeckNode = 0x1p-10f;

// The memory of a thread.
struct TileWork {
  explicit TileWork(CandidateLists&& candidates) : lists(std::move(candidates)) {}

  CandidateLists lists;
  BrickState brick;
  CandidateTable tile;
  CrowdedTable crowded;
  SpeckTable specks;
};

class ThickBand final : public WindowGather {
 public:
  explicit ThickBand(const Job& job)
      : job_(job),
        lattice_(make_block_lattice(job.grid, job.thickness)),
        kernels_(kernels_for(job.simd)),
        culling_(job, lattice_, kernels_, morton_order(job.mesh, job.kept, job.progress)),
        threads_([this] { return std::make_unique<TileWork>(culling_.make_lists(levels_of(lattice_))); }) {}

  Counts gather(const Grid& window, Sink& sink, ProgressMeter& progress) override {
    Sink whole = sink.of_window(window, job_.grid);
    sink_ = &whole;
    progress_ = &progress;
    const Counts before = counts();
    tbb::parallel_for(BrickRange(job_.grid, window), [this](const BrickRange& range) {
      visit(0, whole_grid(lattice_), {}, range, *threads_.local());
    });
    const Counts now = counts();
    return {now.samples_examined - before.samples_examined, now.samples_band - before.samples_band};
  }

 private:
  Counts counts() {
    Counts counts;
    threads_.for_each([&](const std::unique_ptr<TileWork>& state) {
      counts.samples_examined += state->brick.samples_examined;
      counts.samples_band += state->brick.samples_band;
    });
    return counts;
  }

  // Visits the bricks of a cell that are in the range.
  void visit(int level, const Cell& cell, const References& near, const BrickRange& range, TileWork& state) {
    const CellCandidates& own = culling_.enter(level, cell, near, state.lists);
    if (own.list.size() == 0) return progress_->advance(range.bricks_of(cell));
    if (cell.side == kBrickSide) return gather_brick(own, state);
    Cell parts[8];
    const int count = halves(cell, parts);
    for (int n = 0; n < count; ++n)
      if (range.bricks_of(parts[n]) != 0)
        visit(level + 1, parts[n], references_of(own.points, cell, parts[n]), range, state);
  }

  void gather_brick(const CellCandidates& own, TileWork& state) {
    const auto at = [&](int axis) { return own.cell.low[axis] / kBrickSide; };
    const Brick brick = brick_at(lattice_, at(0) + lattice_.bricks[0] * (at(1) + lattice_.bricks[1] * at(2)));
    kernels_.clear(sink_->with_nearest(), state.brick);
    Cell tiles[kBrickTiles];
    int count = 0;
    for (int n = 0, all = halves(own.cell, tiles); n < all; ++n)
      if (is_wanted(tiles[n])) tiles[count++] = tiles[n];
    if (has_specks(brick, own, state))
      gather_specks(brick, own, {tiles, static_cast<std::size_t>(count)}, state);
    else
      for (int n = 0; n < count; ++n) gather_tile(brick, own, tiles[n], state);
    write_brick(lattice_, brick, kernels_, state.brick, *sink_);
    progress_->advance();
  }

  bool is_wanted(const Cell& tile) const {
    const auto at = [&](int axis) { return tile.low[axis] / kTileSide; };
    return job_.wanted.empty() || job_.wanted[static_cast<std::size_t>(lattice_.tile(at(0), at(1), at(2)))] != 0;
  }

  // Whether most of some candidates, spread evenly, are specks.
  bool has_specks(const Brick& brick, const CellCandidates& own, TileWork& state) const {
    if (lattice_.speck == 0) return false;
    const CullCell samples = culling_.target(own.cell, {}).samples;
    std::uint32_t small[kLanes];
    std::int64_t count = 0;
    for (std::int64_t n = 0; n < kLanes; ++n) {
      const std::int64_t at = n * own.list.size() / kLanes;
      if (own.list.longest_side(at) <= kSpeckNode * (own.list.gap(at, samples) + kSpeckSpacings))
        small[count++] = culling_.bvh().first_triangle(own.list.entry(at));
    }
    if (2 * count < kLanes) return false;
    kernels_.load_specks(lattice_, brick, {memory_of(job_.mesh), small, count}, state.specks);
    return 2 * (count - state.specks.others_count) >= kLanes;
  }

  // Gathers tiles of a brick whose candidates are specks. The lists of its tiles would hold nearly all of them: boxes
  // are rounded by as much as such a mesh is large.
  void gather_specks(const Brick& brick, const CellCandidates& own, std::span<const Cell> tiles, TileWork& state) {
    CandidateLists& lists = state.lists;
    const CellTarget target = culling_.target(own.cell, {});
    unsigned numbers = 0;
    for (const Cell& tile : tiles) numbers |= 1u << tile_in(own.cell, tile);
    culling_.narrow(own.list.arrays(), target, std::numeric_limits<float>::infinity(), lists.tile, lists.nodes);
    state.specks.nearest.forget();
    while (culling_.next_part(target, lists.tile, lists)) {
      take_triangles(lists.part.arrays(), lists);
      for (std::span left(lists.triangles); !left.empty();) {
        const auto some = left.first(std::min<std::size_t>(left.size(), SpeckTable::kMost));
        left = left.subspan(some.size());
        kernels_.load_specks(lattice_, brick, candidates_of(job_, some), state.specks);
        kernels_.gather_specks[sink_->with_nearest()](lattice_, numbers, state.specks, state.brick);
        const std::span others(state.specks.others, static_cast<std::size_t>(state.specks.others_count));
        for (unsigned rest = others.empty() ? 0 : numbers; rest != 0; rest &= rest - 1)
          kernels_.gather_tile[sink_->with_nearest()](lattice_, brick, std::countr_zero(rest),
                                                      candidates_of(job_, others), state.tile, state.brick);
      }
    }
  }

  void take_triangles(const BoxArrays& boxes, CandidateLists& lists) const {
    lists.triangles.clear();
    for (std::int64_t n = 0; n < boxes.count; ++n) lists.triangles.push_back(culling_.triangle(boxes.entry[n]));
  }

  void gather_tile(const Brick& brick, const CellCandidates& parent, const Cell& tile, TileWork& state) {
    CandidateLists& lists = state.lists;
    const CellTarget target = culling_.target(tile, references_of(parent.points, parent.cell, tile));
    culling_.narrow(parent.list.arrays(), target, opened_length(target.samples), lists.tile, lists.nodes);
    if (culling_.is_crowded(lists.tile, target)) {
      const SurfacePoints points = culling_.points_of(target.samples, lists.tile.arrays());
      Cell cells[8];
      const int count = halves(tile, cells);
      for (int n = 0; n < count; ++n) gather_cell(brick, cells[n], references_of(points, tile, cells[n]), state);
      return;
    }
    const int number = tile_in(parent.cell, tile);
    const auto gather = [&](const BoxArrays& boxes) {
      take_triangles(boxes, lists);
      kernels_.gather_tile[sink_->with_nearest()](lattice_, brick, number, candidates_of(job_, lists.triangles),
                                                  state.tile, state.brick);
    };
    if (culling_.open_nodes(target, 0, lists.tile, lists.nodes)) return gather(lists.tile.arrays());
    while (culling_.next_part(target, lists.tile, lists)) gather(lists.part.arrays());
  }

  // Gathers a cell of a crowded tile.
  void gather_cell(const Brick& brick, const Cell& cell, const References& near, TileWork& state) {
    CandidateLists& lists = state.lists;
    const CellTarget target = culling_.target(cell, near);
    const auto gather = [&](const BoxArrays& boxes) {
      kernels_.gather_crowded[sink_->with_nearest()](lattice_, brick, culling_.crowded_cell(brick, cell, boxes),
                                                     candidates_of(job_, {}), state.crowded, state.brick);
    };
    state.crowded.forget_points();
    // Culls alone: an infinite length opens no node.
    culling_.narrow(lists.tile.arrays(), target, std::numeric_limits<float>::infinity(), lists.cell, lists.nodes);
    const float small = opened_length(target.samples);
    if (culling_.nodes_below(small, lists.cell) >= kManyNodes) {
      culling_.open_nodes(target, small, lists.cell, lists.nodes);
      const CrowdedCell nodes = culling_.crowded_cell(brick, cell, lists.cell.arrays());
      kernels_.keep_near(lattice_, nodes, culling_.first_triangles(lists.cell, lists), state.crowded, state.brick,
                         lists.cell.arrays());
    }
    if (culling_.open_nodes(target, 0, lists.cell, lists.nodes)) return gather(lists.cell.arrays());
    while (culling_.next_part(target, lists.cell, lists)) gather(lists.part.arrays());
  }

  const Job& job_;
  BlockLattice lattice_;
  const Kernels& kernels_;
  Sink* sink_ = nullptr;  // this and the next one while it gathers
  ProgressMeter* progress_ = nullptr;
  CandidateCulling culling_;
  PerThread<std::unique_ptr<TileWork>> threads_;
};

std::int64_t thick_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads) {
  return CandidateCulling::bytes(triangles, lattice, threads) + static_cast<std::int64_t>(sizeof(TileWork)) * threads;
}

}  // namespace

Counts run_tiles_by(BandChoice&& choice, const Job& job, Sink& sink) {
  if (choice.algorithm == BandAlgorithm::bins) return run_thin_band(job, std::move(choice.regions), sink);
  return ThickBand(job).gather(job.grid, sink, job.progress);
}

Counts run_tiles(const Job& job, Sink& sink) {
  job.progress.stage("distances", brick_count(job.grid), 0.2, 1);
  return run_tiles_by(choose_band(job), job, sink);
}

bool tiles_prepare_whole(std::int64_t triangles, const Grid& grid, double thickness) {
  return may_take_descent(grid, thickness) || may_hold_bins(triangles, grid);
}

std::unique_ptr<WindowGather> tiles_in_windows(const Job& job) {
  BandChoice choice = choose_band(job);
  if (choice.algorithm == BandAlgorithm::descent) return std::make_unique<ThickBand>(job);
  if (!may_hold_bins(job.triangle_count(), job.grid)) return nullptr;
  auto band = std::make_unique<ThinBand>(job, std::move(choice.regions));
  return band->has_bins() ? std::move(band) : nullptr;
}

std::string tiles_device(Simd requested) { return kernels_for(requested).name; }

std::int64_t tiles_scratch_bytes(const MeshLoad& mesh, const Grid& grid, double thickness, int threads) {
  const BlockLattice lattice = make_block_lattice(grid, thickness);
  const bool is_thick = may_take_descent(grid, thickness);  // then bins may have regions
  std::int64_t bytes = 0;
  if (may_take_bins(mesh.triangles, grid, thickness)) bytes = thin_scratch_bytes(mesh, lattice, is_thick, threads);
  if (is_thick) bytes = std::max(bytes, thick_scratch_bytes(mesh.triangles, lattice, threads));
  return bytes;
}

}  // namespace standoff::cpu
