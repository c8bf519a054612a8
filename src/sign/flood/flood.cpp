// SPDX-License-Identifier: Apache-2.0
#include "sign/flood/flood.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <string>
#include <utility>

#include "core/tile_count.h"
#include "sign/diagnosis/closed.h"
#include "sign/flood/grid_edges.h"
#include "standoff/error.h"

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

using Sample = std::array<std::int64_t, 3>;  // of the lattice

// A flood at work.
class Flooding {
 public:
  Flooding(MeshView mesh, const Grid& grid, const TileLattice& lattice, ProgressMeter& progress);

  FloodSides take_sides() { return {edges_.take_tiles(), std::move(parts_), std::move(whole_tiles_)}; }

 private:
  class Settling;

  void flood(ProgressMeter& progress);
  void enter(std::size_t tile, const TileBits& samples, std::vector<std::size_t>& next);
  TileBits apart(const GridEdges& edges, std::size_t tile) const;
  TileBits reached(std::size_t tile) const;

  const TileLattice& lattice_;
  GridEdges edges_;                // no path takes these
  std::vector<TileBits> parts_;    // the samples reached, of each tile with such edges
  std::vector<bool> whole_tiles_;  // whether each of the other tiles was reached
};

// Floods from the outermost tiles. A tile without crossed edges is reached as a whole. The result does not depend on
// the order of the tiles.
void Flooding::flood(ProgressMeter& progress) {
  std::vector<std::size_t> next;
  for_each_outermost(lattice_, [&](std::size_t tile, Face face) { enter(tile, at_face(face), next); });
  for (std::size_t n = 0; !next.empty(); ++n) {
    if (n % 4096 == 0) progress.check();
    const std::size_t tile = next.back();
    next.pop_back();
    const TileBits from = reached(tile);
    const bool is_whole = whole_tiles_[tile];
    for_each_neighbour(lattice_, tile, [&](Face face, std::size_t other) {
      if (whole_tiles_[other]) return;
      if (is_whole && !edges_.tiles().has(other)) {
        whole_tiles_[other] = true;
        return next.push_back(other);
      }
      enter(other, beyond(from, face, edges_.of_tile(face.up ? tile : other)), next);
    });
  }
}

void Flooding::enter(std::size_t tile, const TileBits& samples, std::vector<std::size_t>& next) {
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
TileBits Flooding::apart(const GridEdges& edges, std::size_t tile) const {
  const TileEdges& own = edges.of_tile(tile);
  TileBits joined = {};
  for_each_neighbour(lattice_, tile, [&](Face face, std::size_t other) {
    joined = joined | beyond(kAllBits, {face.axis, !face.up}, edges.of_tile(face.up ? tile : other));
  });
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
class Flooding::Settling {
 public:
  // `crossed`: the edges that cross a triangle.
  Settling(Flooding& flood, const GridEdges& crossed, const RimDistances& rims)
      : flood_(flood), lattice_(flood.lattice_), tiles_(flood.edges_.tiles()), crossed_(crossed), rims_(rims) {
    const GridEdges certain(crossed, rims, RimDistances::kFar, lattice_);
    std::vector<std::size_t> tiles;
    tiles_.for_each([&](std::size_t tile) { tiles.push_back(tile); });
    undecided_.resize(tiles.size());
    tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t n) {
      undecided_[n] = flood_.apart(certain, tiles[n]) & ~flood_.reached(tiles[n]);
    });
    for (std::size_t n = 0; n < tiles.size(); ++n) add_samples(tiles[n], undecided_[n]);
  }

  void run(ProgressMeter& progress) {
    while (!next_.empty()) {
      progress.check();
      decide_next();
      find_next();
    }
  }

 private:
  enum Side : std::uint8_t { unknown, outside, inside };
  // A sample by its tile, and x + 8 y + 64 z within it.
  struct Place {
    std::size_t tile, within;
  };

  void add_samples(std::size_t tile, const TileBits& bits) {
    const Sample at = lattice_.tile_at(tile);
    for (std::int64_t z = 0; z < 8; ++z)
      for (std::uint64_t rest = bits[static_cast<std::size_t>(z)]; rest != 0; rest &= rest - 1) {
        const std::int64_t bit = std::countr_zero(rest);
        next_.push_back({8 * at[0] + bit % 8, 8 * at[1] + bit / 8, 8 * at[2] + z});
      }
  }

  // Decides the samples of a round by the sides before it, so that their order does not matter.
  void decide_next() {
    decided_.clear();
    for (const Sample& sample : next_)
      if (const Side side = side_by_neighbours(sample); side != unknown) decided_.emplace_back(sample, side);
    for (const auto& [sample, side] : decided_) {
      const Place at = place_of(sample);
      const std::size_t number = tiles_.number(at.tile);
      const std::uint64_t bit = std::uint64_t{1} << at.within % 64;
      undecided_[number][at.within / 64] &= ~bit;
      if (side == outside) flood_.parts_[number][at.within / 64] |= bit;
    }
  }

  // Takes the undecided neighbours of the samples decided last into the next round.
  void find_next() {
    next_.clear();
    for (const auto& [sample, side] : decided_)
      for (const Face face : kFaces) {
        const Sample to = neighbour(sample, face);
        if (is_in_lattice(to, face.axis) && is_undecided(place_of(to))) next_.push_back(to);
      }
    std::ranges::sort(next_);
    next_.erase(std::unique(next_.begin(), next_.end()), next_.end());
  }

  // Inside wins where the widest ways lead to both sides.
  Side side_by_neighbours(const Sample& sample) const {
    std::array<int, 6> width;
    std::array<Side, 6> side;
    for (std::size_t n = 0; n < 6; ++n) {
      const Face face = kFaces[n];
      const Sample to = neighbour(sample, face);
      width[n] = -1;
      side[n] = unknown;
      if (!is_in_lattice(to, face.axis)) continue;
      const Place lower = place_of(face.up ? sample : to);
      if (bit_of(crossed_.of_tile(lower.tile).crossed[face.axis], lower)) continue;
      width[n] = rims_.of(lower.tile, face.axis, lower.within);
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
  }

  Side side_of(const Place& at) const {
    if (is_undecided(at)) return unknown;
    return bit_of(flood_.reached(at.tile), at) ? outside : inside;
  }
  bool is_undecided(const Place& at) const {
    return tiles_.has(at.tile) && bit_of(undecided_[tiles_.number(at.tile)], at);
  }
  bool is_in_lattice(const Sample& s, std::size_t axis) const {
    return s[axis] >= 0 && s[axis] < lattice_.axes[axis].size();
  }
  Place place_of(const Sample& s) const {
    return {lattice_.index(s[0] / 8, s[1] / 8, s[2] / 8),
            static_cast<std::size_t>(s[0] % 8 + 8 * (s[1] % 8 + 8 * (s[2] % 8)))};
  }
  static bool bit_of(const TileBits& bits, const Place& at) {
    return (bits[at.within / 64] >> at.within % 64 & 1) != 0;
  }
  static Sample neighbour(Sample sample, Face face) {
    sample[face.axis] += face.up ? 1 : -1;
    return sample;
  }

  Flooding& flood_;
  const TileLattice& lattice_;
  const TileSet& tiles_;  // with edges that no path takes
  const GridEdges& crossed_;
  const RimDistances& rims_;
  std::vector<TileBits> undecided_;  // by number in tiles_
  std::vector<Sample> next_;         // the samples of the next round
  std::vector<std::pair<Sample, Side>> decided_;
};

Flooding::Flooding(MeshView mesh, const Grid& grid, const TileLattice& lattice, ProgressMeter& progress)
    : lattice_(lattice), edges_(mesh, lattice_, progress), whole_tiles_(lattice_.tile_count()) {
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
    Settling(*this, crossed, distances).run(progress);
  }
}

TileBits Flooding::reached(std::size_t tile) const {
  if (edges_.tiles().has(tile)) return parts_[edges_.tiles().number(tile)];
  return whole_tiles_[tile] ? kAllBits : TileBits{};
}

}  // namespace

Flood::Flood(MeshView mesh, const Grid& grid, ProgressMeter& progress)
    : size_(grid.size),
      lattice_(TileLattice::around(grid, bounds(mesh))),
      sides_(std::make_shared<const FloodSides>(Flooding(mesh, grid, lattice_, progress).take_sides())) {}

Flood::Flood(MeshView mesh, const Grid& grid, std::shared_ptr<const FloodSides> sides)
    : size_(grid.size), lattice_(TileLattice::around(grid, bounds(mesh))), sides_(std::move(sides)) {
  if (sides_->whole.size() != lattice_.tile_count())
    throw Error(ErrorCode::input, "sign decision: its flood has " + std::to_string(sides_->whole.size()) +
                                      " tiles, where this mesh and grid have " + std::to_string(lattice_.tile_count()) +
                                      "; make a new one");
}

TileBits Flood::inside_of(const Size3& size, const std::array<std::int64_t, 3>& tile) const {
  const std::size_t index = lattice_.index_in_grid(tile[0], tile[1], tile[2]);
  return sides_->whole[index] ? TileBits{} : bits_in_grid(size, tile) & ~sides_->reached(index);
}

void Flood::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  for (std::int64_t tx = rows.tiles_begin(); tx < rows.tiles_end(); ++tx) {
    const TileBits inside = inside_of(rows.size(), {tx, ty, tz});
    if (any(inside)) mark(rows, tx, inside);
  }
}

std::int64_t Flood::inside_samples() const {
  std::int64_t sum = 0;
  for (std::int64_t tz = 0; tz < tiles_along(size_.z); ++tz)
    for (std::int64_t ty = 0; ty < tiles_along(size_.y); ++ty)
      for (std::int64_t tx = 0; tx < tiles_along(size_.x); ++tx) sum += count(inside_of(size_, {tx, ty, tz}));
  return sum;
}

}  // namespace standoff
