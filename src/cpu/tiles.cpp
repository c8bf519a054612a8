#include "cpu/tiles.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "cpu/bins.h"
#include "cpu/kernels.h"
#include "cpu/lattice.h"

namespace difi::cpu {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t),
              "the kernels read vertices and triangles as plain arrays");

// Indices held at once: 64 MiB, or as many as there are triangles.
std::int64_t most_refs(std::int64_t triangles) { return std::max<std::int64_t>(triangles, std::int64_t{16} << 20); }

// Gives the finished tiles of a brick to the sink.
void emit(const Lattice& lattice, const Brick& brick, const Kernels& kernels, BrickState& state, Sink& sink) {
  const unsigned tiles = kernels.band_tiles(lattice, brick, state);
  for (int tile = 0; tile < kBrickTiles; ++tile)
    if (tiles >> tile & 1)
      kernels.write_tile(lattice, state, tile,
                         sink.open(2 * brick.at[0] + (tile & 1), 2 * brick.at[1] + (tile >> 1 & 1),
                                   2 * brick.at[2] + (tile >> 2)));
}

}  // namespace

Counts run_tiles(const Job& job, Sink& sink) {
  const Lattice lattice = make_lattice(job.grid, job.thickness);
  const Kernels& kernels = kernels_for(job.simd);
  tbb::enumerable_thread_specific<BrickState> states;
  job.progress.stage("gather", lattice.brick_count(), 0.2, 1);
  for_each_batch(job, lattice, most_refs(job.triangle_count()), [&](const Bins& bins) {
    tbb::parallel_for(std::int64_t{0}, bins.bricks(), [&](std::int64_t n) {
      const auto refs = bins.of(n);
      if (!refs.empty()) {
        const Brick brick = brick_at(lattice, bins.first_brick + n);
        BrickState& state = states.local();
        const Candidates candidates{&job.mesh.vertices.data()->x, job.mesh.triangles.data()->data(), refs.data(),
                                    static_cast<std::int64_t>(refs.size())};
        kernels.clear(sink.with_nearest(), state);
        kernels.gather_band(lattice, brick, candidates, sink.with_nearest(), state);
        emit(lattice, brick, kernels, state, sink);
      }
      job.progress.advance();
    });
  });
  Counts counts;
  for (const BrickState& state : states) {
    counts.samples_examined += state.samples_examined;
    counts.samples_band += state.samples_band;
  }
  return counts;
}

std::string tiles_device(Simd requested) { return kernels_for(requested).name; }

std::int64_t tiles_scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads) {
  const Lattice lattice = make_lattice(grid, thickness);
  const std::int64_t keys = 4 * triangles, refs = 4 * most_refs(triangles);
  const std::int64_t counters = 4 * lattice.brick_count() * (4 * threads + 1);
  return keys + refs + counters + static_cast<std::int64_t>(sizeof(BrickState)) * threads;
}

}  // namespace difi::cpu
