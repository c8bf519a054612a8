#include "field/cpu/tiles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "core/per_thread.h"
#include "field/cpu/bins.h"
#include "field/cpu/candidate_culling.h"
#include "field/cpu/kernels.h"
#include "field/cpu/lattice.h"

namespace standoff::cpu {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t),
              "the kernels read vertices and triangles as plain arrays");

// Indices held at once: 64 MiB, or as many as there are triangles.
std::int64_t most_refs(std::int64_t triangles) { return std::max<std::int64_t>(triangles, std::int64_t{16} << 20); }

// Forgets the samples past the grid's far faces, so that stored tiles hold the thickness there.
void clear_outside(const BlockLattice& lattice, const Brick& brick, bool with_nearest, BrickState& state) {
  int size[3];
  for (int axis = 0; axis < 3; ++axis)
    size[axis] = static_cast<int>(std::min<std::int64_t>(kBrickSide, lattice.size[axis] - brick.at[axis] * kBrickSide));
  for (int z = 0; z < kBrickSide; ++z)
    for (int y = 0; y < kBrickSide; ++y)
      for (int x = z < size[2] && y < size[1] ? size[0] : 0; x < kBrickSide; ++x) {
        const int block = block_index(x / kBlockX, y / kBlockY, z / kBlockZ);
        const int lane = x % kBlockX + kBlockX * (y % kBlockY + kBlockY * (z % kBlockZ));
        state.distance_sq[block][lane] = std::numeric_limits<float>::infinity();
        if (with_nearest) state.nearest[block][lane] = kNoTriangle;
      }
}

// Gives the finished tiles of a brick to the sink.
void emit(const BlockLattice& lattice, const Brick& brick, const Kernels& kernels, BrickState& state, Sink& sink) {
  const unsigned tiles = kernels.band_tiles(lattice, brick, state);
  if (tiles != 0) clear_outside(lattice, brick, sink.with_nearest(), state);
  for (int tile = 0; tile < kBrickTiles; ++tile)
    if (tiles >> tile & 1)
      kernels.write_tile(
          lattice, state, tile,
          sink.open(2 * brick.at[0] + (tile & 1), 2 * brick.at[1] + (tile >> 1 & 1), 2 * brick.at[2] + (tile >> 2)));
}

struct Tables {
  CandidateTable tile;
  CrowdedTable crowded;
};

struct ThreadState {
  BrickState brick;
  std::unique_ptr<Tables> tables;  // where candidates are handed down
};

class TilesRun : private CandidateUse {
 public:
  TilesRun(const Job& job, Sink& sink)
      : job_(job),
        sink_(sink),
        lattice_(make_block_lattice(job.grid, job.thickness)),
        kernels_(kernels_for(job.simd)) {}

  Counts run() {
    job_.progress.stage("gather", lattice_.brick_count(), 0.2, 1);
    if (is_thin(job_.grid, job_.thickness))
      gather_bins();
    else
      for_each_brick_by_descent(job_, lattice_, kernels_, *this);
    Counts counts;
    states_.for_each([&](const ThreadState& state) {
      counts.samples_examined += state.brick.samples_examined;
      counts.samples_band += state.brick.samples_band;
    });
    return counts;
  }

 private:
  void gather_bins() {
    for_each_batch(job_, lattice_, most_refs(job_.triangle_count()), [&](const Bins& bins) {
      tbb::parallel_for(std::int64_t{0}, bins.bricks(), [&](std::int64_t n) {
        const auto refs = bins.of(n);
        if (!refs.empty()) {
          BrickState& state = states_.local().brick;
          const Brick brick = brick_at(lattice_, bins.first_brick + n);
          kernels_.clear(sink_.with_nearest(), state);
          kernels_.gather_band(lattice_, brick, candidates(refs), sink_.with_nearest(), state);
          emit(lattice_, brick, kernels_, state, sink_);
        }
        job_.progress.advance();
      });
    });
  }

  void begin_brick() override {
    ThreadState& state = states_.local();
    if (!state.tables) state.tables = std::make_unique_for_overwrite<Tables>();
    kernels_.clear(sink_.with_nearest(), state.brick);
  }
  void use_tile(const Brick& brick, int tile, std::span<const std::uint32_t> triangles) override {
    ThreadState& state = states_.local();
    kernels_.gather_tile(lattice_, brick, tile, candidates(triangles), sink_.with_nearest(), state.tables->tile,
                         state.brick);
  }
  void use_cell(const Brick& brick, const CrowdedCell& cell) override {
    ThreadState& state = states_.local();
    kernels_.gather_crowded(lattice_, brick, cell, candidates({}), sink_.with_nearest(), state.tables->crowded,
                            state.brick);
  }
  void end_brick(const Brick& brick) override { emit(lattice_, brick, kernels_, states_.local().brick, sink_); }

  Candidates candidates(std::span<const std::uint32_t> refs) const {
    return {&job_.mesh.vertices.data()->x, job_.mesh.triangles.data()->data(), refs.data(),
            static_cast<std::int64_t>(refs.size())};
  }

  const Job& job_;
  Sink& sink_;
  const BlockLattice lattice_;
  const Kernels& kernels_;
  PerThread<ThreadState> states_;
};

}  // namespace

Counts run_tiles(const Job& job, Sink& sink) { return TilesRun(job, sink).run(); }

std::string tiles_device(Simd requested) { return kernels_for(requested).name; }

std::int64_t tiles_scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads) {
  const auto per_thread = static_cast<std::int64_t>(sizeof(ThreadState)) * threads;
  const BlockLattice lattice = make_block_lattice(grid, thickness);
  if (is_thin(grid, thickness))
    return bins_scratch_bytes(triangles, lattice, most_refs(triangles), threads) + per_thread;
  return descent_scratch_bytes(triangles, lattice, threads) + per_thread +
         static_cast<std::int64_t>(sizeof(Tables)) * threads;
}

}  // namespace standoff::cpu
