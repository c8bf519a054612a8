// SPDX-License-Identifier: Apache-2.0
// Vector propagation and jump flooding on the CPU.
#include "approximate/spread.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

#include "approximate/approximate.h"
#include "approximate/jumpflood.h"
#include "approximate/propagate.h"
#include "core/memory.h"
#include "thesis/thesis.h"
#include "thesis/thesis_distance.h"

namespace standoff::cpu {
namespace {

struct MeshCorners {
  MeshView mesh;
  void operator()(std::uint32_t triangle, Triple<double> (&corner)[3]) const {
    const auto [a, b, c] = mesh.corners(triangle);
    corner[0] = triple_of(a), corner[1] = triple_of(b), corner[2] = triple_of(c);
  }
};
using Space = SpreadSpace<MeshCorners>;

std::size_t index_of(const Lattice& l, std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<std::size_t>(x + l.size[0] * (y + l.size[1] * z));
}

// The numbers of a grid's samples, and how many distances were measured for them.
struct Spreading {
  const Job& job;
  Space space;
  std::vector<Found> found;
  std::atomic<std::int64_t> measured{0};

  explicit Spreading(const Job& j)
      : job(j),
        space{make_lattice(j.grid, j.thickness), {j.mesh}},
        found(static_cast<std::size_t>(j.grid.sample_count()), kNothingFound) {
    seed();
  }

  // The nearest triangles of the samples at the surface, by Algorithm 1.
  void seed() {
    const double thickness = seed_thickness(job.grid);
    DistanceField shell(job.grid, thickness, true);
    Sink sink(shell);
    job.progress.stage("seeds", brick_count(job.grid), 0.2, 0.3);
    measured += run_in_boxes({job.mesh, job.kept, job.grid, thickness, job.threads, job.simd, job.progress}, sink,
                             visited_samples)
                    .samples_examined;
    if (shell.stored_tiles() == 0) throw_no_seeds();
    for (const DistanceField::Tile& tile : shell.tiles())
      for (int n = 0; n < kTileSamples; ++n) {
        const std::uint32_t triangle = tile.nearest[static_cast<std::size_t>(n)];
        if (triangle == kNoTriangle) continue;
        const std::int64_t x = tile.at.x * kTileSide + n % kTileSide,
                           y = tile.at.y * kTileSide + n / kTileSide % kTileSide,
                           z = tile.at.z * kTileSide + n / (kTileSide * kTileSide);
        found[index_of(space.lattice, x, y, z)] = space.measured(x, y, z, triangle);
        ++measured;
      }
  }

  void sweep(int number) {
    for (std::int64_t front = 0; front < row_fronts(space.lattice); ++front) {
      const auto [first, past] = steps_of_front(space.lattice, front);
      tbb::parallel_for(tbb::blocked_range<std::int64_t>(first, past, 4), [&](const auto& steps) {
        for (std::int64_t step = steps.begin(); step != steps.end(); ++step) {
          const SweptRow row = swept_row(space.lattice, number, front, step);
          measured += sweep_row(space, number, row.y, row.z, found.data());
        }
      });
      job.progress.advance();
    }
  }

  // `before` and `found` change places.
  void jump_all(std::int64_t step, std::vector<Found>& before) {
    std::swap(before, found);
    const std::int64_t* const size = space.lattice.size;
    tbb::parallel_for(std::int64_t{0}, size[1] * size[2], [&](std::int64_t row) {
      std::int64_t here = 0;
      for (std::int64_t x = 0; x < size[0]; ++x)
        found[static_cast<std::size_t>(x + size[0] * row)] =
            jump(space, step, x, row % size[1], row / size[1], before.data(), here);
      measured += here;
      job.progress.advance();
    });
  }

  Counts write(Sink& sink) const {
    const Lattice& l = space.lattice;
    std::atomic<std::int64_t> band{0};
    tbb::parallel_for(std::int64_t{0}, l.tile_count(), [&](std::int64_t index) {
      std::int64_t tile[3];
      tile_at(l, index, tile);
      band += write_tile(tile, sink);
    });
    return {measured, band};
  }

  std::int64_t write_tile(const std::int64_t (&tile)[3], Sink& sink) const {
    const Lattice& l = space.lattice;
    float values[kTileSamples];
    std::uint32_t nearest[kTileSamples];
    std::int64_t band = 0;
    for (int n = 0; n < kTileSamples; ++n) {
      const std::int64_t x = tile[0] * kTileSide + n % kTileSide, y = tile[1] * kTileSide + n / kTileSide % kTileSide,
                         z = tile[2] * kTileSide + n / (kTileSide * kTileSide);
      const bool in_grid = x < l.size[0] && y < l.size[1] && z < l.size[2];
      const Found best = in_grid ? found[index_of(l, x, y, z)] : kNothingFound;
      const float value = std::sqrt(distance_sq_of(best)) * l.unscale;
      const bool in_band = triangle_of(best) != kNoTriangle && value <= l.thickness_world;
      values[n] = std::min(value, l.thickness_world);
      nearest[n] = in_band ? triangle_of(best) : kNoTriangle;
      band += in_band;
    }
    if (band == 0) return 0;
    const TileTarget target = sink.open(tile[0], tile[1], tile[2]);
    for (std::int64_t z = 0; z < target.size.z; ++z)
      for (std::int64_t y = 0; y < target.size.y; ++y) {
        const std::int64_t from = kTileSide * (y + kTileSide * z), to = target.row * y + target.slice * z;
        std::copy_n(values + from, target.size.x, target.values + to);
        if (target.nearest) std::copy_n(nearest + from, target.size.x, target.nearest + to);
      }
    return band;
  }
};

Counts run_jumps(const Job& job, Sink& sink, int more) {
  Spreading spreading(job);
  std::int64_t passes = 0;
  for_each_jump(spreading.space.lattice, more, [&](std::int64_t) { ++passes; });
  job.progress.stage("distances", passes * job.grid.size.y * job.grid.size.z, 0.3, 0.9);
  std::vector<Found> before(spreading.found.size());
  for_each_jump(spreading.space.lattice, more, [&](std::int64_t step) { spreading.jump_all(step, before); });
  return spreading.write(sink);
}

}  // namespace

Counts run_propagate(const Job& job, Sink& sink) {
  Spreading spreading(job);
  job.progress.stage("distances", kPropagationSweeps * row_fronts(spreading.space.lattice), 0.3, 0.9);
  for (int number = 0; number < kPropagationSweeps; ++number) spreading.sweep(number);
  return spreading.write(sink);
}

Counts run_jumpflood(const Job& job, Sink& sink) { return run_jumps(job, sink, 0); }
Counts run_jumpflood_1(const Job& job, Sink& sink) { return run_jumps(job, sink, 1); }

std::int64_t spread_scratch_bytes(const MeshLoad& mesh, const Grid& grid, double, int threads) {
  const double tiles = static_cast<double>(tile_count(grid.size));
  const double bytes = 2.0 * sizeof(Found) * static_cast<double>(grid.sample_count()) + field_bytes(tiles, tiles, true);
  return static_cast<std::int64_t>(std::min(bytes, 0x1p60)) +
         thesis_scratch_bytes({mesh.triangles}, grid, seed_thickness(grid), threads);
}

}  // namespace standoff::cpu
