// SPDX-License-Identifier: Apache-2.0
#include "sign/flood/flood.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "core/tile_count.h"
#include "sign/diagnosis/closed.h"

namespace standoff {
namespace {

// Calls use(tile, face) for the tiles at each face of the lattice.
template <class Use>
void for_each_outermost(const TileLattice& lattice, const Use& use) {
  const std::array<std::int64_t, 3> tiles{lattice.tiles.x, lattice.tiles.y, lattice.tiles.z};
  for (const Face face : kFaces) {
    const std::size_t b = (face.axis + 1) % 3, c = (face.axis + 2) % 3;
    std::array<std::int64_t, 3> at;
    at[face.axis] = face.up ? tiles[face.axis] - 1 : 0;
    for (at[b] = 0; at[b] < tiles[b]; ++at[b])
      for (at[c] = 0; at[c] < tiles[c]; ++at[c]) use(lattice.index(at[0], at[1], at[2]), face);
  }
}

// Edges certainly join samples if they keep this many times farther from rims than a path has to. A path would have
// come along them if it could, and no rounding kept it off.
constexpr double kCertainly = 1.5;
// Half a spacing, in the steps of the distances.
constexpr auto kHalf = static_cast<std::uint16_t>(RimDistances::kFar / kCertainly);

}  // namespace

Flood::Flood(MeshView mesh, const Grid& grid, ProgressMeter& progress)
    : lattice_(TileLattice::around(grid, bounds(mesh))),
      edges_(mesh, lattice_, progress),
      whole_tiles_(lattice_.tile_count()) {
  const std::vector<RimEdge> rims = is_closed(mesh).unoriented ? std::vector<RimEdge>() : rim_edges_of(mesh, progress);
  if (rims.empty()) {
    parts_.resize(edges_.tiles().count());
    flood(progress);
  } else {
    const double half = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z}) / 2;
    const RimDistances distances(rims, lattice_, kCertainly * half, progress);
    const GridEdges crossed = std::exchange(edges_, GridEdges(edges_, distances, kHalf, lattice_));
    parts_.resize(edges_.tiles().count());
    flood(progress);
    settle(crossed, distances, progress);
  }
  inside_samples_ = count_inside(grid.size);
}

// Floods from the outermost tiles. A tile without crossed edges is reached as a whole. The result does not depend on
// the order of the tiles.
void Flood::flood(ProgressMeter& progress) {
  std::vector<std::size_t> next;
  for_each_outermost(lattice_, [&](std::size_t tile, Face face) { enter(tile, at_face(face), next); });
  const std::array<std::int64_t, 3> tiles{lattice_.tiles.x, lattice_.tiles.y, lattice_.tiles.z};
  const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(tiles[0]),
                                          static_cast<std::size_t>(tiles[0] * tiles[1])};
  for (std::size_t n = 0; !next.empty(); ++n) {
    if (n % 4096 == 0) progress.check();
    const std::size_t tile = next.back();
    next.pop_back();
    const std::array<std::int64_t, 3> at = lattice_.tile_at(tile);
    const TileBits from = reached(tile);
    const bool is_whole = whole_tiles_[tile];
    for (const Face face : kFaces) {
      if (at[face.axis] == (face.up ? tiles[face.axis] - 1 : 0)) continue;
      const std::size_t other = face.up ? tile + stride[face.axis] : tile - stride[face.axis];
      if (whole_tiles_[other]) continue;
      if (is_whole && !edges_.tiles().has(other)) {
        whole_tiles_[other] = true;
        next.push_back(other);
        continue;
      }
      enter(other, beyond(from, face, edges_.of_tile(face.up ? tile : other)), next);
    }
  }
}

void Flood::enter(std::size_t tile, const TileBits& samples, std::vector<std::size_t>& next) {
  if (!any(samples)) return;
  if (!edges_.tiles().has(tile)) {
    if (whole_tiles_[tile]) return;
    whole_tiles_[tile] = true;
    return next.push_back(tile);
  }
  TileBits& part = parts_[edges_.tiles().number(tile)];
  TileBits grown = part | samples;
  if (grown == part) return;
  const TileEdges& edges = edges_.of_tile(tile);
  while (grown != part) {
    part = grown;
    grown = with_neighbours(part, edges);
  }
  next.push_back(tile);
}

// The samples of a tile that none of their six edges joins to another sample, where a path takes none of `edges`.
TileBits Flood::apart(const GridEdges& edges, std::size_t tile) const {
  const Sample tiles{lattice_.tiles.x, lattice_.tiles.y, lattice_.tiles.z};
  const Sample at = lattice_.tile_at(tile);
  const TileEdges& own = edges.of_tile(tile);
  TileBits joined = {};
  for (const Face face : kFaces) {
    if (at[face.axis] == (face.up ? tiles[face.axis] - 1 : 0)) continue;
    Sample to = at;
    to[face.axis] += face.up ? 1 : -1;
    const std::size_t other = lattice_.index(to[0], to[1], to[2]);
    joined = joined | beyond(kAllBits, {face.axis, !face.up}, edges.of_tile(face.up ? tile : other));
  }
  // Join samples within the tile: an edge joins both its ends.
  for (int odd = 0; odd < 2; ++odd) {
    TileBits some;
    for (std::size_t z = 0; z < some.size(); ++z)
      some[z] = ((odd + static_cast<int>(z)) % 2 == 0 ? 0xaa55aa55aa55aa55 : 0x55aa55aa55aa55aa);
    joined = joined | (with_neighbours(some, own) & ~some);
  }
  return ~joined;
}

// Decides the samples that no path reached and that are apart from all others, because rims are near. Each takes the
// side of the neighbour along the widest way: an edge that no triangle crosses, and that keeps farthest from rims. A
// way that is much narrower than others from the same sample leads through a gap, and does not count. So sides spread
// from sample to sample, in rounds, from samples whose side is known: outside if the flood reached them, inside if it
// did not although they are not apart. Samples to which nothing spreads are inside.
void Flood::settle(const GridEdges& crossed, const RimDistances& rims, ProgressMeter& progress) {
  const GridEdges certain(crossed, rims, RimDistances::kFar, lattice_);
  enum Side : std::uint8_t { unknown, outside, inside };
  std::vector<TileBits> open(edges_.tiles().count());  // the samples to be decided, of each tile of edges_
  std::vector<Sample> next;
  const auto for_each_bit = [&](std::size_t tile, const TileBits& bits, const auto& use) {
    const Sample at = lattice_.tile_at(tile);
    for (std::int64_t z = 0; z < 8; ++z)
      for (std::uint64_t rest = bits[static_cast<std::size_t>(z)]; rest != 0; rest &= rest - 1) {
        const std::int64_t bit = std::countr_zero(rest);
        use(Sample{8 * at[0] + bit % 8, 8 * at[1] + bit / 8, 8 * at[2] + z});
      }
  };
  std::vector<std::size_t> tiles;
  edges_.tiles().for_each([&](std::size_t tile) { tiles.push_back(tile); });
  tbb::parallel_for(std::size_t{0}, tiles.size(),
                    [&](std::size_t n) { open[n] = apart(certain, tiles[n]) & ~reached(tiles[n]); });
  for (std::size_t n = 0; n < tiles.size(); ++n)
    for_each_bit(tiles[n], open[n], [&](const Sample& at) { next.push_back(at); });

  struct Place {
    std::size_t tile, within;
  };
  const auto place_of = [&](const Sample& s) {
    return Place{lattice_.index(s[0] / 8, s[1] / 8, s[2] / 8),
                 static_cast<std::size_t>(s[0] % 8 + 8 * (s[1] % 8 + 8 * (s[2] % 8)))};
  };
  const auto bit_of = [](const TileBits& bits, const Place& at) {
    return (bits[at.within / 64] >> at.within % 64 & 1) != 0;
  };
  const auto is_open = [&](const Place& at) {
    return edges_.tiles().has(at.tile) && bit_of(open[edges_.tiles().number(at.tile)], at);
  };
  const auto side_of = [&](const Place& at) {
    if (is_open(at)) return unknown;
    return bit_of(reached(at.tile), at) ? outside : inside;
  };
  const auto is_in_lattice = [&](const Sample& s, std::size_t axis) {
    return s[axis] >= 0 && s[axis] < lattice_.axes[axis].size();
  };
  const auto side_by_neighbours = [&](const Sample& sample) {
    std::array<int, 6> width;
    std::array<Side, 6> side;
    for (std::size_t n = 0; n < 6; ++n) {
      const Face face = kFaces[n];
      Sample to = sample;
      to[face.axis] += face.up ? 1 : -1;
      width[n] = -1;
      side[n] = unknown;
      if (!is_in_lattice(to, face.axis)) continue;
      const Place lower = place_of(face.up ? sample : to);
      if (bit_of(crossed.of_tile(lower.tile).crossed[face.axis], lower)) continue;
      width[n] = rims.of(lower.tile, face.axis, lower.within);
      side[n] = side_of(place_of(to));
    }
    const int widest = std::ranges::max(width);
    int best = -1;
    Side found = unknown;
    for (std::size_t n = 0; n < 6; ++n) {
      if (side[n] == unknown || 2 * width[n] < widest || width[n] < best) continue;
      if (width[n] > best || side[n] == inside) found = side[n];
      best = width[n];
    }
    return found;
  };

  std::vector<std::pair<Sample, Side>> decided;
  while (!next.empty()) {
    progress.check();
    decided.clear();
    for (const Sample& sample : next)
      if (const Side side = side_by_neighbours(sample); side != unknown) decided.emplace_back(sample, side);
    next.clear();
    for (const auto& [sample, side] : decided) {
      const Place at = place_of(sample);
      const std::size_t number = edges_.tiles().number(at.tile);
      const std::uint64_t bit = std::uint64_t{1} << at.within % 64;
      open[number][at.within / 64] &= ~bit;
      if (side == outside) parts_[number][at.within / 64] |= bit;
    }
    for (const auto& [sample, side] : decided)
      for (const Face face : kFaces) {
        Sample to = sample;
        to[face.axis] += face.up ? 1 : -1;
        if (is_in_lattice(to, face.axis) && is_open(place_of(to))) next.push_back(to);
      }
    std::ranges::sort(next);
    next.erase(std::unique(next.begin(), next.end()), next.end());
  }
}

TileBits Flood::reached(std::size_t tile) const {
  if (edges_.tiles().has(tile)) return parts_[edges_.tiles().number(tile)];
  return whole_tiles_[tile] ? kAllBits : TileBits{};
}

TileBits Flood::inside_of(const Size3& size, const std::array<std::int64_t, 3>& tile) const {
  const std::size_t index = lattice_.index_in_grid(tile[0], tile[1], tile[2]);
  return whole_tiles_[index] ? TileBits{} : bits_in_grid(size, tile) & ~reached(index);
}

void Flood::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  for (std::int64_t tx = 0; tx < tiles_along(rows.size().x); ++tx) {
    const TileBits inside = inside_of(rows.size(), {tx, ty, tz});
    if (any(inside)) mark(rows, tx, inside);
  }
}

std::int64_t Flood::count_inside(const Size3& size) const {
  std::int64_t sum = 0;
  for (std::int64_t tz = 0; tz < tiles_along(size.z); ++tz)
    for (std::int64_t ty = 0; ty < tiles_along(size.y); ++ty)
      for (std::int64_t tx = 0; tx < tiles_along(size.x); ++tx) sum += count(inside_of(size, {tx, ty, tz}));
  return sum;
}

}  // namespace standoff
