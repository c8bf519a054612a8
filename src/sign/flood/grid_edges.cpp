// SPDX-License-Identifier: Apache-2.0
#include "sign/flood/grid_edges.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "sign/flood/lattice_crossings.h"

namespace standoff {
namespace {

// An edge: its tile above 11 bits for axis and sample.
using GridEdgeKey = std::uint64_t;

GridEdgeKey key_of(const TileLattice& lattice, std::size_t axis, const std::array<std::int64_t, 3>& sample) {
  const auto [x, y, z] = sample;
  const auto within =
      static_cast<GridEdgeKey>(x % kTileSide + kTileSide * (y % kTileSide) + kTileSide * kTileSide * (z % kTileSide));
  return GridEdgeKey{lattice.index(x / kTileSide, y / kTileSide, z / kTileSide)} << 11 | GridEdgeKey{axis} << 9 |
         within;
}

}  // namespace

GridEdges::GridEdges(MeshView mesh, const TileLattice& lattice, ProgressMeter& progress)
    : tiles_(lattice.tile_count()) {
  constexpr std::size_t kGrain = 4096;
  PerThread<std::vector<GridEdgeKey>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kGrain), [&](const auto& range) {
    WorkCheck check(progress, 1 << 14);
    std::vector<GridEdgeKey>& mine = found.local();
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      check.add(4);  // about as long as four edges
      for_each_crossed_edge(mesh.corners(t), lattice.axes, [&](std::size_t axis, const auto& sample) {
        mine.push_back(key_of(lattice, axis, sample));
        check.add(1);
      });
    }
  });

  const auto for_each_key = [&](const auto& use) {
    found.for_each([&](const std::vector<GridEdgeKey>& part) {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.size(), 4 * kGrain), [&](const auto& range) {
        for (std::size_t n = range.begin(); n != range.end(); ++n) use(part[n]);
      });
    });
  };
  for_each_key([&](GridEdgeKey key) { tiles_.add(key >> 11); });
  tiles_.number_them();
  edges_.resize(tiles_.count());
  for_each_key([&](GridEdgeKey key) {
    TileEdges& edges = edges_[tiles_.number(key >> 11)];
    std::uint64_t& word = edges.crossed[key >> 9 & 3][key >> 6 & 7];
    std::atomic_ref(word).fetch_or(std::uint64_t{1} << (key & 63), std::memory_order_relaxed);
  });
}

GridEdges::GridEdges(const GridEdges& crossed, const RimDistances& rims, std::uint16_t steps,
                     const TileLattice& lattice)
    : tiles_(lattice.tile_count()) {
  for (const TileSet* const some : {&crossed.tiles(), &rims.tiles()})
    some->for_each([&](std::size_t tile) { tiles_.add(tile); });
  tiles_.number_them();
  edges_.resize(tiles_.count());
  tiles_.for_each([&](std::size_t tile) {
    TileEdges& edges = edges_[tiles_.number(tile)];
    edges = rims.nearer_than(steps, tile);
    for (std::size_t axis = 0; axis < 3; ++axis)
      edges.crossed[axis] = edges.crossed[axis] | crossed.of_tile(tile).crossed[axis];
  });
}

}  // namespace standoff
