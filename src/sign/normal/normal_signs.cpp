// SPDX-License-Identifier: Apache-2.0
#include "sign/normal/normal_signs.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bvh/order.h"
#include "core/tile_count.h"
#include "geometry/predicates.h"

namespace standoff {
namespace {

// All copies of a triangle are equally near; along the curve most of them come one after the other, by index.
std::vector<std::uint32_t> order_without_copies(MeshView mesh, ProgressMeter& progress) {
  std::vector<std::uint32_t> order = morton_order(mesh, {}, progress);
  const auto is_copy = [&](std::uint32_t a, std::uint32_t b) { return mesh.corners(a) == mesh.corners(b); };
  order.erase(std::unique(order.begin(), order.end(), is_copy), order.end());
  return order;
}

Bvh bvh_without_copies(MeshView mesh) {
  ProgressMeter unwatched;
  return {mesh, order_without_copies(mesh, unwatched), frame_around(mesh), unwatched};
}

// Whether both ends of each crossed edge have nearest triangles, because they are within its length of the mesh. Then
// an edge from a sample without one crosses nothing, and crossings need not be found. The margin is far above the
// rounding of distances.
bool has_ends_of_crossed_edges(const Grid& grid, double thickness) { return thickness > 1.001 * grid.max_spacing(); }

GridEdges edges_of(MeshView mesh, const TileLattice& lattice, bool needed, ProgressMeter& progress) {
  return needed ? GridEdges(mesh, lattice, progress) : GridEdges(lattice);
}

Vec3 position_of(const Grid& grid, const std::array<std::int64_t, 3>& tile, std::size_t n) {
  const auto s = static_cast<std::int64_t>(n);
  return grid.position(kTileSide * tile[0] + s % 8, kTileSide * tile[1] + s / 8 % 8, kTileSide * tile[2] + s / 64);
}

void add_bit(TileBits& bits, std::size_t n) { bits[n / 64] |= std::uint64_t{1} << n % 64; }

// The first sample of a set that is not empty.
std::size_t first_of(const TileBits& bits) {
  std::size_t z = 0;
  while (bits[z] == 0) ++z;
  return 64 * z + static_cast<std::size_t>(std::countr_zero(bits[z]));
}

}  // namespace

ClosestTriangle::ClosestTriangle(MeshView mesh) : mesh_(mesh), bvh_(bvh_without_copies(mesh)) {}

SideOfNearest by_pseudonormals(const OrientedMesh& mesh) {
  return [normals = std::make_shared<const Pseudonormals>(mesh)](const Vec3& p, std::uint32_t triangle) {
    return normals->place_of(p, triangle);
  };
}

SideOfNearest by_planes(const OrientedMesh& mesh) {
  return [mesh](const Vec3& p, std::uint32_t triangle) {
    using Place = Pseudonormals::Place;
    const auto [a, b, c] = mesh.mesh.corners(triangle);
    const int side = orient3d(a, b, c, p) * mesh.use_of(triangle);
    return side == 0 ? Place::on_surface : side < 0 ? Place::back : Place::front;
  };
}

NormalSigns::NormalSigns(MeshView mesh, const SideOfNearest& side_of, const Grid& grid, double thickness,
                         const NearestTriangles& nearest, ProgressMeter& progress)
    : lattice_(TileLattice::of(grid)),
      edges_(edges_of(mesh, lattice_, !has_ends_of_crossed_edges(grid, thickness), progress)),
      mixed_(lattice_.tile_count()),
      is_decided_(lattice_.tile_count()),
      is_inside_(lattice_.tile_count()),
      is_next_(lattice_.tile_count()) {
  find_tiles(nearest);
  decide_band(side_of, grid, nearest, progress);
  std::optional<ClosestTriangle> closest;  // most fields have no sample that needs it
  decide_rest_of_mixed(mesh, side_of, closest, grid, nearest, progress);
  std::vector<std::size_t> tiles;
  mixed_.for_each([&](std::size_t tile) { tiles.push_back(tile); });
  spread(grid, std::move(tiles), progress);
  decide_rest(mesh, side_of, closest, grid, progress);
}

void NormalSigns::find_tiles(const NearestTriangles& nearest) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lattice_.tile_count(), 64), [&](const auto& range) {
    for (std::size_t tile = range.begin(); tile != range.end(); ++tile) {
      const auto [tx, ty, tz] = lattice_.tile_at(tile);
      bool some = edges_.tiles().has(tile);
      nearest.for_each(tx, ty, tz, [&](std::size_t, std::uint32_t) { some = true; });
      if (some) mixed_.add(tile);
    }
  });
  mixed_.number_them();
  parts_.resize(mixed_.count());
}

void NormalSigns::decide_band(const SideOfNearest& side_of, const Grid& grid, const NearestTriangles& nearest,
                              ProgressMeter& progress) {
  std::vector<std::size_t> tiles;
  tiles.reserve(mixed_.count());
  mixed_.for_each([&](std::size_t tile) { tiles.push_back(tile); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.size(), 8), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      progress.check();
      const std::array<std::int64_t, 3> tile = lattice_.tile_at(tiles[n]);
      Decided& part = parts_[n];
      nearest.for_each(tile[0], tile[1], tile[2], [&](std::size_t at, std::uint32_t triangle) {
        // Samples on the surface get no side here, so that none spreads from them.
        part.add(side_of(position_of(grid, tile, at), triangle), at);
      });
      part = spread_within(part, edges_.of_tile(tiles[n]), bits_in_grid(grid.size, tile));
    }
  });
}

// Each step depends on the sides before it alone, not on the order of the tiles.
void NormalSigns::spread(const Grid& grid, std::vector<std::size_t> changed, ProgressMeter& progress) {
  std::vector<std::size_t> next;
  std::vector<Decided> found;
  while (!changed.empty()) {
    progress.check();
    next.clear();
    for (const std::size_t tile : changed)
      for_each_neighbour(lattice_, tile, [&](Face, std::size_t other) {
        if (is_next_[other] || is_decided_[other]) return;
        is_next_[other] = true;
        next.push_back(other);
      });
    found.clear();
    for (const std::size_t tile : next)
      found.push_back(after_step(tile, bits_in_grid(grid.size, lattice_.tile_at(tile))));
    changed.clear();
    for (std::size_t n = 0; n < next.size(); ++n) {
      is_next_[next[n]] = false;
      if (found[n] == decided(next[n])) continue;
      set(next[n], found[n]);
      changed.push_back(next[n]);
    }
  }
}

// Skips samples with a nearest triangle and no side: they are on the surface.
void NormalSigns::decide_rest_of_mixed(MeshView mesh, const SideOfNearest& side_of,
                                       std::optional<ClosestTriangle>& closest, const Grid& grid,
                                       const NearestTriangles& nearest, ProgressMeter& progress) {
  std::vector<std::size_t> tiles;
  mixed_.for_each([&](std::size_t tile) {
    if (any(without_side(grid, tile))) tiles.push_back(tile);
  });
  if (tiles.empty()) return;
  closest.emplace(mesh);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.size(), 8), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      progress.check();
      const std::size_t tile = tiles[n];
      const std::array<std::int64_t, 3> at = lattice_.tile_at(tile);
      const TileBits in_grid = bits_in_grid(grid.size, at);
      Decided& part = parts_[mixed_.number(tile)];
      TileBits looked_up{};
      nearest.for_each(at[0], at[1], at[2], [&](std::size_t sample, std::uint32_t) { add_bit(looked_up, sample); });
      for (TileBits rest; any(rest = without_side(grid, tile) & ~looked_up);) {
        const std::size_t sample = first_of(rest);
        add_bit(looked_up, sample);
        const Vec3 p = position_of(grid, at, sample);
        part.add(side_of(p, closest->to(p)), sample);
        part = spread_within(part, edges_.of_tile(tile), in_grid);
      }
    }
  });
}

// Decides regions of whole tiles that surfaces between layers of tiles separate from all others. They are few, because
// each is large.
void NormalSigns::decide_rest(MeshView mesh, const SideOfNearest& side_of, std::optional<ClosestTriangle>& closest,
                              const Grid& grid, ProgressMeter& progress) {
  if (mesh.triangles.empty()) return;
  for (std::size_t tile = 0; tile < lattice_.tile_count(); ++tile) {
    if (mixed_.has(tile) || is_decided_[tile]) continue;
    progress.check();
    if (!closest) closest.emplace(mesh);
    const Vec3 p = position_of(grid, lattice_.tile_at(tile), 0);
    Decided one;
    one.add(side_of(p, closest->to(p)), 0);
    set(tile, one);
    spread(grid, {tile}, progress);
  }
}

TileBits NormalSigns::without_side(const Grid& grid, std::size_t tile) const {
  const Decided there = decided(tile);
  return bits_in_grid(grid.size, lattice_.tile_at(tile)) & ~(there.outside | there.inside);
}

void NormalSigns::Decided::add(Pseudonormals::Place place, std::size_t n) {
  if (place == Pseudonormals::Place::front) add_bit(outside, n);
  if (place == Pseudonormals::Place::back) add_bit(inside, n);
}

NormalSigns::Decided NormalSigns::decided(std::size_t tile) const {
  if (mixed_.has(tile)) return parts_[mixed_.number(tile)];
  if (!is_decided_[tile]) return {};
  return is_inside_[tile] ? Decided{{}, kAllBits} : Decided{kAllBits, {}};
}

void NormalSigns::set(std::size_t tile, const Decided& decided) {
  if (mixed_.has(tile)) {
    parts_[mixed_.number(tile)] = decided;
    return;
  }
  is_decided_[tile] = true;
  is_inside_[tile] = any(decided.inside);
}

NormalSigns::Decided NormalSigns::after_step(std::size_t tile, const TileBits& in_grid) const {
  Decided all = decided(tile);
  const TileBits free = in_grid & ~(all.outside | all.inside);
  if (!any(free)) return all;
  Decided reached;
  int outside = 0, inside = 0;
  for_each_neighbour(lattice_, tile, [&](Face face, std::size_t other) {
    const Decided there = decided(other);
    const Face back{face.axis, !face.up};  // leads from there to here
    const TileEdges& lower = edges_.of_tile(face.up ? tile : other);
    const TileBits from_outside = beyond(there.outside, back, lower) & free,
                   from_inside = beyond(there.inside, back, lower) & free;
    outside += count(from_outside);
    inside += count(from_inside);
    reached.outside = reached.outside | from_outside;
    reached.inside = reached.inside | from_inside;
  });
  if (mixed_.has(tile)) {
    all.outside = all.outside | reached.outside;
    all.inside = all.inside | (reached.inside & ~reached.outside);
    return spread_within(all, edges_.of_tile(tile), in_grid);
  }
  if (outside + inside == 0) return all;
  return inside > outside ? Decided{{}, kAllBits} : Decided{kAllBits, {}};
}

// Spreads sides from sample to sample within a tile.
NormalSigns::Decided NormalSigns::spread_within(Decided decided, const TileEdges& edges,
                                                const TileBits& in_grid) const {
  while (true) {
    const TileBits free = in_grid & ~(decided.outside | decided.inside);
    const TileBits outside = with_neighbours(decided.outside, edges) & free,
                   inside = with_neighbours(decided.inside, edges) & free & ~outside;
    if (!any(outside) && !any(inside)) return decided;
    decided.outside = decided.outside | outside;
    decided.inside = decided.inside | inside;
  }
}

void NormalSigns::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  for (std::int64_t tx = 0; tx < tiles_along(rows.size().x); ++tx) {
    const TileBits inside = decided(lattice_.index(tx, ty, tz)).inside;
    if (any(inside)) mark(rows, tx, inside & bits_in_grid(rows.size(), {tx, ty, tz}));
  }
}

}  // namespace standoff
