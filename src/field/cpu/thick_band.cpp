// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/thick_band.h"

#include <tbb/parallel_for.h>

#include <memory>

#include "core/threads.h"
#include "field/cpu/brick_gather.h"
#include "field/cpu/candidate_culling.h"
#include "field/cpu/triangle_order.h"

namespace standoff::cpu {
namespace {

// What one thread uses for one brick after the other.
struct TileWork {
  explicit TileWork(CandidateLists&& candidates) : lists(std::move(candidates)) {}

  CandidateLists lists;
  BrickState brick;
  CandidateTable tile;
  CrowdedTable crowded;
};

class ThickBand final : public LayerGather {
 public:
  ThickBand(const Job& job, const BlockLattice& lattice, const Kernels& kernels)
      : job_(job),
        lattice_(lattice),
        kernels_(kernels),
        culling_(job, lattice, kernels, morton_order(job)),
        threads_([this] { return std::make_unique<TileWork>(culling_.make_lists(levels_of(lattice_))); }) {}

  void gather(const BrickLayers& layers, Sink& sink) override {
    sink_ = &sink;
    tbb::parallel_for(BrickRange(lattice_, layers), [this](const BrickRange& range) {
      visit(0, whole_grid(lattice_), {}, range, *threads_.local());
    });
  }

  Counts counts() override {
    Counts counts;
    threads_.for_each([&](const std::unique_ptr<TileWork>& state) {
      counts.samples_examined += state->brick.samples_examined;
      counts.samples_band += state->brick.samples_band;
    });
    return counts;
  }

 private:
  // Visits the bricks of a cell that are in the range.
  void visit(int level, const Cell& cell, const References& near, const BrickRange& range, TileWork& state) {
    const CellCandidates& own = culling_.enter(level, cell, near, state.lists);
    if (own.list.size() == 0) return job_.progress.advance(range.bricks_of(cell));
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
    const int count = halves(own.cell, tiles);
    for (int n = 0; n < count; ++n) gather_tile(brick, own, tiles[n], state);
    write_brick(lattice_, brick, kernels_, state.brick, *sink_);
    job_.progress.advance();
  }

  void gather_tile(const Brick& brick, const CellCandidates& parent, const Cell& tile, TileWork& state) {
    CandidateLists& lists = state.lists;
    const CellTarget target = culling_.target(tile, references_of(parent.points, parent.cell, tile));
    culling_.narrow(parent.list.arrays(), target, opened_length(target.samples), lists.tile, lists.packs);
    if (culling_.is_crowded(lists.tile, target)) {
      const SurfacePoints points = culling_.points_of(target.samples, lists.tile.arrays());
      Cell cells[8];
      const int count = halves(tile, cells);
      for (int n = 0; n < count; ++n) gather_cell(brick, cells[n], references_of(points, tile, cells[n]), state);
      return;
    }
    const int number = tile_in(parent.cell, tile);
    const auto gather = [&](const BoxArrays& boxes) {
      lists.triangles.clear();
      for (std::int64_t n = 0; n < boxes.count; ++n) lists.triangles.push_back(culling_.triangle(boxes.entry[n]));
      kernels_.gather_tile(lattice_, brick, number, candidates_of(job_, lists.triangles), sink_->with_nearest(),
                           state.tile, state.brick);
    };
    if (culling_.open_packs(target, 0, lists.tile, lists.packs)) return gather(lists.tile.arrays());
    while (culling_.next_part(target, lists.tile, lists)) gather(lists.part.arrays());
  }

  // A cell of a tile that has very many candidates.
  void gather_cell(const Brick& brick, const Cell& cell, const References& near, TileWork& state) {
    CandidateLists& lists = state.lists;
    const CellTarget target = culling_.target(cell, near);
    const auto gather = [&](const BoxArrays& boxes) {
      kernels_.gather_crowded(lattice_, brick, culling_.crowded_cell(brick, cell, boxes), candidates_of(job_, {}),
                              sink_->with_nearest(), state.crowded, state.brick);
    };
    if (culling_.narrow(lists.tile.arrays(), target, 0, lists.cell, lists.packs)) return gather(lists.cell.arrays());
    while (culling_.next_part(target, lists.cell, lists)) gather(lists.part.arrays());
  }

  const Job& job_;
  const BlockLattice& lattice_;
  const Kernels& kernels_;
  Sink* sink_ = nullptr;  // while it gathers
  CandidateCulling culling_;
  PerThread<std::unique_ptr<TileWork>> threads_;
};

}  // namespace

std::unique_ptr<LayerGather> thick_band(const Job& job, const BlockLattice& lattice, const Kernels& kernels) {
  return std::make_unique<ThickBand>(job, lattice, kernels);
}

std::int64_t thick_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads) {
  return CandidateCulling::bytes(triangles, lattice, threads) + static_cast<std::int64_t>(sizeof(TileWork)) * threads;
}

}  // namespace standoff::cpu
